"""The study of agents continues where it was stopped, compares like with like, and hides no run."""

import json
import os
import re
import runpy
from dataclasses import asdict, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tyro

from benchmarks.agents.entries import ENTRIES, EXTERNALS
from benchmarks.agents.page import agents_page
from benchmarks.agents.pictures import pictures
from benchmarks.agents.records import External, Outcome, Study, TrainingEntry, by_seed, difference
from benchmarks.agents.run import Agents, measured
from benchmarks.agents.runs import EntryRun, ExternalRun, with_run
from benchmarks.common.processes import StudyFailed
from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.banks import BANKS, NAME
from vitruvius.agent.evaluation import scores
from vitruvius.agent.evaluation.episodes import EpisodeScores
from vitruvius.agent.evaluation.result import Result
from vitruvius.agent.learning.config import TARGET_MODES, differences
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.cli import parse
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("each study is run in small")

ROOT = Path(__file__).parents[3]

HOUSES = 60


def score(level: float, seed: int = 0) -> EpisodeScores:
    """Return the scores of a policy that picks up about ``level`` of the oracle's 50 targets."""
    rng = np.random.default_rng(seed)
    targets = np.clip(np.round(50 * level + rng.normal(0, 3, HOUSES)), 0, 50)
    first = np.where(targets > 0, 40.0, np.inf)
    return EpisodeScores(targets, 1500 * HOUSES, 90, 30, first, np.full((2, HOUSES), 0.5), np.ones(HOUSES))


def result(targets: str = "main", **levels: tuple[float, ...]) -> Result:
    """Return a result of policies with these levels, one for each run."""
    policies = {name: tuple(score(level, k) for k, level in enumerate(runs)) for name, runs in levels.items()}
    oracle = replace(score(1), targets=np.full(HOUSES, 50.0))
    rooms = np.arange(HOUSES) % 5 + 2
    return Result(targets, rooms, np.full(HOUSES, 30.0), policies | {"oracle": (oracle,)})


def written(one: Result) -> bytes:
    """Return the result as the content of a file of scores."""
    return scores.ScoreFile(scores.ScoredBank(""), 0, scores.modes_of([one])).json()


def entry(name: str, beside: str = "", **changes: Any) -> TrainingEntry:
    return TrainingEntry(name, "pqn", 1_000_000, f"what {name} is", beside, changes)


def run(name: str, seed: int, finished: bool = True, failed: str = "") -> Outcome:
    last = {"steps": 10**6, "seconds": 20.0, "simulator": 2e5, "learner": 7e4, "map": None}
    return Outcome(name, seed, finished, failed, ((1000, 1.0), (500_000, 20.0), (10**6, 40.0)), last)


@pytest.fixture
def study() -> Study:
    """Return a study with two agents, a change of one, and a failed run."""
    players = {"plain": (0.8, 0.82), "without": (0.5,), "other": (0.3, 0.3), "script": (0.6,)}
    return Study(
        share=0.2,
        command="./run bench agents --share 0.2",
        days="2026-01-01",
        machine="a machine",
        versions="Python 3.11",
        learnt_in="some houses",
        measured_in="other houses",
        entries=(entry("plain"), entry("other"), entry("without", "plain", avoidance="none")),
        runs=(
            run("plain", 0),
            run("other", 0),
            run("without", 0, finished=False, failed="failed, exit code 1: error: the loss is nan"),
            run("plain", 1),
            run("other", 1),
            run("without", 1),
        ),
        results={mode: result(mode, **players) for mode in ("main", "secondary")},
    )


# Entries.


@pytest.mark.parametrize("one", ENTRIES, ids=lambda one: one.name)
def test_every_entry_is_a_training_that_can_be_asked_for(one: TrainingEntry) -> None:
    job = EntryRun(one, 3, Path("somewhere")).training(Path("houses.jsonl"))
    asked = parse(list(job.command[job.command.index("train") :]))
    assert asked.learning == one.config(3)
    assert asked.name == one.name
    assert asked.resume


@pytest.mark.parametrize(
    "one",
    [e for e in ENTRIES if e.beside and e.preset == e.beside],
    ids=lambda one: one.name,
)
def test_a_change_of_an_agent_changes_one_thing(one: TrainingEntry) -> None:
    [base] = [each for each in ENTRIES if each.name == one.beside]
    assert len(list(differences(one.config(0), base.config(0)))) == 1


def test_entries_have_names_of_their_own_and_known_companions() -> None:
    names = [one.name for one in ENTRIES]
    assert len(set(names)) == len(names)
    assert {one.beside for one in ENTRIES} <= {"", *names}


def test_agents_play_for_all_targets_and_changes_of_them_for_their_own(study: Study, tmp_path: Path) -> None:
    plain, _, without = study.entries
    for one, modes in ((plain, list(TARGET_MODES)), (without, [without.targets])):
        assert [mode for mode in TARGET_MODES if EntryRun(one, 0, tmp_path).plays(mode)] == modes


@pytest.mark.parametrize("name", EXTERNALS)
def test_every_external_agent_is_an_example_that_can_be_asked_for(
    name: str, tmp_path: Path, monkeypatch
) -> None:
    command = ExternalRun(name, 3, tmp_path).training(tmp_path / "houses.jsonl").command
    file = ROOT / command[1]
    monkeypatch.syspath_prepend(file.parent)
    pytest.importorskip(
        {"torchrl_ppo": "torchrl", "stable_baselines": "stable_baselines3"}.get(file.stem, "torch")
    )
    asked = tyro.cli(runpy.run_path(str(file))["Example"], args=list(command[2:]))
    assert (asked.avoid, asked.targets, asked.seed) == (True, EXTERNALS[name].targets, 3)
    assert (asked.steps, asked.out) == (EXTERNALS[name].steps, ExternalRun(name, 3, tmp_path).scores)


# Runs.


def kept(training: EntryRun, steps: int) -> None:
    """Write a run that has seen ``steps`` steps."""
    config = training.entry.config(training.seed)
    checkpoint.save(Checkpoint(network_of(config), config, steps, training.entry.name), training.folder.agent)
    training.folder.config.write_text(json.dumps({"algorithm": config.algorithm, "config": asdict(config)}))


def test_a_run_is_finished_when_its_agent_has_seen_its_steps(tmp_path: Path) -> None:
    training = EntryRun(entry("plain"), 0, tmp_path)
    assert not training.begun
    assert not training.finished
    kept(training, training.entry.steps - 1)
    assert training.begun
    assert not training.finished
    kept(training, training.entry.steps)
    assert training.finished


def test_a_run_of_another_budget_or_with_other_options_is_refused(tmp_path: Path) -> None:
    training = EntryRun(entry("plain"), 0, tmp_path)
    kept(training, 10)
    training.require_same()
    other = replace(training.entry, steps=5, changes={"avoidance": "none"})
    with pytest.raises(RequestError, match=r"a run with other avoidance, steps: choose"):
        EntryRun(other, 0, tmp_path).require_same()
    training.folder.config.write_text(json.dumps({"algorithm": "pqn", "config": {"colour": 3}}))
    with pytest.raises(RequestError, match="unknown field 'colour'"):
        training.require_same()


def test_an_unknown_entry_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="--only: there is no entry nothing"):
        Agents(only=("nothing",), out=tmp_path).run()


def test_a_measurement_is_kept_until_an_agent_is_newer_or_another(tmp_path: Path) -> None:
    runs = [EntryRun(entry("plain"), seed, tmp_path) for seed in (0, 1)]
    for training in runs:
        kept(training, training.entry.steps)
    folder = tmp_path / "evaluation-main"
    assert not measured(folder, runs)
    folder.mkdir()
    agents = [str(training.folder.agent) for training in runs]
    for bank, found in (("0" * 64, False), (BANKS[NAME].hash, True)):
        (folder / "evaluation.json").write_text(json.dumps({"agents": agents, "bank": {"hash": bank}}))
        assert measured(folder, runs) == found
    assert not measured(folder, runs[:1])
    late = (folder / "evaluation.json").stat().st_mtime + 1
    os.utime(runs[1].folder.agent, (late, late))
    assert not measured(folder, runs)


def test_an_external_agent_is_finished_when_it_has_learnt_from_its_steps_and_played(tmp_path: Path) -> None:
    training = ExternalRun("one-file", 0, tmp_path)
    assert not training.begun
    training.scores.parent.mkdir()
    for steps, finished in ((100, False), (EXTERNALS["one-file"].steps, True)):
        training.scores.write_text(json.dumps({"training_steps": steps}))
        assert (training.begun, training.finished) == (True, finished)


def test_an_external_agents_scores_join_what_was_measured_with_the_same_targets_alone(tmp_path: Path) -> None:
    training, one = ExternalRun("one-file", 0, tmp_path), result(plain=(0.8,))
    name = training.agent.name
    theirs = with_run(result(), name, score(0.4))
    less = replace(theirs, policies=theirs.policies | {"oracle": (score(0.9),)})
    training.scores.parent.mkdir()
    training.scores.write_bytes(written(theirs))
    assert training.joined(one).ratio(name) == theirs.ratio(name)
    other = replace(theirs, mode="secondary")
    for wrong in (less, other, result(someone=(0.4,))):
        training.scores.write_bytes(written(wrong))
        with pytest.raises(StudyFailed, match=f"not of {re.escape(name)}, or not of these houses"):
            training.joined(one)


# Figures.


def test_differences_are_of_seeds_that_both_have(study: Study) -> None:
    found, main = difference(study, study.entry("without")), study.results["main"]
    [alone] = found.each
    assert alone == pytest.approx(by_seed(main, "without")[0] - by_seed(main, "plain")[1])
    assert found.all.value == pytest.approx(alone)
    assert found.all.low <= found.all.value <= found.all.high < 0


def test_the_same_scores_differ_by_nothing_with_certainty(study: Study) -> None:
    policies = study.results["main"].policies
    same = replace(study.results["main"], policies=policies | {"without": policies["plain"][1:]})
    found = difference(replace(study, results={"main": same}), study.entry("without"))
    assert found.all == (0, 0, 0)


def test_an_external_agents_runs_are_one_policy_before_those_that_learn_nothing() -> None:
    one = result(plain=(0.8, 0.7))
    agents = [score(level, seed) for seed, level in enumerate((0.5, 0.6))]
    both = with_run(with_run(one, "theirs", agents[0]), "theirs", agents[1])
    assert list(both.policies) == ["theirs", "plain", "oracle"]
    assert both.policies["theirs"] == tuple(agents)
    assert both.figures("plain") == one.figures("plain")


# The page.


def assert_tables(page: str) -> None:
    """Assert that each row has as many cells as the head of its table."""
    lines = page.splitlines()
    for above, line in pairwise(lines):
        if line.startswith("|") and above.startswith("|"):
            assert line.count("|") == above.count("|")
    assert any(line.startswith("|") for line in lines)


def test_the_page_states_the_share_of_the_budget(study: Study) -> None:
    page = agents_page(study)
    assert "Share of the budget: 0.2." in page
    assert "the work of 3 minutes" in page


def test_the_page_names_failed_runs(study: Study) -> None:
    assert "- without, seed 0: failed, exit code 1: error: the loss is nan" in agents_page(study)


def test_external_agents_stand_apart_and_those_that_failed_are_named(study: Study) -> None:
    """External agents learnt from far fewer steps, so no table has them together with our agents."""
    agent = External("Theirs + avoidance", "examples/theirs.py --avoid", 2_000_000, "main", "what it is")
    main = with_run(study.results["main"], agent.name, score(0.4))
    late = Outcome(agent.name, 1, False, "failed, exit code 1: no such library", (), None)
    both = replace(study, results=study.results | {"main": main}, externals=(agent,), absent=(late,))
    page = agents_page(both)
    ratio, [alone] = main.ratio(agent.name).text(), by_seed(main, agent.name)
    rows = [line for line in page.splitlines() if line.startswith(f"| {agent.name}")]
    assert rows == [f"| {agent.name} | what it is | `{agent.command}` | main | {ratio} | {alone:.2f} |"]
    assert "2 M steps in any share" in page
    assert f"- {agent.name}, seed 1: failed, exit code 1: no such library\n" in page
    assert_tables(page)
    assert agent.name not in both.baselines()
    assert agent.name not in agents_page(study)
    assert pictures(both) == pictures(study)


def test_the_page_is_a_function_of_the_records(study: Study) -> None:
    assert agents_page(study) == agents_page(study)
    assert_tables(agents_page(study))


def test_the_page_shows_every_picture_that_is_drawn(study: Study) -> None:
    page, drawn = agents_page(study), pictures(study)
    assert all(content.startswith(b"\x89PNG") for content in drawn.values())
    assert all(f"({name})" in page for name in drawn)
    assert page.count("](agent-") == len(drawn)


def test_a_study_does_what_is_left_and_writes_its_page(tmp_path: Path, monkeypatch) -> None:
    """Replace training and evaluation; a second call finds everything done."""
    asked: list[str] = []

    def pretend(jobs, workers, cluster) -> None:
        assert cluster is None
        for job in jobs:
            asked.append(job.name)
            if "train" in job.command:
                one = next(e for e in ENTRIES if f"{e.name}-0" == job.folder.name)
                run = EntryRun(replace(one, steps=round(0.001 * one.steps)), 0, tmp_path)
                run.folder.path.mkdir()
                kept(run, run.entry.steps)
            else:
                mode = job.command[job.command.index("--targets") + 1]
                agents = job.command[job.command.index("evaluate") + 1 : job.command.index("--targets")]
                found = scores.modes_of([result(mode, pqn=(0.8,), script=(0.6,))])
                file = scores.ScoreFile(
                    scores.ScoredBank(BANKS[NAME].hash, "bank", HOUSES), 0, found, agents=agents
                )
                job.folder.mkdir()
                (job.folder / "evaluation.json").write_bytes(file.json())

    monkeypatch.setattr("benchmarks.agents.run.run_all", pretend)
    monkeypatch.setattr("benchmarks.agents.run.training_houses", lambda path, workers: path)
    monkeypatch.setattr("benchmarks.agents.run.pictures", lambda study: {"agent-scores.png": b""})
    for _ in range(2):
        Agents(share=0.001, only=("pqn",), seeds=(0,), out=tmp_path).run()
    assert asked == ["pqn, seed 0, 0.04 M steps", *(f"measuring, {mode}" for mode in TARGET_MODES)]
    page = (tmp_path / "agents.md").read_text()
    assert "| **pqn** |" in page
    assert "./run bench agents --share 0.001 --seeds 0" in page
    assert_tables(page)
