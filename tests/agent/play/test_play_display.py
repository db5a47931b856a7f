"""``vitruvius play`` as a process on a virtual display, driven by real key events."""

import re
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import ImageGrab

from tests.programs import PATIENCE, finished
from vitruvius.agent.banks import benchmark, geometry_hash
from vitruvius.agent.play.game import replayed
from vitruvius.agent.play.results import load
from vitruvius.logic import save
from vitruvius.sim.film import SHARP, plan

pytestmark = pytest.mark.second_part("windows on a virtual display")

HEAD, SIZE = 64, 656
"""Pixels above a plan, and of its longer side on a display 800 pixels high: ``agent.play.window``."""

HOUSES = benchmark()[:2]
Display = dict[str, str]


def keys(display: Display, *words: str) -> None:
    """Press keys on a display by the X server's XTEST: ``keydown Up``."""
    subprocess.run(["xdotool", *words], env=display, check=True, timeout=PATIENCE)


def comes(condition: Callable[[], bool], seconds: float = 60) -> bool:
    """Return True if a condition becomes true within some seconds."""
    end = time.monotonic() + seconds
    while not (holds := condition()) and time.monotonic() < end:
        time.sleep(0.2)
    return holds


@cache
def drawn(number: int) -> np.ndarray:
    """Return the plan of a house as the window draws it, without the body, its rays and the target."""
    return np.asarray(plan(HOUSES[number], SIZE).reduce(SHARP).convert("RGB"), int)


def shows(display: Display, number: int) -> bool:
    """Return True if the window shows the plan of a house."""
    search = ["xdotool", "search", "--onlyvisible", "--class", ".", "getwindowgeometry", "--shell"]
    said = finished(search, env=display).stdout
    at = {name: int(value) for name, value in (line.split("=") for line in said.split())}
    expected = drawn(number)
    height, width = expected.shape[:2]
    if (at.get("WIDTH"), at.get("HEIGHT")) != (width, height + HEAD):
        return False
    picture = ImageGrab.grab(xdisplay=display["DISPLAY"]).convert("RGB")
    left, top = at["X"], at["Y"] + HEAD
    found = np.asarray(picture.crop((left, top, left + width, top + height)), int)
    return (np.abs(found - expected).max(axis=2) < 8).mean() > 0.8


def test_keys_on_a_display_drive_a_game_that_its_file_repeats(tmp_path: Path, display: Display) -> None:
    """The keys: a turn, a step while a key is held, a turn; then Enter to the next house, and Esc."""
    save(HOUSES, tmp_path / "houses.jsonl")
    out = tmp_path / "games.jsonl"
    play = ["play", str(tmp_path / "houses.jsonl"), "--player", "Ada", "--seconds", "5", "--out", str(out)]
    process = subprocess.Popen([sys.executable, "-m", "vitruvius.cli", *play], env=display)
    try:
        assert comes(lambda: shows(display, 0))
        keys(display, "key", "Right", "keydown", "Up", "sleep", "0.3", "keyup", "Up", "key", "Left")
        assert comes(out.exists)
        keys(display, "key", "Return")
        assert comes(lambda: shows(display, 1))
        keys(display, "key", "Up", "key", "Escape")
        assert process.wait(timeout=PATIENCE) == 0
    finally:
        process.kill()
    [game] = load(out)
    assert (game.player, game.index, game.house) == ("Ada", 0, geometry_hash(HOUSES[0]))
    assert re.fullmatch("R+F+L+", game.actions)  # no step after the key is released
    again, scenes = replayed(game, HOUSES[0], "games.jsonl:1")
    assert again.score == game.score
    assert (scenes[-1].pose != scenes[0].pose).any()
