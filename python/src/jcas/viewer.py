"""A window that shows the frames of a mission, for `render_mode="human"`."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import MissingDependencyError


class Viewer:
    """A pygame window. Without a screen, set `SDL_VIDEODRIVER=dummy`."""

    def __init__(self, title: str, frames_per_second: int) -> None:
        try:
            import pygame
        except ImportError as error:
            raise MissingDependencyError("pygame", 'render_mode="human"', "human") from error
        self._pygame: Any = pygame
        self._title = title
        self._frames_per_second = frames_per_second
        self._window: Any = None
        self._clock: Any = None

    def show(self, frame: npt.NDArray[np.uint8]) -> None:
        """Show one frame, and wait as long as the frame rate requires."""
        pygame = self._pygame
        if self._window is None:
            pygame.display.init()
            pygame.display.set_caption(self._title)
            self._window = pygame.display.set_mode((frame.shape[1], frame.shape[0]))
            self._clock = pygame.time.Clock()
        pygame.event.pump()
        self._window.blit(pygame.surfarray.make_surface(frame.transpose(1, 0, 2)), (0, 0))
        pygame.display.flip()
        self._clock.tick(self._frames_per_second)

    def close(self) -> None:
        """Close the window; closing twice is allowed."""
        if self._window is not None:
            self._pygame.display.quit()
            self._window = None
