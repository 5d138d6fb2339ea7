"""Action spaces, and their way into the kernel's form: a pair (u_dir, u_pilot) in [-1, 1] for each UAV.

`box` is the kernel's own form (and the paper's). `dict` and `tuple` are hybrid: a choice among the five
motions beside a continuous pilot command, for algorithms that treat the two apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from .errors import ActionError, ConfigError

ActionSpaceKind = Literal["box", "dict", "tuple"]

MOTIONS = ("up", "down", "left", "right", "stay")
"""Motions by index: +y, -y, -x, +x, none."""

FloatArray = npt.NDArray[np.float32]


def motion_to_command(motion: Any) -> Any:
    """Turn motion indices into the u_dir in the middle of their bin."""
    return np.asarray(motion, dtype=np.float32) * np.float32(0.4) - np.float32(0.8)


def check_kind(kind: str) -> ActionSpaceKind:
    """Refuse the name of an action space that does not exist."""
    if kind not in get_args(ActionSpaceKind):
        raise ConfigError(f"action_space = {kind!r}: allowed are {', '.join(get_args(ActionSpaceKind))}")
    return kind  # type: ignore[return-value]


def uav_action_space(kind: ActionSpaceKind) -> spaces.Space[Any]:
    """Describe the actions of one UAV."""
    if kind == "box":
        return spaces.Box(-1.0, 1.0, (2,), np.float32)
    motion: spaces.Space[Any] = spaces.Discrete(len(MOTIONS))
    pilot: spaces.Space[Any] = spaces.Box(-1.0, 1.0, (1,), np.float32)
    return spaces.Dict({"motion": motion, "pilot": pilot}) if kind == "dict" else spaces.Tuple((motion, pilot))


def fleet_action_space(kind: ActionSpaceKind, uavs: int) -> spaces.Space[Any]:
    """Describe the joint actions of a fleet."""
    if kind == "box":
        return spaces.Box(-1.0, 1.0, (uavs, 2), np.float32)
    motion: spaces.Space[Any] = spaces.MultiDiscrete([len(MOTIONS)] * uavs)
    pilot: spaces.Space[Any] = spaces.Box(-1.0, 1.0, (uavs,), np.float32)
    return spaces.Dict({"motion": motion, "pilot": pilot}) if kind == "dict" else spaces.Tuple((motion, pilot))


def encode_uav_action(kind: ActionSpaceKind, action: Any, out: FloatArray, uav: str) -> None:
    """Write one UAV's action into its pair of the kernel's buffer."""
    if kind == "box":
        pair = np.asarray(action, dtype=np.float32)
        if pair.shape != (2,):
            raise ActionError(f"action of {uav} has shape {pair.shape}: allowed is (2,), for u_dir and u_pilot")
        out[:] = pair
        return
    motion, pilot = _parts(kind, action)
    out[0] = motion_to_command(_motion_index(motion, uav))
    out[1] = np.asarray(pilot, dtype=np.float32).reshape(())


def encode_fleet_action(kind: ActionSpaceKind, action: Any, shape: tuple[int, ...]) -> FloatArray:
    """Turn joint actions into the kernel's form of the given shape [..., N, 2].

    Actions that already are contiguous float32 of that shape are handed on without a copy.
    """
    if kind == "box":
        pairs = np.ascontiguousarray(action, dtype=np.float32)
        if pairs.shape != shape:
            raise ActionError(f"actions have shape {pairs.shape}: allowed is {shape}")
        return pairs
    motion, pilot = _parts(kind, action)
    pairs = np.empty(shape, dtype=np.float32)
    for place, part, name in ((0, motion, "motion"), (1, pilot, "pilot")):
        values = np.asarray(part)
        if values.shape != shape[:-1]:
            raise ActionError(f"{name} has shape {values.shape}: allowed is {shape[:-1]}")
        pairs[..., place] = motion_to_command(_motion_index(values, "the fleet")) if place == 0 else values
    return pairs


def _parts(kind: ActionSpaceKind, action: Any) -> tuple[Any, Any]:
    if kind == "dict":
        if not isinstance(action, Mapping) or set(action) != {"motion", "pilot"}:
            raise ActionError(f"action {action!r}: allowed is a dict of motion and pilot")
        return action["motion"], action["pilot"]
    if not isinstance(action, Sequence) or len(action) != 2:
        raise ActionError(f"action {action!r}: allowed is a tuple (motion, pilot)")
    return action[0], action[1]


def _motion_index(motion: Any, owner: str) -> Any:
    index = np.asarray(motion)
    if not np.issubdtype(index.dtype, np.integer) or (index < 0).any() or (index >= len(MOTIONS)).any():
        raise ActionError(f"motion of {owner} is {motion!r}: allowed are integers 0 to {len(MOTIONS) - 1}")
    return index
