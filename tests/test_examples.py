"""Other people's learners in our houses: each example learns, plays, and writes what ``evaluate`` would."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode

from agent import beside
from agent.banks import benchmark
from agent.baselines import baselines
from agent.beside import ScoreError
from agent.commands import Evaluate
from agent.world import make_worlds
from logic import HouseFileError, generate, load, save
from sim import check_vector_env

EXAMPLES = Path(__file__).parents[1] / "examples"
LIBRARIES = {"stable_baselines": "stable_baselines3", "torchrl_ppo": "torchrl", "one_file": "torch"}


@pytest.fixture(scope="module", autouse=True)
def path():
    """Scripts import what lies beside them; batches are small, so that one thread is best."""
    torch.set_num_threads(1)
    sys.path.insert(0, str(EXAMPLES))
    yield
    sys.path.remove(str(EXAMPLES))


@pytest.fixture(scope="module")
def houses(tmp_path_factory):
    file = tmp_path_factory.mktemp("banks") / "houses.jsonl"
    save(generate(rooms=2, seed=0, count=2), file)
    return file


def example(name: str) -> ModuleType:
    """The script as a module, which the library that it needs is there for."""
    pytest.importorskip(LIBRARIES.get(name, "torch"))
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("stable_baselines", {"algorithm": "dqn", "avoid": True}),
        ("stable_baselines", {"algorithm": "ppo"}),
        ("torchrl_ppo", {"avoid": True}),
        ("one_file", {"avoid": True}),
    ],
)
def test_an_example_learns_plays_and_writes_its_score(name, options, houses, tmp_path, capsys):
    file = tmp_path / "score.json"
    run = example(name).Example(houses, held_out=houses, steps=256, environments=4, out=file, **options).run
    run()
    line = capsys.readouterr().out.splitlines()[-1]
    record: dict[str, Any] = json.loads(file.read_text())
    (player,) = record["agents"]
    assert line.startswith(f"{player}, 256 steps: ")
    assert player.endswith(" + avoidance") == options.get("avoid", False)
    assert record["bank"]["houses"] == 2
    mode = record["targets"]["main"]
    assert set(mode["players"]) == {player, "oracle"}
    assert mode["players"]["oracle"]["figures"]["ratio"]["value"] == 1
    (run,) = mode["players"][player]["runs"]
    assert run["steps"] == 2 * 1500
    if "avoid" in options:
        assert run["interventions"] > 0
        assert run["blocked"] < 100


@pytest.fixture(scope="module")
def score(houses, tmp_path_factory):
    """What an agent that always turns left did, as an example writes it."""
    file = tmp_path_factory.mktemp("scores") / "dizzy.json"
    task = example("task").Task(houses, held_out=houses, out=file)
    task.score("dizzy", lambda seen: torch.tensor([1.0, 0.0, 0.0]).expand(len(seen), 3))
    return file


def evaluation(houses, *files, out=None):
    return Evaluate(houses=houses, targets=("main",), beside=files, json=True, out=out)


def test_an_examples_score_is_a_row_beside_ours(houses, score, tmp_path, capsys):
    out = tmp_path / "out"
    assert evaluation(houses, score, out=out).run() == 0
    record = json.loads(capsys.readouterr().out)
    theirs, ours = json.loads(score.read_text())["targets"]["main"], record["targets"]["main"]
    assert list(ours["players"]) == ["dizzy", *beside.OURS]
    for player in ("dizzy", "oracle"):
        assert ours["players"][player]["runs"] == theirs["players"][player]["runs"]
        assert ours["players"][player]["figures"]["ratio"] == theirs["players"][player]["figures"]["ratio"]
    assert record["beside"] == [str(score)]
    assert "| dizzy |" in (out / "evaluation.md").read_text()


def test_our_own_evaluation_can_stand_beside_as_well_and_a_second_of_a_name_is_named_for_its_file(
    houses, score, tmp_path, capsys
):
    evaluation(houses, score, out=tmp_path / "first").run()
    path = tmp_path / "first" / "evaluation.json"
    again = tmp_path / "evaluation.json"
    again.write_bytes(path.read_bytes())
    evaluation(houses, score, path, again).run()
    record = json.loads(capsys.readouterr().out.splitlines()[-1])
    players = record["targets"]["main"]["players"]
    assert list(players)[:3] == ["dizzy", "dizzy (evaluation)", f"dizzy ({again})"]
    assert players["dizzy"] == players["dizzy (evaluation)"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda file: file["bank"].update(hash="0" * 64), "houses of hash 000000000000, here it is"),
        (lambda file: file.update(seed=1), "seed 1, here it is 0: not comparable"),
        (lambda file: file.update(backend="grid"), "backend grid, here it is continuous"),
        (lambda file: file["targets"].update(mixed=file["targets"].pop("main")), "in mixed, here in main"),
        (lambda file: file.pop("targets"), "missing required field `targets`"),
        (lambda file: dizzy(file).update(rooms=[1]), "dizzy has not one value for each of 2 houses"),
        (lambda file: dizzy(file).update(first=["soon", 1]), "Expected `int | null`, got `str`"),
    ],
)
def test_scores_that_cannot_be_compared_are_refused_in_one_line_before_anything_is_played(
    change, message, houses, score, tmp_path
):
    file = json.loads(score.read_text())
    change(file)
    path = tmp_path / "other.json"
    path.write_text(json.dumps(file))
    with pytest.raises(ScoreError) as refusal:
        evaluation(houses, path).run()
    assert str(refusal.value).startswith(f"{path}: ")
    assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff", None])
def test_a_file_that_holds_no_scores_is_refused(content, houses, tmp_path):
    path = tmp_path / "other.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ScoreError, match=r"no scores|cannot be read"):
        evaluation(houses, path).run()


def test_the_players_that_are_measured_anew_are_all_the_baselines(houses):
    assert ["paper", *baselines(make_worlds(load(houses), 1), 0)] == list(beside.OURS)


def dizzy(file) -> dict[str, Any]:
    return file["targets"]["main"]["players"]["dizzy"]["runs"][0]


def test_under_avoidance_worlds_keep_gymnasiums_promises_and_turn_before_they_bump(houses):
    task = example("task")
    free, avoiding = (task.Task(houses, environments=4, avoid=avoid).worlds() for avoid in (False, True))
    assert avoiding.autoreset_mode is AutoresetMode.SAME_STEP
    check_vector_env(avoiding, steps=1600, skip=["close"])
    bumps = []
    for envs in (free, avoiding):
        envs.reset(seed=0)
        bumps.append(sum(envs.step(np.full(4, 2))[-1]["blocked"].sum() for _ in range(300)))
    assert bumps[0] > 500
    assert bumps[1] < 10


def test_nobody_learns_in_the_benchmark_bank(tmp_path):
    file = tmp_path / "houses.jsonl"
    save(benchmark()[:1], file)
    with pytest.raises(HouseFileError, match="kept for measuring"):
        example("task").Task(file).worlds()


@pytest.mark.parametrize("name", LIBRARIES)
def test_an_example_is_short(name):
    lines = (EXAMPLES / f"{name}.py").read_text().splitlines()
    assert len(lines) <= 80
