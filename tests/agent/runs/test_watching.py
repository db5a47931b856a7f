"""Evaluations in held-out houses, checkpoints, hooks and several seeds, and user-defined modules.

None of the first four affects the training.
"""

import json
import sys
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
import torch
from torch import nn

from tests.agent.runs.test_runs import metrics, same
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.banks import benchmark
from vitruvius.agent.learning.learner import Progress
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.released import CheckpointError
from vitruvius.agent.runs.runs import run
from vitruvius.agent.runs.watching import Watching
from vitruvius.cli import parse
from vitruvius.logic import HouseFileError, save
from vitruvius.logic.errors import RequestError
from vitruvius.sim import allow, allowed

pytestmark = pytest.mark.second_part("runs are measured as they learn")

HOUSES, HELD_OUT = [random_house(seed) for seed in range(2)], [random_house(seed) for seed in range(4, 6)]
CONFIG = PQNConfig(num_envs=8, num_steps=16, steps=1500, seed=2, sim=("steps=300",))
OWN = "tests.agent.runs.test_watching:Wide"
REPORTS = list[Progress]()


class Wide(nn.Module):
    """Module with one layer over all inputs."""

    def __init__(self, rays: int, channels: int, remembered: int, actions: int) -> None:
        super().__init__()
        self.layer = nn.Linear(rays * channels + remembered, actions)

    def forward(self, observation: torch.Tensor, memory: torch.Tensor) -> torch.Tensor:
        return self.layer(torch.cat([observation.flatten(1), memory], dim=1))


class Narrow(Wide):
    """Module with one action too few."""

    def forward(self, observation: torch.Tensor, memory: torch.Tensor) -> torch.Tensor:
        return super().forward(observation, memory)[:, 1:]


def passed(every: int, steps: Iterable[int]) -> list[int]:
    """Return the steps of reports that are the first after a multiple of ``every``."""
    return [step for before, step in pairwise([0, *steps]) if step // every > before // every]


@pytest.fixture
def nothing_allowed(monkeypatch):
    monkeypatch.setattr(allowed, "_ALLOWED", set())


def test_an_agent_is_evaluated_in_held_out_houses_and_the_best_one_kept_and_learns_the_same(tmp_path):
    reports = list[Progress]()
    watching = Watching(HELD_OUT, evaluate_every=400, keep_every=600, hook=reports.append)
    run(HOUSES, CONFIG, tmp_path / "watched", watching=watching)
    run(HOUSES, CONFIG, tmp_path / "plain")
    assert same(tmp_path / "watched", tmp_path / "plain")
    watched, plain = metrics(tmp_path / "watched"), metrics(tmp_path / "plain")
    found = {line["steps"]: line.pop("held_out") for line in watched}
    assert [line | {"held_out": None} for line in watched] == plain
    scores = {steps: score for steps, score in found.items() if score is not None}
    assert list(scores) == [*passed(400, found), max(found)]
    assert [now.held_out for now in reports] == list(found.values())
    best = checkpoint.load(tmp_path / "watched/best.safetensors")
    assert best.steps == max(scores, key=lambda steps: scores[steps])
    kept = sorted((tmp_path / "watched/checkpoints").iterdir(), key=lambda file: int(file.stem))
    assert [int(file.stem) for file in kept] == passed(600, found)
    assert [checkpoint.load(file).steps for file in kept] == passed(600, found)
    # A resumed run knows the best evaluation so far.
    run(HOUSES, replace(CONFIG, steps=2000), tmp_path / "watched", watching=watching, resume=True)
    again = checkpoint.load(tmp_path / "watched/best.safetensors").steps
    scores |= {line["steps"]: line["held_out"] for line in metrics(tmp_path / "watched")[len(found) :]}
    assert again == max((steps for steps in scores if scores[steps] is not None), key=scores.__getitem__)


def test_held_out_houses_are_none_that_are_learnt_in_or_kept_for_measuring(tmp_path):
    for held_out, error, message in (
        ([*HELD_OUT, HOUSES[1]], RequestError, "held-out house 2: the agent is trained on this"),
        (benchmark()[:1], HouseFileError, "held-out houses: house 0: its seed .* is reserved for evaluation"),
        ([], RequestError, "needs 1 to 1,024 held-out houses, not 0: name a house file with --held-out"),
    ):
        with pytest.raises(error, match=message):
            run(HOUSES, CONFIG, tmp_path / "run", watching=Watching(held_out, evaluate_every=1))
    with pytest.raises(RequestError, match="keep_every must be 0 or more"):
        run(HOUSES, CONFIG, tmp_path / "other", watching=Watching(keep_every=-1))


def test_train_takes_seeds_held_out_houses_a_hook_and_a_module(tmp_path, monkeypatch, nothing_allowed):
    save(HOUSES, tmp_path / "houses.jsonl")
    save(HELD_OUT, tmp_path / "other.jsonl")
    words = ["train", str(tmp_path / "houses.jsonl"), "--held-out", str(tmp_path / "other.jsonl")]
    words += ["--evaluate-every", "400", "--hook", "tests.agent.runs.test_watching:noted", "--module", OWN]
    words += ["--num-envs", "8", "--num-steps", "16", "--steps", "500", "--sim", "steps=40"]
    monkeypatch.setattr(sys.modules[__name__], "REPORTS", [])
    assert parse([*words, "--seeds", "2", "--seed", "5", "--out", str(tmp_path / "run")]).run() == 0
    runs = [tmp_path / "run" / f"seed-{seed}" for seed in (5, 6)]
    found = [checkpoint.load(folder / "best.safetensors") for folder in runs]
    assert [each.config.seed for each in found] == [5, 6]
    assert type(found[0].network.judge) is Wide
    assert not torch.equal(found[0].network.judge.layer.weight, found[1].network.judge.layer.weight)
    assert len(REPORTS) == 2 * len(metrics(runs[0]))
    assert json.loads((runs[0] / "config.json").read_text())["config"]["module"] == OWN


def noted(now: Progress) -> None:
    REPORTS.append(now)


def test_no_file_names_a_module(tmp_path, nothing_allowed):
    settings = tmp_path / "train.toml"
    settings.write_text(f'preset = "pqn"\nmodule = "{OWN}"\n')
    with pytest.raises(RequestError, match="is code, and a file may not name code by"):
        parse(["train", "--config", str(settings), "--out", str(tmp_path / "run")]).run()
    allow(OWN)
    run(HOUSES, replace(CONFIG, module=OWN, steps=200), tmp_path / "own")
    allowed._ALLOWED.clear()
    with pytest.raises(CheckpointError, match=rf"own/agent.safetensors: module {OWN} .* is code"):
        checkpoint.load(tmp_path / "own/agent.safetensors")
    allow(OWN)
    assert type(checkpoint.load(tmp_path / "own/agent.safetensors").network.judge) is Wide


@pytest.mark.parametrize(
    ("module", "message"),
    [
        (
            "tests.agent.runs.test_watching:Narrow",
            r"it returns shape \(2, 2\) for two observations, not \(2, 3\)",
        ),
        ("tests.agent.runs.test_watching:noted", "takes 1 positional argument"),
        ("tests.agent.runs.test_watching:Absent", "has no attribute"),
    ],
)
def test_a_module_that_is_no_q_network_is_refused(module, message, nothing_allowed):
    from vitruvius.agent.algorithms.build import network_of

    allow(module)
    for kind in (PQNConfig, DQNConfig):
        with pytest.raises(RequestError, match=f"module {module} cannot be used: .*{message}"):
            network_of(kind(module=module))


def test_a_recurrent_network_has_no_module_of_its_own_and_a_module_is_a_class():
    with pytest.raises(RequestError, match="not the recurrent one"):
        PQNConfig(network="recurrent", module=OWN)
    with pytest.raises(RequestError, match="give module:Class"):
        PQNConfig(module="Wide")
    assert Path(__file__).stem in OWN
