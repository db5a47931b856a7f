"""The demo on a small scale: its houses, its files, its report, and its verdict."""

import io
import re
from dataclasses import replace

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from tests.agent.evaluation.cases import SHORT, result, scores, short_episodes
from vitruvius import demo as module
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import geometry_hash
from vitruvius.agent.report.folder import report
from vitruvius.agent.runs.checkpoint import load as load_checkpoint
from vitruvius.commands.record import Record
from vitruvius.demo import FILES, banks, demo, gain, sought
from vitruvius.logic import House, Rect, RequestError, Star, check, generate, load
from vitruvius.sim.film import SHARP, framed, largest, plan
from vitruvius.sim.tasks.furniture import pieces_in

pytestmark = pytest.mark.second_part("the demo is run whole")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a small demo's folder, exit code and terminal output.

    The demo has 8 homes and 8 stars, 2,000 steps, small networks and short episodes.
    """
    out = tmp_path_factory.mktemp("demo") / "runs"
    console = Console(width=80, file=io.StringIO())
    with short_episodes(), pytest.MonkeyPatch.context() as patch:
        sizes = {"home": (4,), "family": (2,)}
        few = {name: dict.fromkeys(sizes, number) for name, number in {"TRAINING": 6, "HELD_OUT": 2}.items()}
        for name, value in {**few, "ROOMS": sizes, "STEPS": 2000, "LINES": 0.0}.items():
            patch.setattr(module, name, value)
        patch.setattr(module, "COMPLETION_SECONDS", 0.1)
        small = replace(PRESETS["map-completion"], num_envs=16, channels=(4, 8))
        patch.setitem(PRESETS, "map-completion", small)
        patch.setattr(module, "Console", lambda: console)
        out.mkdir()
        (out / "report.md").write_text(f"{module.TITLE}\n\nof an older run")
        code = demo(out, seed=3)
    return out, code, console.file.getvalue()  # pyright: ignore[reportAttributeAccessIssue]


def test_the_demo_writes_all_its_files_and_nothing_else(made):
    out, code, _ = made
    assert sorted(path.name for path in out.iterdir()) == sorted([*FILES, *module.RUNS])
    assert code == 1  # 2,000 steps are too few


def test_a_folder_that_holds_something_else_than_a_demo_is_refused_and_left_as_it_is(tmp_path):
    (tmp_path / "training").mkdir()
    (tmp_path / "training/notes.txt").write_text("mine")
    (tmp_path / "houses.jsonl").write_text("mine")
    with pytest.raises(RequestError, match="exists and is not a demo: choose another folder"):
        demo(tmp_path)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["houses.jsonl", "notes.txt", "training"]


@pytest.mark.parametrize(("name", "grammar"), [("homes", "home"), ("stars", "family")])
def test_the_demos_houses_are_sound_and_the_two_banks_share_none(made, name, grammar):
    houses, held_out = load(made[0] / f"{name}.jsonl"), load(made[0] / f"{name}-held-out.jsonl")
    assert {house.provenance.grammar for house in [*houses, *held_out] if house.provenance} == {grammar}
    assert (len(houses), len(held_out)) == (6, 2)
    assert not any(check(house) for house in [*houses, *held_out])
    assert {geometry_hash(house) for house in houses}.isdisjoint(map(geometry_hash, held_out))


def test_the_report_shows_both_agents_their_baselines_and_every_picture(made):
    page = (made[0] / "report.md").read_text()
    found, main = page.split("**Main room: learning.**")
    for agent, part in (("pqn", main), ("foresight", found)):
        for name in (agent, "random + avoidance", "script", "explorer", "oracle"):
            assert f"| {name} |" in part
    assert "| human, another house |" in main
    assert page.index("homes.png") < page.index("**Find a")
    for picture in ("homes.png", "learning-curve.png", "episode.gif", "episode-object.gif"):
        assert f"]({picture})" in page
        with Image.open(made[0] / picture) as image:
            image.verify()


def test_the_page_of_the_demo_is_that_of_its_folder_and_plays_both_episodes(made):
    page = (made[0] / "report.html").read_bytes()
    assert page == report(made[0])
    assert len(page) < 5e6
    assert page.count(b'class="episode"') == 2


def test_an_agent_has_one_name_in_its_folder_its_episode_its_figures_and_its_curves(made):
    assert module.RUNS == (module.AGENT, module.FORESIGHT)
    page = (made[0] / "report.html").read_text()
    for name in module.RUNS:
        assert page.count(f'<th scope="row">{name}</th>') >= 2  # evaluation and training
        assert f"<h3>{name}, " in page
    rows = {*re.findall(r'<th scope="row">([a-z]+)</th>', page)}
    assert not rows & {"agent", "training"}


def test_report_and_terminal_say_what_the_network_adds_to_the_planner_behind_doors(made):
    for shown in ((made[0] / "report.md").read_text(), made[2]):
        words = " ".join(shown.split())
        assert "the same planner with a map completion network that began this run with random" in words
        assert "SPL gain of foresight over explorer, paired by house, 4 episodes in each: " in words
        assert "of the paper's own house; the human's row states if that is another house" in words


def test_the_terminal_shows_whole_tables_in_80_columns(made):
    assert "…" not in made[2]
    assert max(map(len, made[2].splitlines())) <= 80


def test_the_film_shows_the_whole_episode(made):
    with Image.open(made[0] / "episode.gif") as image:
        assert image.n_frames == SHORT.steps / 4 + 1  # pyright: ignore[reportAttributeAccessIssue]


def test_a_checkpoint_of_the_demo_can_be_filmed_again(made, tmp_path):
    agent, houses = made[0] / "pqn/agent.safetensors", made[0] / "stars-held-out.jsonl"
    assert load_checkpoint(agent).steps >= 2000
    Record(agent, houses, house=1, out=tmp_path / "film.gif", steps=8).run()
    with Image.open(tmp_path / "film.gif") as image:
        assert image.n_frames == 3  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(RequestError, match="houses 0 to 1"):
        Record(agent, houses, house=2).run()
    with pytest.raises(RequestError, match=r"--out .*film.avi: a film must be .gif or .mp4: use .*film.gif"):
        Record(agent, houses, out=tmp_path / "film.avi").run()


def test_a_mosaic_films_many_environments_side_by_side_each_in_its_house(made, tmp_path):
    agent, houses = made[0] / "pqn/agent.safetensors", made[0] / "stars-held-out.jsonl"
    Record(agent, houses, house=1, mosaic="3x1", out=tmp_path / "film.mp4", steps=8, width=120).run()
    frames, _ = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "film.mp4"))
    assert frames == 3 + 24  # steps 0, 4 and 8; the last one stays for a second
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "film.mp4"))
    across, along = next(reader)["size"]
    first = np.frombuffer(next(reader), np.uint8).reshape(along, across, 3).astype(int)
    two = load(houses)
    width, height = largest([two[1], two[0], two[1]], 120)
    assert (across, along) == (3 * width + 3 * width % 2, height + height % 2)
    for cell, house in enumerate([two[1], two[0], two[1]]):  # the file's first again where there are fewer
        shown = first[:height, cell * width : (cell + 1) * width]
        alone = np.asarray(framed(plan(house, 120).reduce(SHARP), (width, height)), int)
        others = np.asarray(framed(plan(two[cell % 2], 120).reduce(SHARP), (width, height)), int)
        assert np.abs(shown - alone).mean() < np.abs(shown - others).mean()
    for wrong in ("9x9", "4", "0x3"):
        with pytest.raises(RequestError, match=f"--mosaic {wrong}: give columns and rows, as in 4x3"):
            Record(agent, houses, mosaic=wrong).run()


def test_two_equal_houses_are_refused(monkeypatch):
    house = House.of_star(Star(Rect(0, 0, 5, 5)))
    monkeypatch.setattr(module, "generate", lambda *args, **options: [house])
    monkeypatch.setattr(module, "check", lambda house: [])
    with pytest.raises(Exception, match="same house twice"):
        banks(0, lambda done, words: None)


def test_the_hash_is_of_the_shape_alone():
    house = House.of_star(Star(Rect(0, 0, 5, 5)))
    assert geometry_hash(house) == geometry_hash(House.of_star(Star(Rect(0, 0, 5, 5)), "original"))
    assert geometry_hash(house) != geometry_hash(House.of_star(Star(Rect(0, 0, 5, 5.001))))


def test_the_networks_gain_is_the_paired_difference_to_the_planner():
    both = result(
        shortest=[10, 20],
        others={"foresight": scores([1, 1], first=[40, 40]), "explorer": scores([1, 1], first=[20, 25])},
    )
    words = "SPL gain of foresight over explorer, paired by house, 1 episodes in each"
    assert gain(both).startswith(f"{words}: -0.275 [")


def test_the_piece_that_most_houses_have_is_sought():
    houses = list(generate(3, seed=5, count=6))
    piece, kinds = sought(houses)
    having = {kind: sum(kind in pieces_in(house) for house in houses) for kind in kinds}
    assert having[piece] == max(having.values())
    assert set(kinds) == {p.type for house in houses for room in house.rooms for p in room.pieces}


@pytest.mark.parametrize(("targets", "code"), [(9.0, 0), (4.8, 1), (1.0, 1)])
def test_the_verdict_asks_for_more_than_the_human_and_the_walk(targets, code):
    both = {module.AGENT: scores(np.full(8, targets)), "random + avoidance": scores(np.full(8, 1.0))}
    one = result(oracle=[10] * 8, rooms=[2] * 8, shortest=[9] * 8, others=both)
    assert module._verdict(one) == code
