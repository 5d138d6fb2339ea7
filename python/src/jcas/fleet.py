"""The Gymnasium environment: a whole fleet steered by one joint action."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import options_of, seed_of
from .config import ConfigLike
from .mission import RENDER_FPS, RENDER_MODES, Mission, MissionEnv
from .signature import shows_fields
from .sim import StepOutcome
from .spaces import ActionForm, ActionSpaceKind, Credit, check_credit

Observation = npt.NDArray[np.float32]


class FleetEnv(MissionEnv, gymnasium.Env[Observation, Any]):
    """One fleet: observations [N, observation length], actions [N, 2] (or hybrid), one team reward.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        action_space: `box` (u_dir, u_pilot), the hybrids `dict` and `tuple` of a discrete motion
            and a continuous pilot density, or `discrete`: `motion * pilot_levels + level`.
        pilot_levels: pilot densities of `discrete`, evenly spaced.
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
        pilot_levels: int = 3,
        credit: Credit = "team",
        render_mode: str | None = None,
        **fields: Unpack[Fields],
    ) -> None:
        self._mission = Mission(config, dict(fields), render_mode)
        self._form = ActionForm(self.model, action_space, pilot_levels)
        self._credit = check_credit(credit)
        self.render_mode = render_mode
        uavs = self.model.uav_count
        self._shape = (uavs, 2)
        self.observation_space = self.model.observation_space(uavs)
        self.action_space = self._form.fleet_space(uavs)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode. Equal seeds give equal episodes; without one, episodes differ.

        `options["snapshot"]`, bytes of `save`, takes that state up instead of beginning anew.
        """
        given = options_of(options, "snapshot")
        super().reset(seed=None if seed is None else seed_of("seed", seed))
        self._mission.reset(seed, given)
        return self._observe(None)

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Step the fleet.

        `info` has the same keys at every step: `reward_components` in the order of
        `jcas.REWARD_NAMES`, and the episode's metrics. These (`success`, `steps`, `confirmed`, ...)
        are 0 until its end.
        """
        outcome = self._mission.step(self._form.encode_fleet(action, self._shape))
        observation, info = self._observe(outcome)
        return observation, outcome.reward, outcome.terminated, outcome.truncated, info

    def action_masks(self) -> npt.NDArray[np.bool_]:
        """Which discrete actions make a difference, [N * 5 levels], as MaskablePPO asks."""
        return self._form.mask(self.sim.observe()).astype(bool).reshape(-1)

    def load(self, snapshot: bytes) -> Observation:
        """Take up a saved state of the same configuration and return its observation."""
        self._mission.reset(None, {"snapshot": snapshot})
        return self.sim.observe()

    def _observe(self, outcome: StepOutcome | None) -> tuple[Observation, dict[str, Any]]:
        observation, info = self.sim.observe(), self._mission.info(outcome)
        if self._credit == "uav":
            own = np.zeros(len(observation)) if outcome is None else self.sim.uav_rewards()
            info["uav_rewards"] = own
        if self._form.kind == "discrete":
            info["action_mask"] = self._form.mask(observation)
        return observation, info
