"""A GPU gives the results of the CPU. Some of it is tested without a GPU."""

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from tests.programs import finished
from vitruvius.agent.runs.checkpoint import load
from vitruvius.sim.drive import Drive
from vitruvius.sim.environment.steps import Commands
from vitruvius.sim.runtime import Array, arrays, has_cuda, start, ti
from vitruvius.sim.tracing import impl

needs_gpu = pytest.mark.skipif(not has_cuda(), reason="no GPU here")


def compared(one: Any, other: Any) -> dict[str, dict[str, float]]:
    """Return the differences of the outcomes on two devices, by preset."""
    presets = dict.fromkeys(name.partition("/")[0] for name in one if "/" in name)
    differences = {}
    for preset in presets:
        names = (f"{preset}/{part}" for part in ("events", "places", "seen"))
        (events, theirs), places, seen = ((one[name], other[name]) for name in names)
        apart = np.abs(seen[0] - seen[1])
        elsewhere = apart.max(axis=-1) > 1e-4
        differences[preset] = {
            "events": float((events != theirs).mean()),
            "places": float(np.abs(places[0] - places[1]).max()),
            "distances": float(apart[~elsewhere].max()),
            "elsewhere": float(elsewhere.mean()),
        }
    return differences


@needs_gpu
def test_what_happens_on_a_gpu_is_what_happens_on_the_cpu(tmp_path):
    for device in ("cpu", "cuda"):
        program = f"write_trails({device!r}, {str(tmp_path / device)!r})"
        python("-c", f"from benchmarks.speed.trails import write_trails; {program}")
    trails = [np.load(tmp_path / f"{device}.npz") for device in ("cpu", "cuda")]
    differences = compared(*trails)
    assert {preset: each["events"] for preset, each in differences.items()} == dict.fromkeys(differences, 0)
    for preset, each in differences.items():
        # For driving bodies, an error of the heading grows along the path.
        assert each["places"] < (1e-3 if preset == "drive" else 1e-5)
        assert each["distances"] < 1e-4
        assert each["elsewhere"] < 1e-4
    one, other = (each["advice"] for each in trails)
    assert (one != other).any(axis=0).sum() <= 1


@needs_gpu
@pytest.mark.parametrize("preset", ["pqn", "pqn-recurrent"])
def test_a_run_on_a_gpu_goes_on_and_its_agent_plays_on_a_cpu(tmp_path, preset):
    train = (
        "-m",
        "vitruvius.cli",
        "train",
        "--preset",
        preset,
        "--device",
        "cuda",
        "--out",
        str(tmp_path / "run"),
    )
    python(*train, "--num-envs", "64", "--steps", "8000")
    python(*train, "--num-envs", "64", "--steps", "16000", "--resume")
    agent = load(tmp_path / "run/agent.safetensors")
    assert agent.steps >= 16000
    assert {value.device.type for value in agent.network.state_dict().values()} == {"cpu"}


def test_what_needs_taichi_takes_the_device_that_runs(monkeypatch):
    program = start()
    monkeypatch.setattr(impl, "current_cfg", lambda: SimpleNamespace(arch=ti.cuda))
    assert start() is program
    with pytest.raises(ValueError, match=r"'cpu' cannot be used: \w+ runs on a GPU in this process"):
        start("cpu")


def test_a_gpus_memory_is_not_looked_into(monkeypatch):
    start()
    monkeypatch.setattr(arrays, "on_gpu", lambda: True)
    array = Array(ti.i32, 3)
    with pytest.raises(RuntimeError, match="NumPy cannot read GPU memory"):
        array.view()


@pytest.mark.parametrize("clips", [False, True])
@pytest.mark.parametrize("number", [np.nan, 0.71, -0.01, np.inf, 0.7])
def test_speeds_are_checked_where_they_are(number, clips):
    """Tensors are refused for the same reasons as arrays, without a copy from the GPU."""
    orders, said = Commands(Drive(clips=clips)), []
    actions = np.zeros((5, 2), np.float32)
    actions[3, 0] = number
    for each in (actions, torch.from_numpy(actions)):
        try:
            said.append(orders.require(each, 5))
        except ValueError as error:
            said.append(str(error))
    refused = np.isnan(number) or not (clips or 0 <= number <= 0.7001)
    assert said[0] == said[1]
    assert (said[0] is not None) == refused
    assert not refused or said[0].startswith(f"action 3 is ({number:g}, 0)")


def python(*arguments: str) -> None:
    """Run a separate Python process, because Taichi runs on one device per process."""
    done = finished([sys.executable, *arguments])
    assert done.returncode == 0, done.stderr
