"""The fleet as RLlib sees it: each UAV an agent that observes for itself, with the global state beside."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from ray.rllib.env.multi_agent_env import MultiAgentEnv

from ..config import Config
from ..model import Model
from ..sim import Sim
from ..spaces import uav_action_space

SHARED_POLICY = "shared"


class JcasMultiAgentEnv(MultiAgentEnv):
    """Observations are dicts: `observation` for the actor, `state` for the critic alone.

    Args:
        config: RLlib's environment configuration; its fields are those of :class:`jcas.Config`.

    """

    def __init__(self, config: dict[str, Any] | None = None) -> None:
        super().__init__()
        self.model = Model(Config(dict(config or {})))
        self.sim = Sim(self.model)
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        self.agents = list(self.possible_agents)
        observation = spaces.Dict({"observation": self.model.observation_space(), "state": self.model.global_space()})
        self.observation_spaces = dict.fromkeys(self.possible_agents, observation)
        self.action_spaces = dict.fromkeys(self.possible_agents, uav_action_space("box"))
        self._seeds = np.random.default_rng()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode."""
        del options
        if seed is not None:
            self._seeds = np.random.default_rng(seed)
        self.sim.reset(int(self._seeds.integers(0, 2**64, dtype=np.uint64)))
        self.agents = list(self.possible_agents)
        return self._observations(), {}

    def step(
        self, action_dict: dict[str, Any]
    ) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Any]]:
        """Step every UAV; each receives the team's reward. At the end its metrics stand in every info."""
        actions = np.stack([action_dict[agent] for agent in self.possible_agents])
        outcome = self.sim.step(actions)
        terminated = dict.fromkeys(self.possible_agents, outcome.terminated)
        truncated = dict.fromkeys(self.possible_agents, outcome.truncated)
        terminated["__all__"] = outcome.terminated
        truncated["__all__"] = outcome.truncated
        rewards = dict.fromkeys(self.possible_agents, outcome.reward)
        infos: dict[str, Any] = {}
        if outcome.terminated or outcome.truncated:
            metrics = self.sim.metrics()
            infos = {agent: {"metrics": metrics} for agent in self.possible_agents}
        return self._observations(), rewards, terminated, truncated, infos

    def _observations(self) -> dict[str, Any]:
        state = self.sim.observe_global()
        rows = self.sim.observe()
        return {
            agent: {"observation": row, "state": state} for agent, row in zip(self.possible_agents, rows, strict=True)
        }
