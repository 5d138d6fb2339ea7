"""The PettingZoo environments: one agent for each UAV, all acting at once or turn by turn."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from pettingzoo import ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import options_of, shown
from .config import ConfigLike
from .errors import ArgumentError, ConfigError, SnapshotError
from .mission import RENDER_FPS, RENDER_MODES, Mission
from .model import Model
from .signature import shows_fields
from .sim import Sim
from .spaces import (
    ActionSpaceKind,
    Credit,
    check_credit,
    check_kind,
    encode_uav_actions,
    uav_action_space,
)

Observation = npt.NDArray[np.float32]


class JcasParallelEnv(ParallelEnv[str, Observation, Any]):
    """A fleet as PettingZoo sees it. Made by `parallel_env`."""

    metadata: dict[str, Any] = {
        "name": "jcas_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": RENDER_FPS,
        "is_parallelizable": True,
    }

    @shows_fields
    def __init__(
        self,
        config: ConfigLike = None,
        *,
        action_space: ActionSpaceKind = "box",
        credit: Credit = "team",
        render_mode: str | None = None,
        max_cycles: int | None = None,
        **fields: Unpack[Fields],
    ) -> None:
        if max_cycles is not None:
            if "horizon_steps" in fields:
                raise ConfigError(
                    "max_cycles and horizon_steps are two names of one field: give one of them"
                )
            fields["horizon_steps"] = max_cycles
        self._mission = Mission(config, dict(fields), render_mode)
        self._kind = check_kind(action_space)
        self._credit = check_credit(credit)
        self.render_mode = render_mode
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        self.agents: list[str] = []
        observation_space = self.model.observation_space()
        self.observation_spaces = {
            agent: copy.deepcopy(observation_space) for agent in self.possible_agents
        }
        self.action_spaces = {agent: uav_action_space(self._kind) for agent in self.possible_agents}
        self.state_space = self.model.global_space()
        self.np_random = np.random.default_rng()
        self._actions = np.zeros((self.model.uav_count, 2), dtype=np.float32)

    @property
    def model(self) -> Model:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Sim:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def __repr__(self) -> str:
        return self._mission.describe("jcas.parallel_env")

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the observation space of one UAV, always the same object."""
        return self.observation_spaces[self._known(agent)]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the action space of one UAV, always the same object."""
        return self.action_spaces[self._known(agent)]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin an episode. Equal seeds give equal episodes; without one, episodes differ.

        `options["snapshot"]`, bytes of `save`, takes that state up instead of beginning anew.
        """
        # PettingZoo's conformance tests pass an option named "options", which changes nothing.
        self._mission.reset(seed, options_of(options, "snapshot", "options"))
        if seed is not None:
            self.np_random = np.random.default_rng(seed)
        self.agents = [] if self._mission.over else list(self.possible_agents)
        return self._observations(), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Step every UAV at once.

        The reward is the team's, the same for each agent, or with `credit="uav"` the agent's own.
        `infos` hold the components of the team's and, at the end of the episode, its metrics. After
        the end, a step without actions changes nothing and returns nothing.
        """
        self._mission.need_reset("step")
        if not self.agents and isinstance(actions, Mapping) and not actions:
            return {}, {}, {}, {}, {}
        encode_uav_actions(self._kind, self.possible_agents, actions, self._actions)
        outcome = self._mission.step(self._actions)
        agents = self.agents
        observations = self._observations()
        infos = self._infos(self._mission.step_info(outcome))
        if outcome.terminated or outcome.truncated:
            self.agents = []
        return (
            observations,
            self._mission.rewards(self._credit, outcome, agents),
            dict.fromkeys(agents, outcome.terminated),
            dict.fromkeys(agents, outcome.truncated),
            infos,
        )

    def state(self) -> Observation:
        """Return the global state, for a centralised critic."""
        return self._mission.state()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Give or show the picture, as `render_mode` says."""
        return self._mission.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._mission.close()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        return self._mission.save()

    def load(self, snapshot: bytes) -> dict[str, Observation]:
        """Take up a saved state of the same configuration and return its observations."""
        return self.reset(options={"snapshot": snapshot})[0]

    def fork(self) -> JcasParallelEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        twin = copy.deepcopy(self)
        twin.render_mode = twin._mission.render_mode
        return twin

    def _observations(self) -> dict[str, Observation]:
        return dict(zip(self.possible_agents, self._mission.sim.observe(), strict=True))

    def _infos(self, info: dict[str, Any]) -> dict[str, dict[str, Any]]:
        """Give each agent its own copy, for wrappers that write into it."""
        return {
            agent: {name: values.copy() for name, values in info.items()} for agent in self.agents
        }

    def _known(self, agent: str) -> str:
        if agent not in self.action_spaces:
            raise ArgumentError(
                f"agent = {shown(agent)}: must be uav_0 to uav_{len(self.possible_agents) - 1}"
            )
        return agent


class JcasEnv(OrderEnforcingWrapper[str, Observation, Any]):
    """The same in PettingZoo's turn-based form. Made by `env`."""

    def __init__(self, fleet: JcasParallelEnv) -> None:
        super().__init__(parallel_to_aec_wrapper(fleet))

    @property
    def fleet(self) -> JcasParallelEnv:
        """The environment in which all act at once, behind this one."""
        return self.env.unwrapped  # type: ignore[no-any-return]

    @property
    def model(self) -> Model:
        """The immutable model behind the environment."""
        return self.fleet.model

    @property
    def sim(self) -> Sim:
        """The simulation itself, with every quantity of its state."""
        return self.fleet.sim

    def __repr__(self) -> str:
        return self.fleet._mission.describe("jcas.env")

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """Begin an episode, or take up `options["snapshot"]`, as `JcasParallelEnv.reset`."""
        super().reset(seed=seed, options=options)

    def save(self) -> bytes:
        """Save the state of the episode. The first agent must be the next to act."""
        saved = self.fleet.save()
        if self.agents and self.agent_selection != self.possible_agents[0]:
            raise SnapshotError(
                f"save in the middle of a round: {self.agent_selection} is the next to act, "
                "not uav_0"
            )
        return saved

    def load(self, snapshot: bytes) -> None:
        """Take up a saved state of the same configuration whose episode has not ended."""
        twin = Sim(self.model)
        twin.load(snapshot)
        if twin.terminated or twin.truncated:
            raise SnapshotError("snapshot: its episode has ended, so that no agent could act")
        self.reset(options={"snapshot": snapshot})

    def fork(self) -> JcasEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        twin = copy.deepcopy(self)
        twin.env.render_mode = twin.fleet.render_mode = twin.fleet._mission.render_mode
        return twin


@shows_fields
def parallel_env(
    config: ConfigLike = None,
    *,
    action_space: ActionSpaceKind = "box",
    credit: Credit = "team",
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **fields: Unpack[Fields],
) -> JcasParallelEnv:
    """Make a PettingZoo parallel environment with one agent for each UAV.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        action_space: `box` (u_dir, u_pilot), or the hybrids `dict` and `tuple` of (motion, pilot).
            Hybrid actions have a discrete motion and a continuous pilot density.
        credit: with `team`, as in the paper, each agent receives the team's reward. With `uav` it
            receives its own. The mean of these over the fleet is the team's reward.
        render_mode: `rgb_array`, `human`, or None.
        max_cycles: PettingZoo's name of the field `horizon_steps`.
        **fields: configuration fields that replace those of `config`; `jcas.Config.fields()` lists
            them.

    """
    return JcasParallelEnv(
        config,
        action_space=action_space,
        credit=credit,
        render_mode=render_mode,
        max_cycles=max_cycles,
        **fields,
    )


@shows_fields
def env(
    config: ConfigLike = None,
    *,
    action_space: ActionSpaceKind = "box",
    credit: Credit = "team",
    render_mode: str | None = None,
    max_cycles: int | None = None,
    **fields: Unpack[Fields],
) -> JcasEnv:
    """Make the turn-based PettingZoo environment, with the options of `parallel_env`."""
    return JcasEnv(
        parallel_env(
            config,
            action_space=action_space,
            credit=credit,
            render_mode=render_mode,
            max_cycles=max_cycles,
            **fields,
        )
    )
