"""Action spaces, and their conversion to the kernel's pair (u_dir, u_pilot) in [-1, 1] per UAV.

`box` is the kernel's own form (and the paper's). `dict` and `tuple` are hybrid: a choice among the
five motions beside a continuous pilot command, for algorithms that treat the two apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from .arguments import floats, shown
from .errors import ActionError, ConfigError

ActionSpaceKind = Literal["box", "dict", "tuple"]

Credit = Literal["team", "uav"]
"""An agent's reward: the team's, as in the paper, or its own, whose mean is the team's."""

MOTIONS = ("up", "down", "left", "right", "stay")
"""Motions by index: +y, -y, -x, +x, none."""

FloatArray = npt.NDArray[np.float32]


def motion_to_command(motion: Any) -> Any:
    """Turn motion indices into the u_dir in the middle of their bin."""
    return np.asarray(motion, dtype=np.float32) * np.float32(0.4) - np.float32(0.8)


def check_kind(kind: str) -> ActionSpaceKind:
    """Refuse the name of an action space that does not exist."""
    if kind not in get_args(ActionSpaceKind):
        raise ConfigError(
            f"action_space = {shown(kind)}: must be one of {', '.join(get_args(ActionSpaceKind))}"
        )
    return kind  # type: ignore[return-value]


def check_credit(credit: str) -> Credit:
    """Refuse a credit that does not exist."""
    if credit not in get_args(Credit):
        raise ConfigError(f"credit = {shown(credit)}: must be one of {', '.join(get_args(Credit))}")
    return credit  # type: ignore[return-value]


def uav_action_space(kind: ActionSpaceKind) -> spaces.Space[Any]:
    """Describe the actions of one UAV."""
    if kind == "box":
        return spaces.Box(-1.0, 1.0, (2,), np.float32)
    motion: spaces.Space[Any] = spaces.Discrete(len(MOTIONS))
    pilot: spaces.Space[Any] = spaces.Box(-1.0, 1.0, (1,), np.float32)
    return (
        spaces.Dict({"motion": motion, "pilot": pilot})
        if kind == "dict"
        else spaces.Tuple((motion, pilot))
    )


def fleet_action_space(kind: ActionSpaceKind, uavs: int) -> spaces.Space[Any]:
    """Describe the joint actions of a fleet."""
    if kind == "box":
        return spaces.Box(-1.0, 1.0, (uavs, 2), np.float32)
    motion: spaces.Space[Any] = spaces.MultiDiscrete([len(MOTIONS)] * uavs)
    pilot: spaces.Space[Any] = spaces.Box(-1.0, 1.0, (uavs,), np.float32)
    return (
        spaces.Dict({"motion": motion, "pilot": pilot})
        if kind == "dict"
        else spaces.Tuple((motion, pilot))
    )


def encode_uav_action(kind: ActionSpaceKind, action: Any, out: FloatArray, uav: str) -> None:
    """Write one UAV's action into its pair of the kernel's buffer."""
    if kind == "box":
        out[:] = floats(f"action of {uav}", action, (2,), what=", for u_dir and u_pilot")
        return
    motion, pilot = _parts(kind, action)
    index = _motion_index(motion, uav)
    if index.shape not in ((), (1,)):
        raise ActionError(f"motion of {uav} has shape {index.shape}: must be one integer")
    out[0] = motion_to_command(index.reshape(()))
    shape = () if np.ndim(pilot) == 0 else (1,)
    out[1] = floats(f"pilot of {uav}", pilot, shape).reshape(())


def encode_uav_actions(
    kind: ActionSpaceKind, agents: Sequence[str], actions: Any, out: FloatArray
) -> None:
    """Write a dict with an action for each agent into the kernel's buffer, [N, 2]."""
    if not isinstance(actions, Mapping):
        raise ActionError(
            f"actions = {shown(actions)}: must be a dict with an action for each agent"
        )
    for uav, agent in enumerate(agents):
        if agent not in actions:
            raise ActionError(
                f"no action for {agent}: must be one for each of {len(agents)} agents"
            )
        encode_uav_action(kind, actions[agent], out[uav], agent)
    if len(actions) > len(agents):
        strange = next(agent for agent in actions if agent not in agents)
        raise ActionError(f"an action for {shown(strange)}: there is no such agent")


def encode_fleet_action(kind: ActionSpaceKind, action: Any, shape: tuple[int, ...]) -> FloatArray:
    """Turn joint actions into the kernel's form of the given shape [..., N, 2].

    Actions that already are contiguous float32 of that shape are handed on without a copy.
    """
    if kind == "box":
        return floats("actions", action, shape)
    motion, pilot = _parts(kind, action)
    index = _motion_index(motion, "the fleet")
    if index.shape != shape[:-1]:
        raise ActionError(f"motion: the shape is {index.shape}, must be {shape[:-1]}")
    pairs = np.empty(shape, dtype=np.float32)
    pairs[..., 0] = motion_to_command(index)
    pairs[..., 1] = floats("pilot", pilot, shape[:-1])
    return pairs


def _parts(kind: ActionSpaceKind, action: Any) -> tuple[Any, Any]:
    if kind == "dict":
        if not isinstance(action, Mapping) or set(action) != {"motion", "pilot"}:
            raise ActionError(f"action {shown(action)}: must be a dict of motion and pilot")
        return action["motion"], action["pilot"]
    if not isinstance(action, Sequence) or len(action) != 2:
        raise ActionError(f"action {shown(action)}: must be a tuple (motion, pilot)")
    return action[0], action[1]


def _motion_index(motion: Any, owner: str) -> Any:
    try:
        index = np.asarray(motion)
    except (TypeError, ValueError):
        index = np.empty(0, object)
    if (
        not np.issubdtype(index.dtype, np.integer)
        or (index < 0).any()
        or (index >= len(MOTIONS)).any()
    ):
        raise ActionError(
            f"motion of {owner} is {shown(motion)}: must be integers from 0 to {len(MOTIONS) - 1}"
        )
    return index
