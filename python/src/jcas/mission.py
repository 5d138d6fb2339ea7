"""What the single-mission environments share: seeds, pictures, snapshots."""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .arguments import seed_of, shown
from .config import Config, ConfigLike
from .errors import ConfigError, ResetNeededError
from .model import Model
from .render import draw
from .scene import Scene
from .sim import Sim, StepOutcome
from .spaces import Credit
from .viewer import Viewer

RENDER_MODES = ("rgb_array", "human")
RENDER_FPS = 8
TRAIL_STEPS = 5


class Mission:
    """One simulation with its seed stream and its pictures."""

    def __init__(self, config: ConfigLike, fields: dict[str, Any], render_mode: str | None) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(
                f"render_mode = {shown(render_mode)}: must be {', '.join(RENDER_MODES)} or None"
            )
        self.model = Model(Config(config, **fields))
        self.sim = Sim(self.model)
        self.render_mode = render_mode
        self._begun = False
        self._seeds = np.random.default_rng()
        self._trail: deque[npt.NDArray[np.uint32]] = deque(maxlen=TRAIL_STEPS)
        self._viewer: Viewer | None = None

    def reset(self, seed: int | None, options: Mapping[str, Any] | None = None) -> None:
        """Begin an episode; without a seed, the next one of the stream that the last seed began.

        With `options["snapshot"]` the saved state is taken up instead.
        """
        if options and "snapshot" in options:
            self.sim.load(options["snapshot"])
        elif seed is not None:
            own = seed_of("seed", seed)
            self._seeds = np.random.default_rng(own)
            self.sim.reset(own)
        else:
            self.sim.reset(int(self._seeds.integers(0, 2**64, dtype=np.uint64)))
        self._begun = True
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

    def rewards(self, credit: Credit, outcome: StepOutcome, agents: list[str]) -> dict[str, float]:
        """Give each agent the team's reward, or its own."""
        if credit == "team":
            return dict.fromkeys(agents, outcome.reward)
        return dict(zip(agents, self.sim.uav_rewards().tolist(), strict=True))

    def step_info(self, outcome: StepOutcome) -> dict[str, Any]:
        """Reward components of the step, and the episode's metrics at its end."""
        info: dict[str, Any] = {"reward_components": self.sim.reward_components()}
        if outcome.terminated or outcome.truncated:
            info["metrics"] = self.sim.metrics()
        return info

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        episode = self.sim.episode()
        return bool(episode.terminated or episode.truncated)

    def state(self) -> npt.NDArray[np.float32]:
        """Observe the global state."""
        self.need_reset("state")
        return self.sim.observe_global()

    def save(self) -> bytes:
        """Save the whole state of the episode."""
        self.need_reset("save")
        return self.sim.save()

    def fork(self) -> Mission:
        """Return an independent copy with the same state and stream of seeds, without a window."""
        twin = copy.copy(self)
        twin.sim = self.sim.fork()
        twin.render_mode = None if self.render_mode == "human" else self.render_mode
        twin._seeds = copy.deepcopy(self._seeds)
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
        if self.render_mode == "rgb_array":
            return draw(self.scene())
        self._show()
        return None

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def need_reset(self, what: str) -> None:
        """Refuse what makes no sense before the first reset."""
        if not self._begun:
            raise ResetNeededError(f"{what} before the first reset: call reset first")

    def describe(self, environment: str) -> str:
        """Write an environment for `repr`."""
        moment = (
            f"step {self.sim.t} of {self.model.config['horizon_steps']}"
            if self._begun
            else "not yet reset"
        )
        return (
            f"<{environment}: {self.model.uav_count} UAVs, "
            f"{self.model.hotspot_count} hotspots, {moment}>"
        )

    def _show(self) -> None:
        if self.render_mode != "human":
            return
        if self._viewer is None:
            self._viewer = Viewer("jcas", RENDER_FPS)
        self._viewer.show(draw(self.scene()))
