"""Play by people: key events in a window without a screen, files of games, and comparison with agents."""

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pygame
import pytest

from vitruvius.agent.banks import benchmark, geometry_hash, named
from vitruvius.agent.play.beside import people_tables, replayable
from vitruvius.agent.play.game import Game, agents_scenes, replayed
from vitruvius.agent.play.results import PlayedGame, ResultsError, append, load
from vitruvius.agent.play.window import (
    EDGE,
    LARGE_PX,
    MIN_WIDTH,
    TURN_EVERY,
    WORDS,
    GameWindow,
    Panel,
    fitted,
)
from vitruvius.agent.runs import checkpoint
from vitruvius.cli import main
from vitruvius.logic import MissingProgram, save
from vitruvius.sim import Oracle

HOUSES = benchmark()[:3]
STEP = 0.01
"""Seconds of a step if 1500 steps last 15 s."""


@pytest.fixture
def window(monkeypatch: pytest.MonkeyPatch) -> Iterator[GameWindow]:
    """Yield a window without a screen."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    window = GameWindow()
    yield window
    window.close()


def press(
    window: GameWindow, keys: dict[float, tuple[int, int]], frame: float = STEP, ended: float = 30.0
) -> None:
    """Press keys: at these seconds they go down (``pygame.KEYDOWN``) or up, as in the system's event queue.

    Every frame lasts ``frame`` seconds of the game. After ``ended`` seconds, Esc ends a window that waits.
    """
    time, left = 0.0, dict(sorted(keys.items()))

    def tick() -> float:
        nonlocal time
        time += frame
        for at in [at for at in left if at <= time + 1e-9]:
            kind, key = left.pop(at)
            pygame.event.post(pygame.Event(kind, key=key))
        if time > ended:
            pygame.event.post(pygame.Event(pygame.KEYDOWN, key=pygame.K_ESCAPE))
        return frame

    window.tick = tick


def played(game: Game, index: int, **others: object) -> PlayedGame:
    """Return a game as a file stores it."""
    fields = {
        "player": "Ada",
        "house": geometry_hash(HOUSES[index]),
        "index": index,
        "targets": "main",
        "seed": index,
        "view": "plan",
        "seconds": 15.0,
        "actions": "".join(game.actions),
        "score": game.score,
    }
    return PlayedGame(**(fields | others))  # pyright: ignore[reportArgumentType]


def drive(index: int, actions: str) -> Game:
    """Return a game of these actions in a house."""
    game = Game(HOUSES[index], "main", index)
    for letter in actions:
        game.act("LRF".index(letter))
    return game


def test_keys_drive_the_body_one_step_for_each_hundredth_of_a_second(window: GameWindow) -> None:
    game = Game(HOUSES[0], "main", 0)
    down, up = pygame.KEYDOWN, pygame.KEYUP
    keys = {
        0.1: (down, pygame.K_LEFT),
        0.15: (up, pygame.K_LEFT),
        0.5: (down, pygame.K_UP),
        0.6: (up, pygame.K_UP),
    }
    press(window, keys, ended=1.0)
    assert not window.play(game, 15.0, "plan")
    assert game.actions[0] == "L"
    assert game.actions.count("L") == 1
    assert 10 <= game.actions.count("F") <= 12
    assert set(game.actions) == {"L", "F"}


def test_a_key_of_turning_that_is_held_turns_again(window: GameWindow) -> None:
    game = Game(HOUSES[0], "main", 0)
    keys = {0.1: (pygame.KEYDOWN, pygame.K_d), 0.1 + 3.5 * TURN_EVERY: (pygame.KEYUP, pygame.K_d)}
    press(window, keys, ended=1.5)
    assert not window.play(game, 15.0, "seen")
    assert game.actions == ["R"] * 4


def test_the_clock_starts_at_the_first_key_and_an_escape_ends_the_game(window: GameWindow) -> None:
    game = Game(HOUSES[0], "main", 0)
    press(window, {20.0: (pygame.KEYDOWN, pygame.K_UP)}, frame=0.2, ended=21.0)
    assert not window.play(game, 15.0, "plan")
    assert 80 <= len(game.actions) <= 120


def test_steps_are_as_fast_whatever_the_frames_are(window: GameWindow) -> None:
    lengths = []
    for frame in (0.1, 0.5):
        game = Game(HOUSES[0], "main", 0)
        press(window, {0.1: (pygame.KEYDOWN, pygame.K_UP)}, frame=frame)
        assert window.play(game, 15.0, "plan")
        lengths.append(len(game.actions))
    assert lengths == [1500, 1500]


def test_fog_lies_where_no_ray_has_been_and_is_lifted_where_one_goes(window: GameWindow) -> None:
    game = Game(HOUSES[1], "main", 1)
    panel = Panel(HOUSES[1], "seen")
    assert panel.fog
    before = pygame.mask.from_surface(panel.fog).count()
    panel.see(game.scene)
    after = pygame.mask.from_surface(panel.fog).count()
    assert before == panel.size[0] * panel.size[1] > after
    x, y, heading = game.scene.pose
    way = float(game.scene.distance[20]) / 2
    ahead = panel.at(x + math.cos(heading) * way, y - math.sin(heading) * way)
    assert panel.fog.get_at((round(ahead[0]), round(ahead[1])))[3] == 0
    behind = panel.at(x - math.cos(heading) * 0.6, y + math.sin(heading) * 0.6)
    assert panel.fog.get_at((round(behind[0]), round(behind[1])))[3] == 255


@pytest.mark.parametrize("display", [(1280, 720), (1280, 800), (1366, 768), (1920, 1080), (1024, 600)])
@pytest.mark.parametrize("racing", [False, True])
def test_a_window_fits_its_display_alone_and_in_a_race(
    window: GameWindow, display: tuple[int, int], racing: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pygame.display, "get_desktop_sizes", lambda: [display])
    pygame.event.post(pygame.event.Event(pygame.QUIT))
    game = Game(HOUSES[0], "main", 0)
    assert not window.play(game, 15.0, "plan", ("agent", [game.scene]) if racing else None)
    width, height = window.surface.get_size()
    assert width <= display[0]
    assert height <= display[1] - 60
    assert width * height > 0.2 * display[0] * display[1]


def test_a_game_is_the_episode_that_an_evaluation_plays_and_comes_out_again() -> None:
    game = drive(2, "FFFFLFFFRRFFF" * 20)
    again, scenes = replayed(played(game, 2), HOUSES[2], "games.jsonl:1")
    assert again.score == game.score
    assert len(scenes) == len(game.actions) + 1
    assert (scenes[-1].pose == game.scene.pose).all()
    with pytest.raises(
        ResultsError, match=r"games.jsonl:1: records 99 targets in 260 steps, but its actions give"
    ):
        replayed(played(game, 2, score=99), HOUSES[2], "games.jsonl:1")
    with pytest.raises(ResultsError, match=": the game was played in the house"):
        replayed(played(game, 2), HOUSES[1], "games.jsonl:1")


def test_an_agent_races_in_the_same_episode() -> None:
    agent = checkpoint.load("pqn")
    scenes = agents_scenes(agent, HOUSES[0], "main", 0)
    game = Game(HOUSES[0], "main", 0)
    assert (scenes[0].pose == game.scene.pose).all()
    assert (scenes[0].target == game.scene.target).all()
    assert scenes[-1].step == 1500
    assert scenes[-1].found > 5


def test_games_are_added_to_a_file_and_read_again(tmp_path: Path) -> None:
    game = played(drive(0, "F"), 0)
    append(tmp_path / "games.jsonl", [game])
    append(tmp_path / "games.jsonl", [game, game])
    assert load(tmp_path / "games.jsonl") == [game] * 3
    (tmp_path / "broken.jsonl").write_bytes(msgspec.json.encode(game) + b'\n{"format": "vitruvius-game-2"}\n')
    with pytest.raises(ResultsError, match=r"broken.jsonl:2: no game"):
        load(tmp_path / "broken.jsonl")
    with pytest.raises(ResultsError, match=r"there.jsonl: cannot be read: No such file"):
        load(tmp_path / "there.jsonl")


def test_people_stand_beside_agents_in_the_same_episodes(tmp_path: Path) -> None:
    games = [played(drive(index, "FFFFFFFLFFFFFF" * 30), index) for index in range(3)]
    append(tmp_path / "games.jsonl", games)
    (table,) = people_tables(tmp_path / "games.jsonl", HOUSES, {"pqn": [checkpoint.load("pqn")]})
    assert table.title.startswith(
        "People, who saw the whole plan and the target: 3 games of 1 player in 3 houses"
    )
    rows = {row[0]: row[1:] for row in table.rows}
    assert list(rows) == ["people", "pqn", "explorer", "searcher", "oracle"]
    assert rows["oracle"][1].startswith("1.00")
    assert rows["people"][2] == ""
    mean = sum(sorted(game.score for game in games)[1:2])
    assert float(rows["people"][0].split()[0]) == pytest.approx(mean, abs=0.05)
    with pytest.raises(ResultsError, match="played in house 1, and there are 1"):
        list(people_tables(tmp_path / "games.jsonl", HOUSES[:1], {}))


LONG = '{"task": "all", "terms": {"steps": 2000000000}}'
TOO_MANY = {
    "1,025 games": [{}] * 1025,
    "17 kinds of games": [{"seconds": float(seconds)} for seconds in range(1, 18)],
    "2,000,000,000 steps of all episodes": [{"targets": LONG}],
    "no:Class": [{"targets": "no:Class"}],
}


@pytest.mark.parametrize("said", TOO_MANY)
def test_games_that_take_too_long_to_play_again_are_refused_before_any_is_played(
    tmp_path: Path, said: str
) -> None:
    nothing = Game(HOUSES[0], "main", 0)
    append(tmp_path / "games.jsonl", [played(nothing, 0, **changed) for changed in TOO_MANY[said]])
    with pytest.raises(ResultsError, match=said):
        replayable(tmp_path / "games.jsonl")


def test_the_command_plays_records_and_shows_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    save(HOUSES, tmp_path / "houses.jsonl")
    made = GameWindow.__init__

    def with_keys(window: GameWindow) -> None:
        made(window)
        press(window, {0.1: (pygame.KEYDOWN, pygame.K_UP)}, frame=0.25, ended=16.0)

    monkeypatch.setattr(GameWindow, "__init__", with_keys)
    out = tmp_path / "games.jsonl"
    play = ["play", str(tmp_path / "houses.jsonl")]
    with pytest.raises(SystemExit) as end:
        main([*play, "--house", "1", "--player", "Ada", "--race", "pqn", "--out", str(out)])
    assert not end.value.code
    (game,) = load(out)
    assert (game.player, game.index, game.seed, game.actions) == ("Ada", 1, 1, "F" * 1500)
    assert game.raced["pqn"] > 0
    assert "house 1: Ada" in capsys.readouterr().err
    with pytest.raises(SystemExit) as end:
        main([*play, "--replay", str(out)])
    assert not end.value.code


@pytest.mark.skipif(sys.platform != "linux", reason="displays of X11 and Wayland")
@pytest.mark.parametrize(
    ("variables", "reason"),
    [
        ({}, "neither DISPLAY nor WAYLAND_DISPLAY is set"),
        ({"DISPLAY": ":9999"}, "x11 not available"),
        ({"SDL_VIDEODRIVER": "nothing"}, "nothing not available"),
    ],
    ids=["none", "shut", "unknown"],
)
def test_without_a_display_one_line_says_so(
    variables: dict[str, str],
    reason: str,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    """By default SDL would draw on an invisible display and wait for keys for ever."""
    for name in ("SDL_VIDEODRIVER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.setenv(name, variables.get(name, ""))
    with pytest.raises(SystemExit) as end:
        main(["play", "test-v1"])
    assert end.value.code == MissingProgram.exit_code
    help = "On a machine without one: xvfb-run, or ssh -X"
    assert capfd.readouterr().err == f"error: play needs a display: {reason}. {help}\n"


def test_a_game_of_the_papers_human_benchmark_stands_beside_agents_that_play_its_episode(tmp_path):
    """The house, start and targets are the same, at their places; the oracle walks in place of a person."""
    houses = named("paper-house")
    game = Game(houses[0], "paper-main", 0)
    oracle = Oracle(game.envs)
    for _ in range(200):
        game.act(int(oracle.act()[0]))
    assert game.score >= 4
    append(tmp_path / "games.jsonl", [played(game, 0, house=geometry_hash(houses[0]), targets="paper-main")])
    [table] = people_tables(tmp_path / "games.jsonl", houses, {})
    assert table.title.endswith("15 s, targets in the main room, paper's")
    assert [row[0] for row in table.rows] == ["people", "explorer", "searcher", "oracle"]


@pytest.mark.parametrize("name", ["pqn", "map-completion-habit, of a long name", "x" * 60])
def test_a_name_and_its_score_are_whole_above_a_plan_and_on_the_card_of_results(
    window: GameWindow, name: str
) -> None:
    said = fitted(f"{name}: 12", LARGE_PX, (MIN_WIDTH - EDGE, 30), WORDS)
    assert said.get_width() <= MIN_WIDTH - EDGE
    assert said.get_height() <= 30
    window.surface = pygame.display.set_mode((MIN_WIDTH, 400))
    window.surface.fill((0, 0, 0))
    press(window, {}, ended=0)
    window.show(["you: 12", f"{name}: 14", "Enter or Esc: quit"])
    black = pygame.mask.from_threshold(window.surface, (0, 0, 0), (1, 1, 1, 255))
    black.invert()
    card = black.get_bounding_rects()[0]
    assert pygame.Rect(0, 0, MIN_WIDTH, 400).contains(card.inflate(2, 2))
    assert black.count() > 0.98 * card.width * card.height  # nothing shines through except at round corners
