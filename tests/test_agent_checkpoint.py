"""Checkpoints come back as they were, and anything else is refused in one line."""

import io

import pytest
import torch

from agent.checkpoint import Checkpoint, CheckpointError, load, save
from agent.config import Config
from agent.network import seeded_network


def made(path):
    """A checkpoint file."""
    save(Checkpoint(seeded_network(3), Config(steps=1000, seed=3), steps=512), path)
    return path


def spoiled(path, **changes):
    """A checkpoint file with some entries of its record replaced."""
    record = torch.load(made(path), weights_only=True)
    torch.save({**record, **changes}, path)
    return path


def refusal(path, **options) -> str:
    """The one line that says why the file is refused."""
    with pytest.raises(CheckpointError) as caught:
        load(path, **options)
    assert caught.value.exit_code == 5
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_checkpoint_comes_back_as_it_was(tmp_path):
    checkpoint = load(made(tmp_path / "agent.pt"), shape=(40, 2))
    assert checkpoint.config == Config(steps=1000, seed=3)
    assert checkpoint.steps == 512
    x, memory = torch.rand(5, 40, 2), torch.rand(5, 4, 6)
    assert torch.equal(checkpoint.network(x, memory), seeded_network(3)(x, memory))


def test_saving_leaves_one_file_and_replaces_an_old_one(tmp_path):
    made(tmp_path / "agent.pt")
    made(tmp_path / "agent.pt")
    assert [path.name for path in tmp_path.iterdir()] == ["agent.pt"]


def test_a_checkpoint_that_is_absent_or_a_folder_is_refused(tmp_path):
    assert "No such file" in refusal(tmp_path / "none.pt")
    assert "directory" in refusal(tmp_path)


@pytest.mark.parametrize("content", [b"", b"no checkpoint", b'{"format": 1}\n', b"PK\x03\x04 broken"])
def test_a_file_that_is_no_checkpoint_is_refused(tmp_path, content):
    path = tmp_path / "agent.pt"
    path.write_bytes(content)
    assert "not a checkpoint" in refusal(path)


def test_a_truncated_checkpoint_is_refused(tmp_path):
    path = made(tmp_path / "agent.pt")
    path.write_bytes(path.read_bytes()[:-1000])
    assert "not a checkpoint" in refusal(path)


def test_other_torch_files_are_refused(tmp_path):
    path = tmp_path / "agent.pt"
    torch.save({"weights": torch.ones(3)}, path)
    assert "not a checkpoint of this version" in refusal(path)
    torch.save(torch.ones(3), path)
    assert "not a checkpoint of this version" in refusal(path)


def test_a_checkpoint_never_runs_code(tmp_path):
    class Code:
        def __reduce__(self):
            return (open, (str(tmp_path / "proof"), "w"))

    content = io.BytesIO()
    torch.save({"format": Code()}, content)
    (tmp_path / "agent.pt").write_bytes(content.getvalue())
    assert "not a checkpoint" in refusal(tmp_path / "agent.pt")
    assert not (tmp_path / "proof").exists()


def test_a_network_of_another_shape_is_refused(tmp_path):
    path = tmp_path / "agent.pt"
    assert "40 rays x 2" in refusal(made(path), shape=(40, 3))
    assert "another shape" in refusal(spoiled(path, network=seeded_network(0, rays=20).state_dict()))
    assert "another shape" in refusal(spoiled(path, network={"look.weight": torch.ones(1)}))


def test_a_config_of_another_version_is_refused(tmp_path):
    assert "momentum" in refusal(spoiled(tmp_path / "agent.pt", config={"momentum": 0.9}))
    assert "discount" in refusal(spoiled(tmp_path / "agent.pt", config={"discount": 2.0}))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("environments", 0),
        ("steps", -1),
        ("discount", 1.5),
        ("epsilon", -0.1),
        ("seconds", 0.0),
        ("minibatches", 9000),
        ("half_lives", (4.0, 0.0)),
    ],
)
def test_a_config_that_no_run_can_have_is_refused_by_name(field, value):
    with pytest.raises(ValueError, match=field):
        Config(**{field: value})
