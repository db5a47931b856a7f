"""The window on the screen, on a simulated display of SDL."""

import numpy as np
import pygame
import pytest

from vitruvius.sim.environment.window import ScreenWindow


def surface() -> pygame.Surface:
    shown = pygame.display.get_surface()
    assert shown
    return shown


@pytest.fixture
def window(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame.display.quit()
    yield ScreenWindow(fps=1000)
    pygame.display.quit()


def test_pictures_are_side_by_side_on_a_window_of_their_size(window):
    window.show([np.full((30, 40, 3), shade, np.uint8) for shade in (50, 200)])
    shown = pygame.surfarray.array3d(surface())
    assert shown.shape == (80, 30, 3)
    assert (shown[20, 15, 0], shown[60, 15, 0]) == (50, 200)
    assert pygame.display.get_caption()[0] == "Vitruvius"
    window.close()
    assert not pygame.display.get_init()


def test_pictures_larger_than_the_display_are_made_smaller_with_their_sides_in_proportion(window):
    pygame.display.init()
    width, height = pygame.display.get_desktop_sizes()[0]
    window.show([np.zeros((height, 4 * width, 3), np.uint8)])
    assert surface().get_size() == (int(0.9 * width), int(0.9 * height / 4))


def test_a_window_that_its_user_closes_stays_away(window):
    picture = [np.zeros((30, 40, 3), np.uint8)]
    window.show(picture)
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    window.show(picture)
    assert not pygame.display.get_init()
    window.show(picture)
    assert not pygame.display.get_init()
