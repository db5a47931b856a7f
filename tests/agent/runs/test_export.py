"""The exported network gives the same values and memories in another runtime."""

import builtins
from typing import Any

import numpy as np
import pytest
import torch

from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.recurrent import RecurrentQNetwork
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.policies.network import QNetwork, seeded
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.agent.runs.export import INPUTS, OUTPUTS, ExportedStep, NoExporter, export
from vitruvius.cli import main
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("networks are run by another library")

onnxruntime = pytest.importorskip("onnxruntime")
pytest.importorskip("onnxscript")


@pytest.fixture(autouse=True)
def whole_floats():
    """Restore full precision, as a run in this process may have reduced it (``agent.runs.runs``)."""
    before = torch.get_float32_matmul_precision()
    torch.set_float32_matmul_precision("highest")
    yield
    torch.set_float32_matmul_precision(before)


def network(kind: type[torch.nn.Module] = QNetwork) -> Any:
    with seeded(0):
        return kind()


@pytest.fixture(scope="module", params=[QNetwork, RecurrentQNetwork], ids=["pqn", "recurrent"])
def exported(request, tmp_path_factory):
    """Return a network's step, and its file opened in the other runtime."""
    step = ExportedStep(network(request.param)).eval()
    path = tmp_path_factory.mktemp("onnx") / "agent.onnx"
    export(step.network, path)
    assert [each.name for each in path.parent.iterdir()] == ["agent.onnx"]
    return step, onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])


def run(session: Any, *given: torch.Tensor) -> list[np.ndarray]:
    return session.run(None, {name: each.numpy() for name, each in zip(INPUTS, given, strict=True)})


@pytest.mark.parametrize("size", [1, 2, 7, 4096])
def test_the_file_gives_what_torch_gives_for_batches_of_any_size(exported, size):
    step, session = exported
    given = step.example(size, seed=size)
    with torch.no_grad():
        expected = step(*given)
    for here, there in zip(expected, run(session, *given), strict=True):
        np.testing.assert_allclose(there, here.numpy(), rtol=0, atol=1e-5)


def test_a_memory_carried_by_the_file_is_the_networks(exported):
    step, session = exported
    envs, same = 5, torch.zeros(5, dtype=torch.bool)
    here = there = step.network.memory.empty(envs)
    for time in range(100):
        observation, _, blocked = step.example(envs, seed=time)
        with torch.no_grad():
            action = step.network(observation, here).argmax(1)
        q, memories = run(session, observation, there, blocked)
        np.testing.assert_array_equal(q.argmax(1), action)
        here = step.network.memory(here, observation, blocked, action, same)
        there = torch.from_numpy(memories[np.arange(envs), q.argmax(1)])
    assert here.any()
    torch.testing.assert_close(there, here, rtol=0, atol=1e-5)


def test_inputs_and_outputs_bear_their_names_and_only_the_batch_is_free(exported):
    step, session = exported
    given = step.example(1)
    assert [each.name for each in session.get_inputs()] == list(INPUTS)
    assert [each.name for each in session.get_outputs()] == list(OUTPUTS)
    assert [each.shape for each in session.get_inputs()] == [["batch", *each.shape[1:]] for each in given]
    memory = ["batch", 3, *given[1].shape[1:]]
    assert [each.shape for each in session.get_outputs()] == [["batch", 3], memory]


def test_without_the_exporter_one_line_says_what_to_install_and_nothing_is_written(tmp_path, monkeypatch):
    found = builtins.__import__

    def without(name: str, *args: Any, **kwargs: Any) -> Any:
        if name.split(".", maxsplit=1)[0] in ("onnx", "onnxscript"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name.split(".", maxsplit=1)[0])
        return found(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(NoExporter, match="pip install onnx") as error:
        export(network(), tmp_path / "agent.onnx")
    assert error.value.exit_code == 69
    assert not list(tmp_path.iterdir())


def test_the_command_writes_a_checkpoints_network(tmp_path):
    config = PQNConfig()
    saved = tmp_path / "agent.safetensors"
    checkpoint.save(Checkpoint(network_of(config), config, 0), saved)
    with pytest.raises(SystemExit) as done:
        main(["export", str(saved), "--out", str(tmp_path / "agent.onnx")])
    assert not done.value.code
    session = onnxruntime.InferenceSession(tmp_path / "agent.onnx", providers=["CPUExecutionProvider"])
    assert [each.name for each in session.get_outputs()] == list(OUTPUTS)


def test_what_works_on_a_planners_map_is_not_exported(tmp_path):
    with pytest.raises(RequestError, match="network needs the planner's whole map"):
        export(network_of(PRESETS["map-completion"]), tmp_path / "agent.onnx")
    assert not (tmp_path / "agent.onnx").exists()
