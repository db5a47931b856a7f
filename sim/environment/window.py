"""Window for ``render_mode="human"`` that shows the environments side by side, drawn by pygame."""

from collections.abc import Sequence
from importlib.util import find_spec

import numpy as np
from gymnasium.error import DependencyNotInstalled

from vitruvius.logic.installation import install_command
from vitruvius.sim.film import mosaic


class ScreenWindow:
    """Window that opens with the first picture and closes with ``close``.

    If the user closes it, it stays closed.
    """

    def __init__(self, fps: float) -> None:
        """Show at most ``fps`` pictures per second. Raises ``DependencyNotInstalled`` without pygame."""
        if find_spec("pygame") is None:
            raise DependencyNotInstalled(f"render_mode='human' needs pygame: {install_command('play')}")
        self._fps, self._shown, self._ended = fps, False, False

    def show(self, frames: Sequence[np.ndarray]) -> None:
        """Show pictures (height, width, 3) uint8 of one size, reduced if the display is smaller."""
        import pygame

        if self._ended:
            return
        picture = mosaic(frames).swapaxes(0, 1)
        if not self._shown:
            pygame.display.init()
            room = pygame.display.get_desktop_sizes()[0]
            share = min(1.0, *(0.9 * most / side for most, side in zip(room, picture.shape, strict=False)))
            self._surface = pygame.display.set_mode([max(1, int(share * side)) for side in picture.shape[:2]])
            pygame.display.set_caption("Vitruvius")
            self._clock, self._shown = pygame.time.Clock(), True
        size = self._surface.get_size()
        self._surface.blit(pygame.transform.smoothscale(pygame.surfarray.make_surface(picture), size), (0, 0))
        pygame.display.flip()
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
        self._clock.tick(self._fps)

    def close(self) -> None:
        """Close the window."""
        import pygame

        self._ended = True
        if self._shown:
            pygame.display.quit()
            self._shown = False
