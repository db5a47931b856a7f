"""The commands, small: the demo's files and verdict, a run's checkpoint, an evaluation and a film from it."""

import io
import json

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from agent import demo as module
from agent import report
from agent.checkpoint import load as load_checkpoint
from agent.commands import Evaluate, Record
from agent.demo import FILES, banks, demo, geometry_hash
from agent.evaluate import Score, Scores
from logic import House, Rect, RequestError, check, load

SCORES = Scores(
    Score("agent", np.full(8, 9.0), steps=1000, blocked=2, interventions=30),
    Score("random + avoidance", np.full(8, 1.0), steps=1000, blocked=100),
    Score("shortest-path oracle", np.full(8, 10.0)),
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A demo of 8 houses of two rooms and 2,000 steps; it can learn nothing, and says so."""
    out = tmp_path_factory.mktemp("demo") / "runs"
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {"ROOMS": (2,), "TRAINING": 6, "HELD_OUT": 2, "STEPS": 2000, "LINES": 0.0}.items():
            patch.setattr(module, name, value)
        out.mkdir()
        (out / "report.md").write_text("of an older run")
        code = demo(out, seed=3)
    return out, code


def test_the_demo_writes_all_its_files_and_nothing_else(made):
    out, code = made
    assert sorted(path.name for path in out.iterdir()) == sorted([*FILES, "training"])
    assert code == 1  # 2,000 steps teach nothing


def test_the_demos_houses_are_sound_and_the_two_banks_share_none(made):
    out, _ = made
    houses, held_out = load(out / "houses.jsonl"), load(out / "houses-held-out.jsonl")
    assert (len(houses), len(held_out)) == (6, 2)
    assert not any(check(house) for house in houses + held_out)
    assert {geometry_hash(house) for house in houses}.isdisjoint(map(geometry_hash, held_out))


def test_the_report_shows_every_player_and_picture(made):
    page = (made[0] / "report.md").read_text()
    for words in (
        "agent |",
        "random + avoidance |",
        "shortest-path oracle |",
        "human of the paper |",
        "0.48",
    ):
        assert words in page
    for picture in ("plans.png", "learning-curve.png", "episode.gif"):
        assert f"]({picture})" in page
        with Image.open(made[0] / picture) as image:
            image.verify()


def test_the_film_shows_the_whole_episode(made):
    with Image.open(made[0] / "episode.gif") as image:
        assert image.n_frames == 1500 / 4 + 1  # pyright: ignore[reportAttributeAccessIssue]


def test_a_checkpoint_of_the_demo_can_be_measured_and_filmed_again(made, tmp_path, capsys):
    agent, houses = made[0] / "training/agent.safetensors", made[0] / "houses-held-out.jsonl"
    assert load_checkpoint(agent).steps >= 2000
    assert Evaluate((agent,), houses=houses, targets=("main",), json=True).run() == 0
    players = json.loads(capsys.readouterr().out)["targets"]["main"]["players"]
    assert list(players) == [
        "pqn",
        "paper",
        "random + avoidance",
        "script",
        "explorer",
        "searcher",
        "oracle",
    ]
    assert all(len(each["runs"][0]["targets"]) == 2 for each in players.values())
    Record(agent, houses, house=1, out=tmp_path / "film.gif", steps=8).run()
    with Image.open(tmp_path / "film.gif") as image:
        assert image.n_frames == 3  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(RequestError, match="houses 0 to 1"):
        Record(agent, houses, house=2).run()


def test_two_equal_houses_are_refused(monkeypatch):
    house = House(Rect(0, 0, 5, 5), ())
    monkeypatch.setattr(module, "generate", lambda *args, **options: [house])
    monkeypatch.setattr(module, "check", lambda house: [])
    with pytest.raises(Exception, match="same house twice"):
        banks(0, lambda done, words: None)


def test_the_hash_is_of_the_shape_alone():
    house = House(Rect(0, 0, 5, 5), ())
    assert geometry_hash(house) == geometry_hash(House(Rect(0, 0, 5, 5), (), format="original"))
    assert geometry_hash(house) != geometry_hash(House(Rect(0, 0, 5, 5.001), ()))


def test_the_table_gives_ratios_to_the_oracle_in_the_same_house():
    agent, walk, oracle, human = report.rows(SCORES)
    assert agent == ("agent", "9.0 [9.0, 9.0]", "0.90 [0.90, 0.90]", "2.0", "30.0")
    assert walk[2:] == ("0.10 [0.10, 0.10]", "100.0", "0.0")
    assert oracle[:3] == ("shortest-path oracle", "10.0 [10.0, 10.0]", "1")
    assert human[2] == "0.48"


def test_the_table_fits_a_terminal_of_80_columns():
    console = Console(width=80, file=io.StringIO())
    console.print(report.table([("shortest-path oracle", *["98.6 [93.6, 99.8]"] * 2, "100.0", "142.0")], ""))
    shown = console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]
    assert "…" not in shown
    assert "overruled" in shown


@pytest.mark.parametrize(("targets", "code"), [(9.0, 0), (4.8, 1), (1.0, 1)])
def test_the_verdict_asks_for_more_than_the_human_and_the_walk(targets, code):
    agent = Score("agent", np.full(8, targets), steps=1000)
    assert module._verdict(SCORES._replace(agent=agent)) == code
