"""Evaluation protocol: all policies play in the same houses, with the same starts and targets."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.agent.evaluation.cases import SHORT, short_episodes
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import BANKS, benchmark, house_key
from vitruvius.agent.baselines.table import BASELINES, REFERENCES
from vitruvius.agent.evaluation import protocol
from vitruvius.agent.evaluation.learnt_in import learnt_in as learnt_in_
from vitruvius.agent.evaluation.learnt_in import warnings
from vitruvius.agent.evaluation.protocol import Setting, measure
from vitruvius.agent.evaluation.result import Result, joined
from vitruvius.agent.learning.config import TARGET_MODES
from vitruvius.agent.learning.simulator import sensor
from vitruvius.agent.report.folder import report
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.agent.runs.released import released
from vitruvius.commands.evaluate import Evaluate, by_name
from vitruvius.logic import RequestError, save
from vitruvius.sim.config import DEFAULT, PAPER

HOUSES = [random_house(seed) for seed in range(4)]


@pytest.fixture(scope="module", autouse=True)
def short():
    with short_episodes():
        yield


@pytest.fixture(scope="module")
def measured(short):
    """Return the result of the baselines alone, in four small houses."""
    return next(measure({}, HOUSES, ("secondary",), seed=3))


def test_policies_are_ranked_as_what_they_know(measured):
    counts = {name: runs[0].targets.sum() for name, runs in measured.policies.items()}
    assert list(counts) == list(BASELINES)
    assert counts["random + avoidance"] <= counts["searcher"] <= counts["oracle"]
    assert counts["script"] < counts["searcher"]


def test_the_oracles_first_target_is_as_near_as_the_shortest_way(measured):
    [oracle] = measured.policies["oracle"]
    assert oracle.first.tolist() == measured.shortest.tolist()
    assert measured.ratio("oracle").value == 1


def test_a_short_evaluation_gives_the_figures_of_the_whole_one(measured):
    """Fewer baselines in the same episodes give the same scores."""
    short = next(measure({}, HOUSES, ("secondary",), seed=3, baselines=("script", "oracle")))
    assert list(short.policies) == ["script", "oracle"]
    for name in short.policies:
        assert short.figures(name) == measured.figures(name)


def test_a_large_bank_is_played_part_by_part_with_the_same_starts_and_targets(measured, monkeypatch):
    monkeypatch.setattr(protocol, "PART_HOUSES", 3)
    [parts] = measure({}, HOUSES, ("secondary",), seed=3, baselines=("explorer", "oracle"))
    assert np.array_equal(parts.shortest, measured.shortest)
    for name in parts.policies:
        assert parts.figures(name) == measured.figures(name)


def test_episodes_in_parts_of_a_bank_are_in_its_order():
    rooms = [1, 2, 1, 2], [3, 3]
    one, two = (Result("main", np.array(each), np.array(each), {}, episodes=2) for each in rooms)
    assert joined([one, two]).rooms.tolist() == [1, 2, 3, 1, 2, 3]


def written(folder, config, name="pqn") -> Path:
    """Return a checkpoint of an untrained network."""
    path = folder / f"{config.seed}-{config.steps}" / "agent.safetensors"
    checkpoint.save(Checkpoint(network_of(config), config, 0, name), path)
    return path


def test_evaluate_measures_an_agent_beside_the_references_and_writes_a_page_a_picture_and_json(
    tmp_path, capsys
):
    save(HOUSES[:2], tmp_path / "houses.jsonl")
    agent, out = written(tmp_path, PQNConfig()), tmp_path / "out"
    options = {"targets": ("main",), "episodes": 2, "out": out, "json": True}
    assert Evaluate((agent,), tmp_path / "houses.jsonl", **options).run() == 0
    printed = json.loads(capsys.readouterr().out)["answer"]
    assert (printed["world"], printed["episodes"], printed["bank"]["houses"]) == ("default", 2, 2)
    assert len(printed["targets"]["main"]["policies"]["oracle"]["runs"][0]["targets"]) == 4
    assert printed["agents"] == [str(agent)]
    assert len(printed["bank"]["hash"]) == 64
    assert list(printed["targets"]) == ["main"]
    assert list(printed["targets"]["main"]["policies"]) == ["pqn", *REFERENCES]
    assert json.loads((out / "evaluation.json").read_text()) == printed
    assert "| searcher |" in (out / "evaluation.md").read_text()
    assert (out / "report.html").read_bytes() == report(out)
    with Image.open(out / "evaluation.png") as image:
        image.verify()


def test_another_evaluation_is_not_lost_in_silence(tmp_path, measured, monkeypatch):
    """The command compares before it evaluates; here the evaluation takes no time."""
    monkeypatch.setattr("vitruvius.agent.evaluation.protocol.measure", lambda *_, **__: [measured])
    save(HOUSES[:1], tmp_path / "houses.jsonl")
    agent = written(tmp_path, PQNConfig())
    how: dict[str, Any] = {"targets": ("secondary",), "out": tmp_path / "out"}
    assert Evaluate((agent,), tmp_path / "houses.jsonl", **how).run() == 0
    kept = (tmp_path / "out" / "evaluation.json").read_bytes()
    more: dict[str, Any]
    for more in ({"seed": 5}, {"episodes": 2}, {"targets": ("main",)}):
        with pytest.raises(
            RequestError, match="holds another evaluation: choose another folder, or add --rep"
        ):
            Evaluate((agent,), tmp_path / "houses.jsonl", **(how | more)).run()
    assert (tmp_path / "out" / "evaluation.json").read_bytes() == kept
    assert Evaluate((agent,), tmp_path / "houses.jsonl", **how, seed=5, replace=True).run() == 0
    assert Evaluate((agent,), tmp_path / "houses.jsonl", **how, seed=5).run() == 0  # no loss


@pytest.mark.second_part("whole evaluations")
def test_of_houses_that_an_agent_learnt_in_it_is_warned_with_their_number(tmp_path, capsys):
    """The warning is on the terminal, in the file and in its pages; a bank without such houses has none."""
    save(HOUSES[:3], tmp_path / "houses.jsonl")
    path = tmp_path / "agent.safetensors"
    learnt_in = frozenset(map(house_key, HOUSES[1:]))
    network = network_of(PQNConfig())
    checkpoint.save(Checkpoint(network, PQNConfig(), 0, "mine", "none", learnt_in=learnt_in), path)
    out, said = tmp_path / "out", "mine: 2 of the 3 houses here are houses that it was trained on"
    Evaluate((path,), tmp_path / "houses.jsonl", targets=("main",), out=out).run()
    assert f"warning: {said}: its score is not for unseen houses\n" in capsys.readouterr().err
    assert json.loads((out / "evaluation.json").read_text())["learnt_in"] == {"mine": 2}
    assert all(said in (out / page).read_text() for page in ("evaluation.md", "report.html"))
    assert warnings(learnt_in_({"mine": [checkpoint.load(path)]}, HOUSES[:1]), 1) == []
    assert learnt_in_({"mine": [checkpoint.load(written(tmp_path, PQNConfig()))]}, HOUSES[:1]) == {
        "mine": None
    }


@pytest.mark.parametrize("name", released())
def test_what_comes_with_the_project_says_where_it_learnt(name):
    """None of these houses is reserved for evaluation."""
    made = checkpoint.load(name)
    assert made.learnt_in
    assert not made.learnt_in & {house_key(house) for bank in BANKS for house in benchmark(bank)}


def test_in_the_papers_world_all_have_its_body_and_each_its_own_rays():
    paper, ours = (sensor(PRESETS[name], "paper") for name in ("paper", "pqn"))
    assert paper == PAPER
    assert (ours.body, ours.ends_on_collision, ours.first_ray) == (PAPER.body, True, DEFAULT.first_ray)


def test_the_papers_tasks_are_refused_in_another_house(tmp_path):
    save(HOUSES[:1], tmp_path / "houses.jsonl")
    with pytest.raises(RequestError, match="paper-main: its targets are points of the house"):
        Evaluate(houses=tmp_path / "houses.jsonl", targets=("paper-main",)).run()


def test_checkpoints_that_differ_in_the_training_seed_alone_are_runs_of_one_agent(tmp_path):
    same = [written(tmp_path, PQNConfig(seed=seed)) for seed in (0, 1)]
    other = written(tmp_path, PQNConfig(steps=7))
    agents = by_name((*same, other))
    assert {name: len(runs) for name, runs in agents.items()} == {"pqn": 2, "pqn (0-7)": 1}


def test_a_third_config_of_the_same_name_and_folder_is_refused(tmp_path):
    paths = [written(tmp_path / str(k), PQNConfig(steps=7, num_envs=8 + k)) for k in range(3)]
    with pytest.raises(RequestError, match=r"of the same agent: give runs of one config"):
        by_name(paths)


def test_agents_of_all_presets_are_measured_in_the_same_houses(tmp_path):
    """These agents move on a lattice; agents that drive have their own tests."""
    all_ = PRESETS.items()
    presets = {name: config for name, config in all_ if not config.reads_maps and config.backend != "free"}
    agents = {name: [checkpoint.load(written(tmp_path, config, name))] for name, config in presets.items()}
    result = next(measure(agents, HOUSES[:2], ("main",), seed=1, baselines=("oracle",)))
    assert list(result.policies) == [*presets, "oracle"]
    for name in presets:
        [each] = result.policies[name]
        assert (each.targets <= result.oracle).all()
        assert each.steps == 2 * SHORT.steps


def test_an_agent_of_the_papers_simulator_sees_by_the_papers_rays_and_meets_the_same_targets():
    default, paper = (
        Setting(HOUSES[:1], "main", sensor(PRESETS[name]), "continuous").envs for name in ("pqn", "paper")
    )
    for envs in (default, paper):
        envs.reset(seed=5)
    assert paper.single_observation_space.shape == (40, 3)
    assert np.array_equal(default.targets(9), paper.targets(9))
    assert np.array_equal(default.state["wholes"], paper.state["wholes"])


def test_targets_lie_in_the_main_room_in_secondary_rooms_or_in_both():
    assert TARGET_MODES == ("main", "secondary", "mixed")
