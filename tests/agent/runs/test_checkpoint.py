"""Checkpoints come back unchanged, and anything else is refused in one line."""

import json
import os
import pickle
import time
from dataclasses import asdict

import pytest
import safetensors.torch
import torch

from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.policies.network import QNetwork
from vitruvius.agent.runs.checkpoint import FORMAT, Checkpoint, load, save
from vitruvius.agent.runs.released import CheckpointError, released

CONFIG = PQNConfig(steps=1000, seed=3)


def made(path, config: TrainConfig = CONFIG):
    """Write a checkpoint file."""
    save(Checkpoint(network_of(config), config, 512, "mine", "1234", "vitruvius train"), path)
    return path


def spoiled(path, tensors=None, **changes):
    """Write a checkpoint file with some entries of its record replaced, or its tensors."""
    with safetensors.safe_open(made(path), framework="pt") as file:
        record = file.metadata() | changes
        kept = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    safetensors.torch.save_file(kept if tensors is None else tensors, path, metadata=record)
    return path


def refusal(path) -> str:
    """Return the one line that explains why the file is refused."""
    with pytest.raises(CheckpointError) as caught:
        load(path)
    assert caught.value.exit_code == 5
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("preset", PRESETS)
def test_a_checkpoint_comes_back_as_it_was(tmp_path, preset):
    found = load(made(tmp_path / "agent.safetensors", PRESETS[preset]))
    assert found.config == PRESETS[preset]
    assert (found.steps, found.name, found.houses, found.command) == (512, "mine", "1234", "vitruvius train")
    network = network_of(PRESETS[preset])
    if PRESETS[preset].reads_maps:  # it reads no observations, and has its own tests
        kept = found.network.state_dict()
        assert all(torch.equal(kept[name], each) for name, each in network.state_dict().items())
        return
    given = torch.rand(5, *network.shape[:2]), network.memory.empty(5)
    assert torch.equal(found.network(*given), network(*given))


@pytest.mark.parametrize("name", released())
def test_a_released_agent_is_of_a_network_that_can_be_made(name):
    found = load(name)
    assert found.name
    assert found.steps > 0 or name == "paper-original"


def test_saving_leaves_one_file_and_replaces_an_old_one(tmp_path):
    made(tmp_path / "agent.safetensors")
    made(tmp_path / "agent.safetensors")
    assert [path.name for path in tmp_path.iterdir()] == ["agent.safetensors"]


def test_a_checkpoint_that_is_absent_or_a_folder_is_refused(tmp_path):
    assert "there is no such file" in refusal(tmp_path / "none.safetensors")
    assert "is a folder" in refusal(tmp_path)


@pytest.mark.parametrize("content", [b"", b"no checkpoint", b'{"format": 1}\n', pickle.dumps([1])])
def test_a_file_that_is_no_checkpoint_is_refused(tmp_path, content):
    path = tmp_path / "agent.safetensors"
    path.write_bytes(content)
    assert "not a checkpoint" in refusal(path)


def test_a_truncated_checkpoint_is_refused(tmp_path):
    path = made(tmp_path / "agent.safetensors")
    path.write_bytes(path.read_bytes()[:-1000])
    assert "not a checkpoint" in refusal(path)


def test_other_tensors_are_refused(tmp_path):
    path = tmp_path / "agent.safetensors"
    safetensors.torch.save_file({"weights": torch.ones(3)}, path)
    assert f"not a checkpoint of this version ({FORMAT})" in refusal(path)
    assert "not a checkpoint of this version" in refusal(spoiled(path, format="vitruvius-agent-1"))


def test_a_checkpoint_that_names_too_many_houses_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("vitruvius.agent.runs.checkpoint.MAX_LEARNT_HOUSES", 2)
    path = tmp_path / "a.safetensors"
    save(Checkpoint(network_of(CONFIG), CONFIG, 512, learnt_in=frozenset({1, 2, 3})), path)
    assert "learnt_in must be at most 2 64-bit numbers" in refusal(path)


def test_a_network_of_another_shape_is_refused(tmp_path):
    path = tmp_path / "agent.safetensors"
    other = QNetwork(rays=20).state_dict()
    assert ": the checkpoint does not fit this network" in refusal(spoiled(path, other))
    assert ": the checkpoint does not fit this network" in refusal(
        spoiled(path, {"look.weight": torch.ones(1)})
    )
    assert ": the checkpoint does not fit this network" in refusal(
        spoiled(path, config=json.dumps({"half_lives": [1]}))
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_weights_that_are_no_numbers_are_refused(tmp_path, value):
    path = tmp_path / "agent.safetensors"
    weights = network_of(CONFIG).state_dict()
    weights["look.weight"][0, 0] = value
    assert "some weights are not finite numbers" in refusal(spoiled(path, weights))


@pytest.mark.parametrize(
    ("config", "words"),
    [
        ({"half_lives": 90_000 * [1.0]}, "half_lives has at most 64 values, not 90000"),
        ({"half_lives": 3_000_000 * [1.0]}, "its header has more than 1 MiB"),
        ({"sim": ["rays=1000000000"]}, "1 to 1,024 rays"),
    ],
)
def test_a_checkpoint_that_asks_for_a_huge_network_is_refused_before_it_is_made(tmp_path, config, words):
    path = spoiled(tmp_path / "agent.safetensors", config=json.dumps(config))
    begin = time.process_time()
    assert words in refusal(path)
    assert time.process_time() - begin < 1


def test_control_characters_of_a_name_are_escaped(tmp_path):
    assert load(spoiled(tmp_path / "agent.safetensors", name="a\x1b[2Jb")).name == r"a\x1b[2Jb"


def test_what_is_too_large_or_no_file_is_refused_unread(tmp_path):
    path = made(tmp_path / "agent.safetensors")
    os.truncate(path, 5 << 30)  # zeros, which take no disk space
    assert "holds more than 256 MiB" in refusal(path)
    os.mkfifo(tmp_path / "pipe.safetensors")
    assert "it is a device or a pipe, not a file" in refusal(tmp_path / "pipe.safetensors")


def test_a_config_of_another_version_or_algorithm_is_refused(tmp_path):
    path = tmp_path / "agent.safetensors"
    assert "momentum" in refusal(spoiled(path, config=json.dumps({"momentum": 0.9})))
    assert "gamma" in refusal(spoiled(path, config=json.dumps({"gamma": 2.0})))
    assert "steps" in refusal(spoiled(path, config=json.dumps({"steps": "many"})))
    assert "replay" not in refusal(spoiled(path, config=json.dumps(asdict(DQNConfig()))))
    assert "sarsa" in refusal(spoiled(path, algorithm="sarsa"))
