"""Agents that drive: their training, and their evaluation with baselines that drive. 28 s."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from tests.agent.algorithms import cases
from tests.agent.evaluation.cases import short_episodes
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import network_of, policy_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS, TABLE
from vitruvius.agent.baselines.driving import roadmap
from vitruvius.agent.baselines.table import DRIVING_BASELINES
from vitruvius.agent.evaluation import protocol
from vitruvius.agent.evaluation.protocol import measure
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.simulator import actions, sensor
from vitruvius.agent.play.game import agents_scenes
from vitruvius.agent.policies.policies import QPolicy
from vitruvius.agent.report.folder import report
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.agent.runs.runs import run
from vitruvius.commands.evaluate import Evaluate
from vitruvius.logic import HouseFileError, RequestError, save
from vitruvius.sim.drive import COMMANDS, Drive

HOUSES = [random_house(seed) for seed in range(4)]
SMALL = replace(PRESETS["pqn-free"], num_envs=16, steps=60_000)


@pytest.fixture(scope="module", autouse=True)
def short():
    with short_episodes():
        yield


@pytest.fixture(scope="module")
def learnt(tmp_path_factory) -> tuple[Checkpoint, list]:
    """Return a small run's history, and its checkpoint as read from the file."""
    folder = tmp_path_factory.mktemp("run")
    _, history = run(HOUSES, SMALL, folder, name="pqn-free")
    return checkpoint.load(folder / "agent.safetensors"), history


@pytest.mark.second_part("it learns")
def test_it_learns_and_is_measured_beside_baselines_that_drive(learnt):
    agent, history = learnt
    assert history[-1].targets > 3 * np.mean([now.targets for now in history[:10]])
    result = next(measure({"mine": [agent]}, HOUSES, ("main",), seed=3, backend="free"))
    assert list(result.policies) == ["mine", *DRIVING_BASELINES]
    counts = {name: runs[0].targets.sum() for name, runs in result.policies.items()}
    assert counts["random drive"] < counts["pursuit"] < counts["true path"]
    assert counts["random drive"] < counts["mine"] < counts["true path"]
    for name, [scores] in result.policies.items():
        assert {"coverage_500", "rooms", "blocked", "interventions"} <= set(result.figures(name))
        assert (scores.coverage[1] > 0.5).all()
    assert result.yardstick == "true path"
    assert (result.ratios("true path") == 1).all()
    assert (result.shortest == result.policies["true path"][0].first).all()
    assert result.human is None


def test_evaluate_writes_its_page_and_says_what_the_ratio_is_to(learnt, tmp_path, capsys):
    save(HOUSES[:2], tmp_path / "houses.jsonl")
    checkpoint.save(learnt[0], tmp_path / "agent.safetensors")
    options = {"targets": ("main",), "backend": "free", "out": tmp_path / "out", "json": True}
    assert Evaluate((tmp_path / "agent.safetensors",), tmp_path / "houses.jsonl", **options).run() == 0
    printed = json.loads(capsys.readouterr().out)["answer"]
    assert printed["backend"] == "free"
    assert list(printed["targets"]["main"]["policies"]) == ["pqn-free", *DRIVING_BASELINES]
    page = (tmp_path / "out" / "evaluation.md").read_text()
    assert "Ratio: to the true path" in page
    assert "oracle" not in page
    assert (tmp_path / "out" / "report.html").read_bytes() == report(tmp_path / "out")
    assert "ratio to the true path" in (tmp_path / "out" / "report.html").read_text()


@pytest.mark.parametrize("name", [name for name, config in cases.SMALL.items() if config.drives])
def test_a_network_has_an_action_for_each_command(name):
    three = ('drive={"commands":[[0,3],[0,-3],[0.7,0]]}',)
    for sim, count in ((), len(COMMANDS)), (three, 3):
        made = replace(cases.SMALL[name], world="drive", avoidance="none", sim=sim)
        assert actions(made) == count
        assert sensor(made).drive == Drive(commands=COMMANDS[:count])
        envs = make_envs(HOUSES[:1], 50, preset=sensor(made), backend=made.backend)
        policy, seen = policy_of(network_of(made), made, envs), torch.as_tensor(envs.reset(seed=0)[0])
        assert isinstance(policy, QPolicy)
        policy.begin(50)
        policy.epsilon, policy.forward = 1.0, 0.2
        chosen = policy(seen, torch.zeros(50).bool())
        assert set(chosen.tolist()) == set(range(count))
        envs.step_torch(chosen)


def quick() -> Checkpoint:
    """Return an agent whose body drives twice as fast as the baselines'."""
    config = replace(SMALL, sim=('drive={"speed":1.4,"commands":[[0,3],[0,-3],[1.4,0]]}',))
    return Checkpoint(network_of(config), config, 0, "mine")


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (
            lambda: PQNConfig(world="drive"),
            "world drive: the action mask shield needs grid steps: add --avoidance none",
        ),
        *(
            (partial(kind, world="drive"), f"world drive: {kind.algorithm} moves in grid steps: use pqn-free")
            for kind, _ in TABLE
            if not kind.drives
        ),
        (
            lambda: actions(replace(SMALL, sim=('drive={"commands":[[0,3]]}',))),
            "world drive: 1 commands: give at least three, the third of them forward",
        ),
        (
            lambda: actions(replace(SMALL, sim=('drive={"commands":[[0.7,0],[0,3],[0,-3]]}',))),
            "world drive: 3 commands: give at least three, the third of them forward",
        ),
        (
            lambda: next(measure({"mine": [quick()]}, HOUSES[:1], ("main",), backend="free")),
            "mine: drive: its speed limits differ from the baselines': only the commands may differ",
        ),
        (
            lambda: Evaluate(backend="free", beside=Path("games.json")).run(),
            "--beside: people played in grid steps: use",
        ),
        (
            lambda: agents_scenes(quick(), HOUSES[0], "main", 0),
            "mine drives, and people play in grid steps: choose another",
        ),
    ],
)
def test_what_cannot_drive_is_refused_in_a_line(refused, message):
    with pytest.raises(RequestError, match=message) as error:
        refused()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("config", "backend", "message"),
    [
        (SMALL, "continuous", "mine drives: add --backend free"),
        (PQNConfig(), "free", "mine moves on a lattice and cannot run with --backend free"),
    ],
)
def test_an_agent_of_the_other_kind_of_motion_is_refused_before_it_plays(config, backend, message, tmp_path):
    save(HOUSES[:1], tmp_path / "houses.jsonl")
    agent = Checkpoint(network_of(config), config, 0, "mine")
    checkpoint.save(agent, tmp_path / "agent.safetensors")
    with pytest.raises(RequestError, match=message):
        Evaluate((tmp_path / "agent.safetensors",), tmp_path / "houses.jsonl", backend=backend).run()
    with pytest.raises(RequestError, match=message):
        next(measure({"mine": [agent]}, HOUSES[:1], ("main",), backend=backend, baselines=()))


def test_a_house_of_too_many_corners_is_refused_before_anything_plays(monkeypatch):
    monkeypatch.setattr(roadmap, "MAX_CORNERS", 3)
    monkeypatch.setattr(protocol, "play", lambda *_: pytest.fail("it plays"))
    with pytest.raises(
        HouseFileError,
        match=r"house \d of 4 has \d+ corners at which paths can turn: at most 3 are supported",
    ):
        next(measure({}, HOUSES, ("main",), backend="free"))
