"""What the single-mission environments share: seeds, infos, pictures, snapshots."""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .arguments import seed_of, shown
from .config import Config, ConfigLike
from .errors import ConfigError, ResetNeededError
from .model import Model, derive_seed
from .render import draw
from .scene import Scene
from .sim import EPISODE_INFO, REWARD_NAMES, Sim, StepOutcome
from .spaces import Credit
from .viewer import Viewer

RENDER_MODES = ("rgb_array", "human")
RENDER_FPS = 8
TRAIL_STEPS = 5


class Mission:
    """One simulation with its seeds and its pictures."""

    def __init__(self, config: ConfigLike, fields: dict[str, Any], render_mode: str | None) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(
                f"render_mode = {shown(render_mode)}: must be {', '.join(RENDER_MODES)} or None"
            )
        self.model = Model(Config(config, **fields))
        self.sim = Sim(self.model)
        self.render_mode = render_mode
        self._begun = self._seeded = False
        self._trail: deque[npt.NDArray[np.uint32]] = deque(maxlen=TRAIL_STEPS)
        self._viewer: Viewer | None = None

    def reset(self, seed: int | None, options: Mapping[str, Any] | None = None) -> None:
        """Begin an episode; without a seed, the one that follows the last, as in a batch.

        With `options["snapshot"]` the saved state is taken up instead.
        """
        if options and "snapshot" in options:
            self.sim.load(options["snapshot"])
        elif seed is not None:
            self.sim.reset(seed_of("seed", seed))
        elif self._seeded:
            self.sim.reset(derive_seed(self.sim.seed, 0))
        else:
            self.sim.reset(int(np.random.default_rng().integers(0, 2**64, dtype=np.uint64)))
        self._begun = self._seeded = True
        self._trail.clear()
        self._show()

    def step(self, actions: npt.NDArray[np.float32]) -> StepOutcome:
        """Step the fleet and show it where a window was asked for."""
        self.need_reset("step")
        if self.render_mode is not None:
            self._trail.append(self.sim.cells())
        outcome = self.sim.step(actions)
        self._show()
        return outcome

    def rewards(
        self, credit: Credit, outcome: StepOutcome, agents: Sequence[str]
    ) -> dict[str, float]:
        """Give each agent the team's reward, or its own."""
        if credit == "team":
            return dict.fromkeys(agents, outcome.reward)
        return dict(zip(agents, self.sim.uav_rewards().tolist(), strict=True))

    def info(self, outcome: StepOutcome | None = None) -> dict[str, Any]:
        """Reward components of the step, and the episode's metrics: zeros until its end."""
        if outcome is None:
            return {"reward_components": np.zeros(len(REWARD_NAMES)), **EPISODE_INFO}
        info: dict[str, Any] = {"reward_components": self.sim.reward_component_array()}
        if not (outcome.terminated or outcome.truncated):
            return {**info, **EPISODE_INFO}
        metrics = {"success": outcome.terminated, **self.sim.metrics()}
        return {**info, **{name: metrics[name] for name in EPISODE_INFO}}

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self.sim.terminated or self.sim.truncated

    def fork(self) -> Mission:
        """Return an independent copy with the same state and seeds to come, without a window."""
        twin = copy.copy(self)
        twin.sim = self.sim.fork()
        twin.render_mode = None if self.render_mode == "human" else self.render_mode
        twin._trail = self._trail.copy()
        twin._viewer = None
        return twin

    def __deepcopy__(self, memo: object) -> Mission:
        return self.fork()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_viewer": None}

    def scene(self) -> Scene:
        """What a picture of this moment shows."""
        return self.sim.scene(tuple(self._trail))

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Give the picture (`rgb_array`), or show it (`human`)."""
        self.need_reset("render")
        if self.render_mode is None:
            raise ConfigError(
                "render without a mode: make the environment with render_mode='rgb_array' or "
                "'human'"
            )
        if self.render_mode == "rgb_array":
            return draw(self.scene())
        self._show()
        return None

    def close(self) -> None:
        """Close the window, if there is one. A step needs a reset again."""
        self._begun = False
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def need_reset(self, what: str) -> None:
        """Refuse what makes no sense before the first reset, or after the environment's end."""
        if not self._begun:
            raise ResetNeededError(
                f"{what} before the first reset, or after close: call reset first"
            )

    def _show(self) -> None:
        if self.render_mode != "human":
            return
        if self._viewer is None:
            self._viewer = Viewer("jcas", RENDER_FPS)
        self._viewer.show(draw(self.scene()))


class MissionEnv:
    """What environments of one mission have in common under every interface."""

    _mission: Mission
    render_mode: str | None = None

    @property
    def model(self) -> Model:
        """The immutable model behind the environment."""
        return self._mission.model

    @property
    def sim(self) -> Sim:
        """The simulation itself, with every quantity of its state."""
        return self._mission.sim

    def __repr__(self) -> str:
        model, mission = self.model, self._mission
        moment = (
            f"step {mission.sim.t} of {model.config['horizon_steps']}"
            if mission._begun
            else "not yet reset"
        )
        return (
            f"<jcas.{type(self).__name__}: {model.uav_count} UAVs, "
            f"{model.hotspot_count} hotspots, {moment}>"
        )

    def state(self) -> npt.NDArray[np.float32]:
        """Return the global state, for a centralised critic."""
        self._mission.need_reset("state")
        return self.sim.observe_global()

    def render(self) -> Any:
        """Give or show the picture, as `render_mode` says."""
        return self._mission.render()

    def close(self) -> None:
        """Close the window, if there is one."""
        self._mission.close()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        self._mission.need_reset("save")
        return self.sim.save()

    def fork(self) -> Any:
        """Return an independent environment in the same state and with the same seeds to come."""
        twin = copy.deepcopy(self)
        twin.render_mode = twin._mission.render_mode
        return twin
