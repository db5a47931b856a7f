"""Runs survive a kill at any moment, and overwrite no other run."""

import errno
import gzip
import io
import json
import os
import pickle
import shutil
import signal
import time
from dataclasses import replace
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest
import torch

from tests import processes
from tests.agent.algorithms.cases import SMALL
from tests.programs import PATIENCE
from tests.sample_houses import random_house
from vitruvius.agent.algorithms.build import algorithm_of
from vitruvius.agent.algorithms.pqn.learner import PQN
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.banks import bank_hash
from vitruvius.agent.learning.learner import Diverged
from vitruvius.agent.report.folder import report
from vitruvius.agent.runs import checkpoint, runs
from vitruvius.agent.runs.released import CheckpointError
from vitruvius.agent.runs.runs import run
from vitruvius.cli import parse
from vitruvius.logic import HouseSet, HouseStream, load, save
from vitruvius.logic.errors import RequestError
from vitruvius.logic.stopping import Terminated
from vitruvius.sim import HouseRotation
from vitruvius.sim.environment.arguments import BANK

pytestmark = pytest.mark.second_part("runs are killed and go on")

HOUSES = [random_house(seed) for seed in range(4)]
CONFIG = SMALL["pqn"]


@pytest.fixture(scope="module")
def ended(tmp_path_factory) -> Path:
    """Return the folder of a run that has ended, made once."""
    folder = tmp_path_factory.mktemp("ended") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "SAVE_SECONDS", 0.0)
        run(HOUSES, CONFIG, folder, name="pqn", command="vitruvius train ...")
    return folder


@pytest.fixture
def folder(ended: Path, tmp_path: Path) -> Path:
    """Return a copy of it, for a test to change."""
    return shutil.copytree(ended, tmp_path / "run")


@pytest.fixture(autouse=True)
def keeping_at_once(monkeypatch):
    """Save all after every report."""
    monkeypatch.setattr(runs, "SAVE_SECONDS", 0.0)


def metrics(folder: Path) -> list[dict]:
    """Return the reports, without the values of clocks."""
    lines = [json.loads(line) for line in (folder / "metrics.jsonl").read_text().splitlines()]
    clocks = ("seconds", "simulator", "learner", "map")
    return [{name: value for name, value in line.items() if name not in clocks} for line in lines]


def same(one: Path, other: Path) -> bool:
    """Return True if two checkpoints hold the same numbers."""
    pairs = [checkpoint.load(path / "agent.safetensors").network.state_dict() for path in (one, other)]
    return all(torch.equal(value, pairs[1][name]) for name, value in pairs[0].items())


def test_train_takes_any_task_and_any_field_of_the_simulator_and_keeps_them(tmp_path, monkeypatch):
    """Without given houses, it trains on those that come with the project."""
    monkeypatch.chdir(tmp_path)
    task = '{"task": "reach", "room": "kitchen"}'
    words = ["train", "--targets", task, "--sim", "steps=99", "--sim", "random_start=false", "--out", "run"]
    words += ["--num-envs", "8", "--num-steps", "16", "--steps"]
    assert parse([*words, "256"]).run() == 0
    found = checkpoint.load("run/agent.safetensors")
    assert (found.config.targets, found.config.sim) == (task, ("steps=99", "random_start=false"))
    assert found.houses == bank_hash(load(BANK))
    assert parse([*words, "512", "--resume"]).run() == 0
    assert checkpoint.load("run/agent.safetensors").steps == 512
    assert Path("run/report.html").read_bytes() == report(Path("run"))


def test_a_folder_has_all_that_is_needed_to_repeat_the_run(ended):
    record = json.loads((ended / "config.json").read_text())
    assert checkpoint.config_of(record["algorithm"], record["config"]) == CONFIG
    assert record["houses"] == {"number": 4, "hash": bank_hash(HOUSES)}
    found = checkpoint.load(ended / "agent.safetensors")
    assert (found.steps, found.houses, found.command) == (1536, bank_hash(HOUSES), "vitruvius train ...")
    assert metrics(ended)[-1]["steps"] == 1536
    assert [path.name[:19] for path in (ended / "tensorboard").iterdir()] == ["events.out.tfevents"]


def test_a_run_that_was_killed_goes_on_bit_for_bit(tmp_path):
    """The kill is SIGKILL, at any point, and again, with all that a run may save."""
    save(HOUSES, tmp_path / "houses.jsonl")
    arguments = ["train", str(tmp_path / "houses.jsonl"), "--steps", "2500", "--seed", "1"]
    arguments += ["--num-envs", "8", "--num-steps", "16"]

    def started(name: str) -> BaseProcess:
        # --resume starts a new run in an empty folder
        return processes.start(*arguments, "--out", str(tmp_path / name), "--resume")

    whole = started("whole")
    whole.join(PATIENCE)  # the others find its kernels on disk
    assert whole.exitcode == 0
    killed, lines = started("killed"), 0
    for least in (4, 11):
        while lines < least and killed.is_alive():
            time.sleep(0.02)
            file = tmp_path / "killed/metrics.jsonl"
            lines = len(file.read_text().splitlines()) if file.exists() else 0
        killed.kill()
        killed.join()
        killed = started("killed")
    killed.join(PATIENCE)
    assert killed.exitcode == 0
    assert metrics(tmp_path / "killed") == metrics(tmp_path / "whole")
    assert same(tmp_path / "killed", tmp_path / "whole")


@pytest.mark.parametrize(
    ("config", "houses"),
    [
        *(pytest.param(config, HOUSES, id=name) for name, config in SMALL.items()),
        pytest.param(CONFIG, HouseRotation(HOUSES, 2, 50), id="pqn-in-rotation"),
    ],
)
def test_a_run_that_stopped_after_any_report_goes_on_bit_for_bit(tmp_path, monkeypatch, config, houses):
    """Each algorithm is tried; what was learned after the last saved state is learned again."""
    run(houses, config, tmp_path / "whole")
    learner = algorithm_of(config)
    iterate = learner.iterate
    for left in (1, 2):
        turns = iter([iterate] * left)
        monkeypatch.setattr(learner, "iterate", lambda learner, turns=turns: next(turns)(learner))
        with pytest.raises(RuntimeError, match="StopIteration"):
            run(houses, config, tmp_path / "stopped", resume=True)
    monkeypatch.setattr(learner, "iterate", iterate)
    run(houses, config, tmp_path / "stopped", resume=True)
    assert metrics(tmp_path / "stopped") == metrics(tmp_path / "whole")
    assert same(tmp_path / "stopped", tmp_path / "whole")


def test_houses_in_rotation_are_named_and_maps_of_them_are_not_learnt(tmp_path):
    rotation = HouseRotation(HOUSES, 2, 50)
    made, _ = run(rotation, CONFIG, tmp_path / "run")
    assert (made.houses, len(made.learnt_in)) == (bank_hash(HOUSES), 4)
    assert json.loads((tmp_path / "run/config.json").read_text())["houses"]["number"] == 4
    with pytest.raises(
        RequestError, match="map-completion cannot train on rotating houses: give a house file"
    ):
        run(rotation, SMALL["map-completion"], tmp_path / "maps")
    with pytest.raises(RequestError, match="seed 2000000000 of a stream: train on houses with seeds below"):
        run(HouseStream(2, seed=2 * 10**9), CONFIG, tmp_path / "stream")
    with pytest.raises(RequestError, match="the state belongs to another rotation"):
        run(HouseRotation(HOUSES, 3, 50), CONFIG, tmp_path / "run", resume=True)


def test_train_learns_in_the_training_split_of_a_set_and_in_houses_made_meanwhile(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = ["--rooms", "2", "--count", "3", "--test", "2", "--shard", "all/2", "--files", "jsonl"]
    assert parse(["generate", *made, "--out", "set"]).run() in (0, None)
    words = ["--num-envs", "8", "--num-steps", "16", "--steps", "256"]
    for houses, number in (("set", 3), ("family:rooms=2..3", 2**31 - 1)):
        out = Path(houses.partition(":")[0] + "-run")
        assert parse(["train", houses, *words, "--out", str(out)]).run() == 0
        assert json.loads((out / "config.json").read_text())["houses"]["number"] == number
    found = checkpoint.load("set-run/agent.safetensors")
    assert (found.houses, found.learnt_in) == (HouseSet("set", "train").hash, frozenset())
    with pytest.raises(RequestError, match="training uses the split train of a set"):
        run(HouseSet("set"), CONFIG, tmp_path / "all")


@pytest.mark.parametrize(
    ("number", "end"),
    [(signal.SIGTERM, Terminated), (signal.SIGHUP, Terminated), (signal.SIGINT, KeyboardInterrupt)],
)
def test_a_run_that_is_ended_is_saved_at_the_next_report(number, end, tmp_path, monkeypatch):
    reports, iterate = [], PQN.iterate

    def terminated(learner: PQN):
        reports.append(iterate(learner))
        if len(reports) == 3:
            os.kill(os.getpid(), number)
        return reports[-1]

    monkeypatch.setattr(PQN, "iterate", terminated)
    monkeypatch.setattr(runs, "SAVE_SECONDS", 1e9)
    with pytest.raises(end):
        run(HOUSES, CONFIG, tmp_path / "run")
    assert checkpoint.load(tmp_path / "run/agent.safetensors").steps == 384
    made, history = run(HOUSES, CONFIG, tmp_path / "run", resume=True)
    assert [now.steps for now in history] == list(range(128, 1537, 128))
    assert made.steps == 1536


def test_a_run_goes_on_with_more_steps(folder):
    made, history = run(HOUSES, replace(CONFIG, steps=2500), folder, resume=True)
    assert made.steps == 2560
    assert [now.steps for now in history] == list(range(128, 2561, 128))


def test_a_folder_that_holds_a_run_is_refused_and_left_as_it_is(folder):
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    with pytest.raises(RequestError, match="already holds a run"):
        run(HOUSES, CONFIG, folder)
    with pytest.raises(RequestError, match="another config cannot be resumed here: q_lambda"):
        run(HOUSES, replace(CONFIG, q_lambda=0.3), folder, resume=True)
    with pytest.raises(RequestError, match="pqn cannot be resumed as dqn"):
        run(HOUSES, replace(PRESETS["dqn"], num_envs=8), folder, resume=True)
    with pytest.raises(RequestError, match="other houses"):
        run(HOUSES[:2], CONFIG, folder, resume=True)
    assert before == {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("name", ["agent.safetensors", "metrics.jsonl", "state.pt.gz"])
def test_a_folder_with_a_file_that_a_run_would_replace_is_refused(tmp_path, name):
    (tmp_path / name).write_text("mine")
    with pytest.raises(RequestError, match="already holds a run"):
        run(HOUSES, CONFIG, tmp_path)
    assert (tmp_path / name).read_text() == "mine"


def test_a_folder_that_another_run_works_in_is_refused(tmp_path):
    folder = runs.Folder(tmp_path / "run")
    with (
        folder.alone(resume=False),
        pytest.raises(RequestError, match=": another run is active in this folder"),
    ):
        run(HOUSES, CONFIG, tmp_path / "run", resume=True)
    assert [path.name for path in (tmp_path / "run").iterdir()] == [".lock"]
    run(HOUSES, replace(CONFIG, steps=128), tmp_path / "run")  # a run that ended leaves the folder free


def test_a_folder_of_a_file_system_without_locks_is_free(tmp_path, monkeypatch):
    def no_locks(file, operation):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", no_locks)
    with runs.Folder(tmp_path / "run").alone(resume=False):
        pass


def test_a_damaged_state_is_refused_in_one_line(folder):
    state = folder / "state.pt.gz"
    for content in (b"", b"nothing", state.read_bytes()[:-500]):
        state.write_bytes(content)
        with pytest.raises(CheckpointError, match=r"state.pt.gz: cannot be read") as caught:
            run(HOUSES, CONFIG, folder, resume=True)
        assert "\n" not in str(caught.value)


def test_a_state_of_another_content_is_refused_in_one_line(folder):
    state = folder / "state.pt.gz"
    (good,) = torch.load(io.BytesIO(gzip.decompress(state.read_bytes())), weights_only=True)
    strange = [
        7,
        [7],
        {},
        [{}],
        [good | {"network": {}}],
        [good | {"envs": {}}],
        [torch.full((3,), torch.nan)],  # of which torch warns
        [good | {"clock": {"a": 1}}],
    ]
    for value in [*strange, [good | {"generator": torch.zeros(3)}], [good | {"config": []}]]:
        content = io.BytesIO()
        torch.save(value, content)
        state.write_bytes(gzip.compress(content.getvalue()))
        with pytest.raises((CheckpointError, RequestError)) as caught:
            run(HOUSES, CONFIG, folder, resume=True)
        assert "\n" not in str(caught.value)
    state.write_bytes(gzip.compress(pickle.dumps(print)))
    with pytest.raises(CheckpointError, match="cannot be read"):
        run(HOUSES, CONFIG, folder, resume=True)


def test_reports_that_cannot_be_read_are_left_out_and_a_run_without_any_is_refused(folder):
    file = folder / "metrics.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    strange = [
        b"\xff\xfe\n",
        b"[]\n",
        b'{"steps": "many"}\n',
        lines[0].replace(b'"steps": 128', b'"steps": null'),
    ]
    file.write_bytes(b"".join([*strange, *lines, bytes(100_000)]))
    _, history = run(HOUSES, CONFIG, folder, resume=True)
    assert [now.steps for now in history] == list(range(128, 1537, 128))
    assert file.read_bytes().splitlines(keepends=True) == lines
    file.write_bytes(strange[0])
    with pytest.raises(CheckpointError, match=r"metrics.jsonl: lacks the reports up to step 1,536"):
        run(HOUSES, CONFIG, folder, resume=True)


def test_a_run_that_diverges_leaves_the_last_good_checkpoint(tmp_path, monkeypatch):
    reports, iterate = [], PQN.iterate

    def spoilt(learner: PQN):
        if len(reports) == 3:
            torch.nn.init.constant_(learner.network.judge[-1].bias, float("nan"))
        reports.append(iterate(learner))
        return reports[-1]

    monkeypatch.setattr(PQN, "iterate", spoilt)
    with pytest.raises(
        Diverged, match=r"nan after 512 steps: .*agent.safetensors is the last good checkpoint"
    ):
        run(HOUSES, CONFIG, tmp_path / "run")
    kept = checkpoint.load(tmp_path / "run/agent.safetensors")
    assert kept.steps == 384
    assert all(torch.isfinite(value).all() for value in kept.network.state_dict().values())


def test_torch_has_the_threads_of_a_run_only_while_it_trains(tmp_path, monkeypatch):
    seen = []

    def refused(houses, config):
        seen.append(torch.get_num_threads())
        raise RequestError("no learner")

    monkeypatch.setattr(runs, "_learner", refused)
    with pytest.raises(RequestError):
        run(HOUSES, replace(CONFIG, threads=3), tmp_path / "run")
    assert (seen, torch.get_num_threads()) == ([3], 1)


def test_a_device_that_is_not_there_is_refused(tmp_path):
    if torch.cuda.is_available():
        pytest.skip("there is a GPU")
    with pytest.raises(RequestError, match="torch finds no GPU here"):
        run(HOUSES, replace(CONFIG, device="cuda"), tmp_path / "run")
