"""The Gymnasium environment: a whole fleet steered by one joint action."""

from __future__ import annotations

import copy
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import options_of, seed_of
from .config import ConfigLike
from .mission import RENDER_FPS, RENDER_MODES, Mission
from .model import Model
from .signature import shows_fields
from .sim import Sim
from .spaces import (
    ActionSpaceKind,
    Credit,
    check_credit,
    check_kind,
    encode_fleet_action,
    fleet_action_space,
)

Observation = npt.NDArray[np.float32]


class FleetEnv(gymnasium.Env[Observation, Any]):
    """One fleet: observations [N, observation length], actions [N, 2] (or hybrid), one team reward.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        action_space: `box` (u_dir, u_pilot), or the hybrids `dict` and `tuple` of (motion, pilot).
            Hybrid actions have a discrete motion and a continuous pilot density.
        credit: with `uav`, `info["uav_rewards"]` holds each UAV's own reward. Their mean is the
            team's reward.
        render_mode: `rgb_array`, `human`, or None.
        **fields: configuration fields that replace those of `config`; `jcas.Config.fields()` lists
            them.

    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": RENDER_FPS}

    @shows_fields
    def __init__(
        self,
        config: ConfigLike = None,
        *,
        action_space: ActionSpaceKind = "box",
        credit: Credit = "team",
        render_mode: str | None = None,
        **fields: Unpack[Fields],
    ) -> None:
        self._mission = Mission(config, dict(fields), render_mode)
        self._kind = check_kind(action_space)
        self._credit = check_credit(credit)
        self.render_mode = render_mode
        uavs = self.model.uav_count
        self._shape = (uavs, 2)
        self.observation_space = self.model.observation_space(uavs)
        self.action_space = fleet_action_space(self._kind, uavs)

    @property
    def model(self) -> Model:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Sim:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def __repr__(self) -> str:
        return self._mission.describe("jcas.FleetEnv")

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode. Equal seeds give equal episodes; without one, episodes differ.

        `options["snapshot"]`, bytes of `save`, takes that state up instead of beginning anew.
        """
        given = options_of(options, "snapshot")
        super().reset(seed=None if seed is None else seed_of("seed", seed))
        self._mission.reset(seed, given)
        return self._mission.sim.observe(), {}

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Step the fleet. `info` holds the reward components and finally the episode's metrics."""
        outcome = self._mission.step(encode_fleet_action(self._kind, action, self._shape))
        info = self._mission.step_info(outcome)
        if self._credit == "uav":
            info["uav_rewards"] = self._mission.sim.uav_rewards()
        return (
            self._mission.sim.observe(),
            outcome.reward,
            outcome.terminated,
            outcome.truncated,
            info,
        )

    def state(self) -> Observation:
        """Return the global state, for a centralised critic."""
        return self._mission.state()

    def render(self) -> Any:
        """Give or show the picture, as `render_mode` says."""
        return self._mission.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._mission.close()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        return self._mission.save()

    def load(self, snapshot: bytes) -> Observation:
        """Take up a saved state of the same configuration and return its observation."""
        self._mission.reset(None, {"snapshot": snapshot})
        return self._mission.sim.observe()

    def fork(self) -> FleetEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        twin = copy.deepcopy(self)
        twin.render_mode = twin._mission.render_mode
        return twin
