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
from .mission import RENDER_FPS, RENDER_MODES, Mission, MissionEnv
from .model import Model
from .signature import shows_fields, takes_what
from .sim import Sim, StepOutcome
from .spaces import ActionForm, ActionSpaceKind, Credit, check_credit

Observation = npt.NDArray[np.float32]


class JcasParallelEnv(MissionEnv, ParallelEnv[str, Observation, Any]):
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
        pilot_levels: int = 3,
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
        self._form = ActionForm(self.model, action_space, pilot_levels)
        self._credit = check_credit(credit)
        self.render_mode = render_mode
        self.possible_agents = [f"uav_{uav}" for uav in range(self.model.uav_count)]
        self.agents: list[str] = []
        observation_space = self.model.observation_space()
        self.observation_spaces = {
            agent: copy.deepcopy(observation_space) for agent in self.possible_agents
        }
        self.action_spaces = {agent: self._form.uav_space() for agent in self.possible_agents}
        self.state_space = self.model.global_space()
        self.np_random = np.random.default_rng()
        self._actions = np.zeros((self.model.uav_count, 2), dtype=np.float32)

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
        return self._observe(None)

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
        `infos` have the same keys at every step: `reward_components` of the team's reward, and the
        episode's metrics. These (`success`, `steps`, `confirmed`, ...) are 0 until its end. After
        the end, a step without actions changes nothing and returns nothing.
        """
        self._mission.need_reset("step")
        if not self.agents and isinstance(actions, Mapping) and not actions:
            return {}, {}, {}, {}, {}
        self._form.encode_uavs(self.possible_agents, actions, self._actions)
        outcome = self._mission.step(self._actions)
        agents = self.agents
        observations, infos = self._observe(outcome)
        if outcome.terminated or outcome.truncated:
            self.agents = []
        return (
            observations,
            self._mission.rewards(self._credit, outcome, agents),
            dict.fromkeys(agents, outcome.terminated),
            dict.fromkeys(agents, outcome.truncated),
            infos,
        )

    def load(self, snapshot: bytes) -> dict[str, Observation]:
        """Take up a saved state of the same configuration and return its observations."""
        return self.reset(options={"snapshot": snapshot})[0]

    def _observe(
        self, outcome: StepOutcome | None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Observe, and give each agent infos of its own, for wrappers that write into them."""
        rows, info = self.sim.observe(), self._mission.info(outcome)
        components = info.pop("reward_components")
        infos = {agent: {"reward_components": components.copy(), **info} for agent in self.agents}
        if self._form.kind == "discrete":
            masks = self._form.mask(rows)
            for agent, mask in zip(self.agents, masks, strict=False):
                infos[agent]["action_mask"] = mask
        return dict(zip(self.possible_agents, rows, strict=True)), infos

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
        return repr(self.fleet).replace(type(self.fleet).__name__, type(self).__name__)

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


@takes_what(JcasParallelEnv.__init__)
def parallel_env(*arguments: Any, **options: Any) -> JcasParallelEnv:
    """Make a PettingZoo parallel environment with one agent for each UAV.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        action_space: `box` (u_dir, u_pilot), the hybrids `dict` and `tuple` of a discrete motion
            and a continuous pilot density, or `discrete`: `motion * pilot_levels + level`. The
            infos then hold an `action_mask`.
        pilot_levels: pilot densities of `discrete`, evenly spaced.
        credit: with `team`, as in the paper, each agent receives the team's reward. With `uav` it
            receives its own. The mean of these over the fleet is the team's reward.
        render_mode: `rgb_array`, `human`, or None.
        max_cycles: PettingZoo's name of the field `horizon_steps`.
        **fields: configuration fields that replace those of `config`; `jcas.Config.fields()` lists
            them.

    """
    return JcasParallelEnv(*arguments, **options)


@takes_what(JcasParallelEnv.__init__)
def env(*arguments: Any, **options: Any) -> JcasEnv:
    """Make the turn-based PettingZoo environment, with the options of `parallel_env`."""
    return JcasEnv(JcasParallelEnv(*arguments, **options))
