"""Several processes that train together give the results of one process with all their environments."""

import json
import signal
import sys
import time
from pathlib import Path

import pytest
import torch

from tests import processes
from tests.programs import PATIENCE, finished
from tests.ranks import main as learn
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.learning import ranks
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.runs import run
from vitruvius.logic import RequestError, save
from vitruvius.logic.errors import Killed

pytestmark = pytest.mark.second_part("several processes learn as one")

ROOT = Path(__file__).parents[3]
TORCHRUN = [sys.executable, "-m", "torch.distributed.run", "--nproc-per-node=2", "--master-port=0"]
TORCHRUN += ["--rdzv-backend=c10d", "--rdzv-endpoint=localhost:0"]


@pytest.fixture(scope="module")
def learnt(tmp_path_factory):
    """Return the results of one process with eight environments, and of two with four each, by gloo."""
    folder = tmp_path_factory.mktemp("ranks")
    learn(str(folder / "one"))
    assert processes.as_two_ranks(str(folder / "two"), job=learn) == [0, 0]
    return [torch.load(folder / name, weights_only=True) for name in ("one", "two")]


def test_two_ranks_give_the_gradient_of_one_with_both_batches(learnt):
    one, two = learnt
    assert one["gradients"][0].abs().max() > 1e-4
    torch.testing.assert_close(two["gradients"][0], one["gradients"][0], rtol=1e-4, atol=1e-7)


def test_two_ranks_report_the_steps_and_targets_of_one(learnt):
    one, two = learnt
    # Of 30 steps, one of each environment began an episode, and one of the next 30.
    assert one["steps"] == two["steps"] == [8 * 29, 8 * 58]
    assert two["targets"] == one["targets"]


def test_all_ranks_hold_the_same_weights(learnt):
    _, two = learnt
    assert len(two["weights"]) == 2
    assert torch.equal(*two["weights"])


def test_no_thread_of_the_process_group_is_left(learnt):
    """Otherwise gloo's threads still run as the interpreter ends, and sometimes abort the process."""
    assert all(each["left"] for each in learnt)


def test_the_command_trains_by_torchrun_and_goes_on(tmp_path):
    save([random_house(seed) for seed in range(4)], tmp_path / "houses.jsonl")
    out = tmp_path / "run"
    train = ["train", str(tmp_path / "houses.jsonl"), "--out", str(out)]
    train += ["--num-envs", "8", "--num-steps", "16"]
    ended = finished([*TORCHRUN, "-m", "vitruvius.cli", *train, "--steps", "500"], cwd=ROOT)
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert ended.stderr.count("vitruvius evaluate") == 1  # one of them reports
    assert json.loads((out / "config.json").read_text())["ranks"] == 2
    assert processes.as_two_ranks(*train, "--steps", "1000", "--resume") == [0, 0]
    steps = [json.loads(line)["steps"] for line in (out / "metrics.jsonl").read_text().splitlines()]
    assert steps == list(range(128, 1025, 128))
    assert checkpoint.load(out / "agent.safetensors").steps == 1024


def test_a_rank_that_is_lost_costs_nothing_but_time(tmp_path):
    """The rank is lost by SIGKILL: the other ends with one line.

    Both, started again with --resume, learn the same bits.
    """
    save([random_house(seed) for seed in range(4)], tmp_path / "houses.jsonl")
    train = [
        "train",
        str(tmp_path / "houses.jsonl"),
        "--num-envs",
        "8",
        "--num-steps",
        "16",
        "--steps",
        "1500",
    ]
    assert processes.as_two_ranks(*train, "--out", str(tmp_path / "whole")) == [0, 0]
    again = [*train, "--out", str(tmp_path / "lost"), "--resume"]
    for lost, reports in ((1, 3), (0, 7)):
        with processes.two_ranks(*again) as ranks:
            while len(metrics(tmp_path / "lost")) < reports and ranks[lost].is_alive():
                time.sleep(0.02)
            ranks[lost].kill()
            for process in ranks:
                process.join(PATIENCE)
            assert ranks[1 - lost].exitcode == Killed.exit_code
            assert ranks[lost].exitcode == -signal.SIGKILL
    assert processes.as_two_ranks(*again) == [0, 0]
    assert metrics(tmp_path / "lost") == metrics(tmp_path / "whole")
    whole, lost = (checkpoint.load(tmp_path / name / "agent.safetensors") for name in ("whole", "lost"))
    weights = lost.network.state_dict()
    assert all(torch.equal(value, weights[name]) for name, value in whole.network.state_dict().items())


def metrics(folder: Path) -> list[dict]:
    """Return the reports, without the values of clocks."""
    file = folder / "metrics.jsonl"
    lines = file.read_text().splitlines() if file.exists() else []
    clocks = {"seconds", "simulator", "learner", "map"}
    return [{name: value for name, value in json.loads(line).items() if name not in clocks} for line in lines]


def test_environments_that_ranks_cannot_share_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(ranks, "size", lambda: 2)
    with pytest.raises(RequestError, match="num_envs must be a multiple of the 2 ranks, not 7"):
        run([random_house(0)], PQNConfig(num_envs=7), tmp_path / "run")
    assert not (tmp_path / "run/config.json").exists()
