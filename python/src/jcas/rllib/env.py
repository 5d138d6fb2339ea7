"""RLlib's environment: each UAV is an agent with its own observation and the global state."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from gymnasium import spaces
from ray.rllib.env.multi_agent_env import MultiAgentEnv

from ..mission import Mission
from ..model import Model, derive_seed
from ..sim import Sim
from ..spaces import check_credit, encode_uav_actions, uav_action_space

SHARED_POLICY = "shared"


class JcasMultiAgentEnv(MultiAgentEnv):
    """Observations are dicts: `observation` for the actor, `state` for the critic alone.

    Args:
        config: RLlib's environment configuration; its fields are those of `jcas.Config`,
            `credit`: `team` (the default) or `uav`, as in `jcas.parallel_env`, and `seed`: of the
            training run.

    RLlib gives environment i of runner w the seed `seed + w + i`, so that runners share episodes.
    Where RLlib says which runner it is, the seed of an episode is derived from the run's seed, the
    runner and what RLlib gives.

    """

    def __init__(self, config: dict[str, Any] | None = None) -> None:
        super().__init__()
        fields = dict(config or {})
        self._credit = check_credit(fields.pop("credit", "team"))
        run_seed, runner = fields.pop("seed", 0), getattr(config, "worker_index", None)
        self._runner_seed = None if runner is None else derive_seed(run_seed, runner)
        self._mission = Mission(fields, {}, None)
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        self.agents = list(self.possible_agents)
        observation = spaces.Dict(
            {"observation": self.model.observation_space(), "state": self.model.global_space()}
        )
        self.observation_spaces = dict.fromkeys(self.possible_agents, observation)
        self.action_spaces = dict.fromkeys(self.possible_agents, uav_action_space("box"))
        self._actions = np.zeros((self.model.uav_count, 2), np.float32)

    @property
    def model(self) -> Model:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Sim:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def __repr__(self) -> str:
        return self._mission.describe("jcas.rllib.JcasMultiAgentEnv")

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode: outside RLlib the one that `jcas.parallel_env` begins."""
        if seed is not None and self._runner_seed is not None:
            seed = derive_seed(self._runner_seed, seed)
        self._mission.reset(seed, options)
        self.agents = list(self.possible_agents)
        return self._observations(), {}

    def step(
        self, action_dict: dict[str, Any]
    ) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Any]]:
        """Step every UAV. The last infos of an episode hold its metrics."""
        self._mission.need_reset("step")
        encode_uav_actions("box", self.possible_agents, action_dict, self._actions)
        outcome = self._mission.step(self._actions)
        terminated = dict.fromkeys(self.possible_agents, outcome.terminated)
        truncated = dict.fromkeys(self.possible_agents, outcome.truncated)
        terminated["__all__"] = outcome.terminated
        truncated["__all__"] = outcome.truncated
        rewards = self._mission.rewards(self._credit, outcome, self.possible_agents)
        infos: dict[str, Any] = {}
        if outcome.terminated or outcome.truncated:
            metrics = self.sim.metrics()
            infos = {agent: {"metrics": dict(metrics)} for agent in self.possible_agents}
        return self._observations(), rewards, terminated, truncated, infos

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        return self._mission.save()

    def load(self, snapshot: bytes) -> dict[str, Any]:
        """Take up a saved state of the same configuration and return its observations."""
        return self.reset(options={"snapshot": snapshot})[0]

    def fork(self) -> JcasMultiAgentEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        return copy.deepcopy(self)

    def _observations(self) -> dict[str, Any]:
        state = self.sim.observe_global()
        rows = self.sim.observe()
        return {
            agent: {"observation": row, "state": state}
            for agent, row in zip(self.possible_agents, rows, strict=True)
        }
