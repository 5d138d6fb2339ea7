"""The PettingZoo environment: one agent for each UAV, all acting at once."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec

from .config import ConfigLike
from .errors import ActionError
from .mission import RENDER_FPS, RENDER_MODES, Mission
from .spaces import ActionSpaceKind, check_kind, encode_uav_action, uav_action_space

Observation = npt.NDArray[np.float32]


class JcasParallelEnv(ParallelEnv[str, Observation, Any]):
    """A fleet as PettingZoo sees it. Made by :func:`parallel_env`."""

    metadata: dict[str, Any] = {
        "name": "jcas_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": RENDER_FPS,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        config: ConfigLike = None,
        *,
        action_space: ActionSpaceKind = "box",
        render_mode: str | None = None,
        max_cycles: int | None = None,
        **fields: Any,
    ) -> None:
        if max_cycles is not None:
            fields["horizon_steps"] = max_cycles
        self._mission = Mission(config, fields, render_mode)
        self._kind = check_kind(action_space)
        self.render_mode = render_mode
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        self.agents: list[str] = []
        observation_space = self.model.observation_space()
        self.observation_spaces = {agent: copy.deepcopy(observation_space) for agent in self.possible_agents}
        self.action_spaces = {agent: uav_action_space(self._kind) for agent in self.possible_agents}
        self.state_space = self.model.global_space()
        self._actions = np.zeros((self.model.uav_count, 2), dtype=np.float32)

    @property
    def model(self) -> Any:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Any:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the observation space of one UAV, always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the action space of one UAV, always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin an episode. Equal seeds give equal episodes; without one, episodes differ."""
        del options
        self._mission.reset(seed)
        self.agents = list(self.possible_agents)
        return self._observations(), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Step every UAV at once.

        The reward is the team's, the same for each agent. `infos` hold its components and, at the end of
        the episode, its metrics.
        """
        for uav, agent in enumerate(self.possible_agents):
            if agent not in actions:
                raise ActionError(f"no action for {agent}: allowed is one for each of {len(self.agents)} agents")
            encode_uav_action(self._kind, actions[agent], self._actions[uav], agent)
        outcome = self._mission.step(self._actions)
        agents = self.agents
        observations = self._observations()
        info = self._mission.step_info(outcome)
        if outcome.terminated or outcome.truncated:
            self.agents = []
        return (
            observations,
            dict.fromkeys(agents, outcome.reward),
            dict.fromkeys(agents, outcome.terminated),
            dict.fromkeys(agents, outcome.truncated),
            {agent: info.copy() for agent in agents},
        )

    def state(self) -> Observation:
        """Return the global state, for a centralised critic."""
        return self._mission.sim.observe_global()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Give or show the picture, as `render_mode` says."""
        return self._mission.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._mission.close()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        return self._mission.sim.save()

    def load(self, snapshot: bytes) -> dict[str, Observation]:
        """Take up a saved state of the same configuration and return its observations."""
        self._mission.load(snapshot)
        over = self._mission.sim.terminated or self._mission.sim.truncated
        self.agents = [] if over else list(self.possible_agents)
        return self._observations()

    def fork(self) -> JcasParallelEnv:
        """Return an independent environment in the same state, for planning and search."""
        twin = JcasParallelEnv(self.model.config, action_space=self._kind)
        twin.load(self.save())
        return twin

    def _observations(self) -> dict[str, Observation]:
        return dict(zip(self.possible_agents, self._mission.sim.observe(), strict=True))


def parallel_env(
    config: ConfigLike = None,
    *,
    action_space: ActionSpaceKind = "box",
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **fields: Any,
) -> JcasParallelEnv:
    """Make a PettingZoo parallel environment with one agent for each UAV.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a :class:`~jcas.Config`.
        action_space: `box` (u_dir, u_pilot), or the hybrids `dict` and `tuple` of (motion, pilot).
        render_mode: `rgb_array`, `human`, or None.
        max_cycles: another name of `horizon_steps`, PettingZoo's own.
        **fields: configuration fields that replace those of `config`.

    """
    return JcasParallelEnv(config, action_space=action_space, render_mode=render_mode, max_cycles=max_cycles, **fields)


def env(config: ConfigLike = None, **options: Any) -> AECEnv[str, Observation, Any]:
    """Make the same environment in PettingZoo's turn-based form; options as :func:`parallel_env`."""
    return parallel_to_aec(parallel_env(config, **options))
