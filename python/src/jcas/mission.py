"""What the single-mission environments share: seeds, pictures, snapshots."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
import numpy.typing as npt

from .config import Config, ConfigLike
from .errors import ConfigError
from .model import Model
from .render import draw
from .scene import Scene
from .sim import Sim, StepOutcome
from .viewer import Viewer

RENDER_MODES = ("rgb_array", "human")
RENDER_FPS = 8
TRAIL_STEPS = 5


class Mission:
    """One simulation with its seed stream and its pictures."""

    def __init__(self, config: ConfigLike, fields: dict[str, Any], render_mode: str | None) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(f"render_mode = {render_mode!r}: allowed are {', '.join(RENDER_MODES)} and None")
        self.model = Model(Config(config, **fields))
        self.sim = Sim(self.model)
        self.render_mode = render_mode
        self._seeds = np.random.default_rng()
        self._trail: deque[npt.NDArray[np.uint32]] = deque(maxlen=TRAIL_STEPS)
        self._viewer: Viewer | None = None

    def reset(self, seed: int | None) -> None:
        """Begin an episode; without a seed, the next one of the stream that the last seed began."""
        if seed is not None:
            self._seeds = np.random.default_rng(seed)
            self.sim.reset(seed)
        else:
            self.sim.reset(int(self._seeds.integers(0, 2**64, dtype=np.uint64)))
        self._trail.clear()
        self._show()

    def step(self, actions: npt.NDArray[np.float32]) -> StepOutcome:
        """Step the fleet and show it where a window was asked for."""
        if self.render_mode is not None:
            self._trail.append(self.sim.cells())
        outcome = self.sim.step(actions)
        self._show()
        return outcome

    def step_info(self, outcome: StepOutcome) -> dict[str, Any]:
        """Reward components of the step, and the episode's metrics at its end."""
        info: dict[str, Any] = {"reward_components": self.sim.reward_components()}
        if outcome.terminated or outcome.truncated:
            info["metrics"] = self.sim.metrics()
        return info

    def load(self, snapshot: bytes) -> None:
        """Take up a snapshot; the trail of the picture begins anew."""
        self.sim.load(snapshot)
        self._trail.clear()

    def scene(self) -> Scene:
        """What a picture of this moment shows."""
        return self.sim.scene(tuple(self._trail))

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Give the picture (`rgb_array`), or show it (`human`)."""
        if self.render_mode == "rgb_array":
            return draw(self.scene())
        self._show()
        return None

    def close(self) -> None:
        """Close the window, if there is one."""
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def _show(self) -> None:
        if self.render_mode != "human":
            return
        if self._viewer is None:
            self._viewer = Viewer("jcas", RENDER_FPS)
        self._viewer.show(draw(self.scene()))
