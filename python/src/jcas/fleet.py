"""The Gymnasium environment: a whole fleet steered by one joint action."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

from .config import ConfigLike
from .mission import RENDER_FPS, RENDER_MODES, Mission
from .spaces import ActionSpaceKind, check_kind, encode_fleet_action, fleet_action_space

Observation = npt.NDArray[np.float32]


class FleetEnv(gymnasium.Env[Observation, Any]):
    """One mission: observations [N, observation length], actions [N, 2] (or hybrid), one team reward."""

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": RENDER_FPS}

    def __init__(
        self,
        config: ConfigLike = None,
        *,
        action_space: ActionSpaceKind = "box",
        render_mode: str | None = None,
        **fields: Any,
    ) -> None:
        self._mission = Mission(config, fields, render_mode)
        self._kind = check_kind(action_space)
        self.render_mode = render_mode
        uavs = self.model.uav_count
        self._shape = (uavs, 2)
        self.observation_space = self.model.observation_space(uavs)
        self.action_space = fleet_action_space(self._kind, uavs)

    @property
    def model(self) -> Any:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Any:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode. Equal seeds give equal episodes; without one, episodes differ."""
        super().reset(seed=seed)
        self._mission.reset(seed)
        return self._mission.sim.observe(), {}

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Step the fleet. `info` holds the reward's components and, at the end, the episode's metrics."""
        outcome = self._mission.step(encode_fleet_action(self._kind, action, self._shape))
        info = self._mission.step_info(outcome)
        return self._mission.sim.observe(), outcome.reward, outcome.terminated, outcome.truncated, info

    def state(self) -> Observation:
        """Return the global state, for a centralised critic."""
        return self._mission.sim.observe_global()

    def render(self) -> Any:
        """Give or show the picture, as `render_mode` says."""
        return self._mission.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._mission.close()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        return self._mission.sim.save()

    def load(self, snapshot: bytes) -> Observation:
        """Take up a saved state of the same configuration and return its observation."""
        self._mission.load(snapshot)
        return self._mission.sim.observe()

    def fork(self) -> FleetEnv:
        """Return an independent environment in the same state, for planning and search."""
        twin = FleetEnv(self.model.config, action_space=self._kind)
        twin.load(self.save())
        return twin
