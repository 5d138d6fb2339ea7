"""Action spaces, and their conversion to the kernel's pair (u_dir, u_pilot) in [-1, 1] per UAV.

`box` is the kernel's own form, and the paper's. `dict` and `tuple` are hybrid: a choice among the
five motions beside a continuous pilot command. `discrete` numbers the pairs of a motion and a pilot
density, for value-based algorithms and for masks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from . import _abi
from .arguments import floats, shown, whole
from .errors import ActionError, ConfigError
from .model import Model

ActionSpaceKind = Literal["box", "dict", "tuple", "discrete"]

Credit = Literal["team", "uav"]
"""An agent's reward: the team's, as in the paper, or its own, whose mean is the team's."""

MOTIONS = ("up", "down", "left", "right", "stay")
"""Motions by index: +y, -y, -x, +x, none."""

FloatArray = npt.NDArray[np.float32]


_BINS = {
    _abi.JCAS_MOTIONS_UDLRS: MOTIONS,
    _abi.JCAS_MOTIONS_SYMMETRIC: ("up", "left", "stay", "right", "down"),
}
"""The motions over the bins of u_dir, by the model's `motion_map`."""


def check_credit(credit: str) -> Credit:
    """Refuse a credit that does not exist."""
    if credit not in get_args(Credit):
        raise ConfigError(f"credit = {shown(credit)}: must be one of {', '.join(get_args(Credit))}")
    return credit  # type: ignore[return-value]


@dataclass(frozen=True)
class ActionForm:
    """The form of the actions of an environment.

    Args:
        model: the model of the environment.
        kind: `box`, `dict`, `tuple` or `discrete`.
        levels: the pilot densities of `discrete`, evenly spaced from the lowest to the highest.
            Action `motion * levels + level` is a motion with a density.

    """

    model: Model
    kind: ActionSpaceKind = "box"
    levels: int = 3

    def __post_init__(self) -> None:
        kinds = get_args(ActionSpaceKind)
        if self.kind not in kinds:
            raise ConfigError(
                f"action_space = {shown(self.kind)}: must be one of {', '.join(kinds)}"
            )
        whole("pilot_levels", self.levels, 1, 256)

    @property
    def count(self) -> int:
        """The number of discrete actions of a UAV."""
        return len(MOTIONS) * self.levels

    def uav_space(self) -> spaces.Space[Any]:
        """Describe the actions of one UAV."""
        if self.kind == "discrete":
            return spaces.Discrete(self.count)
        return self._space((), (1,), spaces.Discrete(len(MOTIONS)))

    def fleet_space(self, uavs: int) -> spaces.Space[Any]:
        """Describe the joint actions of a fleet."""
        if self.kind == "discrete":
            return spaces.MultiDiscrete([self.count] * uavs)
        return self._space((uavs,), (uavs,), spaces.MultiDiscrete([len(MOTIONS)] * uavs))

    def _space(
        self, fleet: tuple[int, ...], pilots: tuple[int, ...], motion: spaces.Space[Any]
    ) -> spaces.Space[Any]:
        if self.kind == "box":
            return spaces.Box(-1.0, 1.0, (*fleet, 2), np.float32)
        pilot: spaces.Space[Any] = spaces.Box(-1.0, 1.0, pilots, np.float32)
        if self.kind == "tuple":
            return spaces.Tuple((motion, pilot))
        return spaces.Dict({"motion": motion, "pilot": pilot})

    def encode_uavs(self, agents: Sequence[str], actions: Any, out: FloatArray) -> None:
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
            self._encode_uav(actions[agent], out[uav], agent)
        if len(actions) > len(agents):
            strange = next(agent for agent in actions if agent not in agents)
            raise ActionError(f"an action for {shown(strange)}: there is no such agent")

    def _encode_uav(self, action: Any, out: FloatArray, uav: str) -> None:
        if self.kind == "box":
            out[:] = floats(f"action of {uav}", action, (2,), what=", for u_dir and u_pilot")
            return
        if self.kind == "discrete":
            index = _index(f"action of {uav}", action, self.count)
            if index.size != 1:
                raise ActionError(f"action of {uav} has shape {index.shape}: must be one integer")
            out[:] = self._pairs(index.reshape(()))
            return
        motion, pilot = self._parts(action)
        index = _index(f"motion of {uav}", motion, len(MOTIONS))
        if index.shape not in ((), (1,)):
            raise ActionError(f"motion of {uav} has shape {index.shape}: must be one integer")
        out[0] = self._u_dir(index.reshape(()))
        shape = () if np.ndim(pilot) == 0 else (1,)
        out[1] = floats(f"pilot of {uav}", pilot, shape).reshape(())

    def encode_fleet(self, action: Any, shape: tuple[int, ...]) -> FloatArray:
        """Turn joint actions into the kernel's form of the given shape [..., N, 2].

        Actions that already are contiguous float32 of that shape are handed on without a copy.
        """
        if self.kind == "box":
            return floats("actions", action, shape)
        if self.kind == "discrete":
            return self._pairs(_index("actions", action, self.count, shape[:-1]))
        motion, pilot = self._parts(action)
        pairs = np.empty(shape, dtype=np.float32)
        pairs[..., 0] = self._u_dir(_index("motion of the fleet", motion, len(MOTIONS), shape[:-1]))
        pairs[..., 1] = floats("pilot", pilot, shape[:-1])
        return pairs

    def mask(self, observations: FloatArray) -> npt.NDArray[np.int8]:
        """Mark the discrete actions that make a difference, [..., N, 5 levels], from observations.

        Off the grid and with an empty battery, a motion is the same as to stay.
        """
        fields, config = self.model.observation_fields(), self.model.config.record
        x, y, soc = (observations[..., fields[name][0]] for name in ("x", "y", "soc"))
        inside = [y < 1, y > 0, x > 0, x < 1]
        sides = [config.grid_height] * 2 + [config.grid_width] * 2
        moves = [way & (soc > 0) & (side > 1) for way, side in zip(inside, sides, strict=True)]
        motions = np.stack([*moves, np.ones_like(moves[0])], axis=-1)
        return np.repeat(motions, self.levels, axis=-1).astype(np.int8)

    def _pairs(self, index: Any) -> FloatArray:
        motion, level = np.divmod(index, self.levels)
        pilot = level * (2 / max(self.levels - 1, 1)) - 1
        return np.stack([self._u_dir(motion), pilot], axis=-1).astype(np.float32)

    def _u_dir(self, motion: Any) -> Any:
        """Turn motion indices into the middle of their bins."""
        order = _BINS[self.model.config.record.motion_map]
        bins = [order.index(name) for name in MOTIONS]
        centres = np.array([-0.8, -0.4, 0.0, 0.4, 0.8], dtype=np.float32)
        return centres[bins][motion]

    def _parts(self, action: Any) -> tuple[Any, Any]:
        if self.kind == "dict":
            if not isinstance(action, Mapping) or set(action) != {"motion", "pilot"}:
                raise ActionError(f"action {shown(action)}: must be a dict of motion and pilot")
            return action["motion"], action["pilot"]
        if not isinstance(action, Sequence) or len(action) != 2:
            raise ActionError(f"action {shown(action)}: must be a tuple (motion, pilot)")
        return action[0], action[1]


def _index(name: str, values: Any, count: int, shape: tuple[int, ...] | None = None) -> Any:
    """Return whole numbers below `count`, of a shape where one is given."""
    try:
        index = np.asarray(values)
    except (TypeError, ValueError):
        index = np.empty(0, object)
    if not np.issubdtype(index.dtype, np.integer) or ((index < 0) | (index >= count)).any():
        raise ActionError(f"{name} is {shown(values)}: must be integers from 0 to {count - 1}")
    if shape is not None and index.shape != shape:
        raise ActionError(f"{name}: the shape is {index.shape}, must be {shape}")
    return index
