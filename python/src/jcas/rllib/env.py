"""RLlib's environment: each UAV is an agent with its own observation and the global state."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from ray.rllib.env.multi_agent_env import MultiAgentEnv

from ..arguments import options_of
from ..mission import Mission, MissionEnv
from ..model import derive_seed
from ..sim import StepOutcome
from ..spaces import ActionForm, check_credit

SHARED_POLICY = "shared"


class JcasMultiAgentEnv(MissionEnv, MultiAgentEnv):
    """Observations are dicts: `observation` for the actor, `state` for the critic alone.

    Args:
        config: RLlib's environment configuration. Its fields are those of `jcas.Config`, `credit`
            and `seed`. `credit` is `team` (the default) or `uav`, as in `jcas.parallel_env`. `seed`
            is that of the training run.

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
        self._form = ActionForm(self.model)
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        # RLlib's check of an environment wants every agent of the last observations in this list.
        self.agents = list(self.possible_agents)
        observation = spaces.Dict(
            {"observation": self.model.observation_space(), "state": self.model.global_space()}
        )
        self.observation_spaces = dict.fromkeys(self.possible_agents, observation)
        self.action_spaces = dict.fromkeys(self.possible_agents, self._form.uav_space())
        self._actions = np.zeros((self.model.uav_count, 2), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode: outside RLlib the one that `jcas.parallel_env` begins."""
        if seed is not None and self._runner_seed is not None:
            seed = derive_seed(self._runner_seed, seed)
        self._mission.reset(seed, options_of(options, "snapshot"))
        return self._observations(), self._infos(None)

    def step(
        self, action_dict: dict[str, Any]
    ) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Any]]:
        """Step every UAV. The infos are those of `jcas.parallel_env`."""
        self._mission.need_reset("step")
        self._form.encode_uavs(self.possible_agents, action_dict, self._actions)
        outcome = self._mission.step(self._actions)
        terminated = dict.fromkeys(self.possible_agents, outcome.terminated)
        truncated = dict.fromkeys(self.possible_agents, outcome.truncated)
        terminated["__all__"] = outcome.terminated
        truncated["__all__"] = outcome.truncated
        rewards = self._mission.rewards(self._credit, outcome, self.possible_agents)
        return self._observations(), rewards, terminated, truncated, self._infos(outcome)

    def load(self, snapshot: bytes) -> dict[str, Any]:
        """Take up a saved state of the same configuration and return its observations."""
        return self.reset(options={"snapshot": snapshot})[0]

    def _observations(self) -> dict[str, Any]:
        state = self.sim.observe_global()
        rows = self.sim.observe()
        return {
            agent: {"observation": row, "state": state}
            for agent, row in zip(self.possible_agents, rows, strict=True)
        }

    def _infos(self, outcome: StepOutcome | None) -> dict[str, Any]:
        info = self._mission.info(outcome)
        return {agent: dict(info) for agent in self.possible_agents}
