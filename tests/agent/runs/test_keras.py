"""The original program's weights: read as Keras wrote them, by a network that sees what theirs saw."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import torch

from agent.algorithms.build import policy_of
from agent.algorithms.paper.network import PaperNetwork, next_angles
from agent.avoidance import Free
from agent.banks import named
from agent.evaluation.episodes import play
from agent.learning.environments import make_envs
from agent.policies.policies import QPolicy
from agent.runs.checkpoint import load
from agent.runs.keras import ORIGINAL, import_keras
from agent.runs.released import CheckpointError
from sim import HouseVectorEnv
from tests import sample_houses
from vitruvius.commands.train import ImportKeras

SHAPES = [(3, 25), (1000, 50), (50, 100), (100, 50), (50, 25), (25, 3)]
LAYERS = ["dense_1", "flatten_1", *(f"dense_{k}" for k in range(2, 7))]


def keras_file(path: Path, shapes=SHAPES, layers=LAYERS, wrapped: bool = True, value: float | None = None):
    """A file as Keras writes it, and its arrays: a kernel and a bias for each dense layer."""
    rng, arrays = np.random.default_rng(0), []
    with h5py.File(path, "w") as file:
        top = file.create_group("model_weights") if wrapped else file
        top.attrs["layer_names"] = np.array([name.encode() for name in layers])
        dense = iter(shapes)
        for name in layers:
            names = [] if name.startswith("flatten") else [f"{name}/kernel:0", f"{name}/bias:0"]
            top.create_group(name).attrs["weight_names"] = np.array([each.encode() for each in names], "S")
            shape = next(dense) if names else ()
            for each, size in zip(names, (shape, shape[1:]), strict=False):
                arrays.append(rng.normal(0, 0.1, size).astype(np.float32))
                if value is not None:
                    arrays[-1].flat[0] = value
                top.create_dataset(f"{name}/{each}", data=arrays[-1])
    return arrays


def forward(arrays: list[np.ndarray], observation: np.ndarray) -> np.ndarray:
    """What Keras computes of observations (B, 40, 3): layer by layer, in NumPy."""
    x = np.maximum(observation @ arrays[0] + arrays[1], 0).reshape(len(observation), -1)
    for kernel, bias in zip(arrays[2:-2:2], arrays[3:-2:2], strict=True):
        x = np.maximum(x @ kernel + bias, 0)
    x = x @ arrays[-2] + arrays[-1]
    x = np.exp(x - x.max(-1, keepdims=True))
    return x / x.sum(-1, keepdims=True)


@pytest.mark.parametrize("wrapped", [True, False], ids=["model.save", "save_weights"])
def test_the_network_computes_what_keras_does(tmp_path, wrapped):
    arrays = keras_file(tmp_path / "weights.h5", wrapped=wrapped)
    ours = sample_observations()
    theirs = np.concatenate([next_angles(ours[..., :1], -3.0), ours[..., 1:]], axis=-1)
    network = import_keras(tmp_path / "weights.h5", "mine").network
    np.testing.assert_allclose(network(ours).detach(), forward(arrays, theirs), rtol=1e-4, atol=1e-6)
    assert np.abs(forward(arrays, ours.numpy()) - forward(arrays, theirs)).max() > 1e-5


def sample_observations() -> torch.Tensor:
    """What the paper's body sees in the original's house, facing each way: (8, 40, 3)."""
    envs = HouseVectorEnv([sample_houses.example()], num_envs=8, preset="paper")
    observation = envs.reset(seed=0)[0]
    for turn in range(7):
        observation = envs.step(np.where(np.arange(8) > turn, 0, 2))[0]
    return torch.as_tensor(observation)


def test_the_next_rays_angle_is_what_the_original_wrote():
    """At each ray of each heading of its recording, also where the angles begin again at 0."""
    trace = np.load(sample_houses.FIXTURES / "example1-trace.npz")
    heading = trace["pose"][:, 2]
    own = (heading[:, None] + 60 - 3 * np.arange(40)) % 360 / 359
    found = next_angles(torch.tensor(own[..., None]), -3.0)[..., 0]
    assert set(heading % 360) == set(range(0, 360, 45))
    np.testing.assert_allclose(found, trace["observation"][..., 0], atol=1e-6)


def test_the_command_writes_an_agent_that_plays_as_the_original_did(tmp_path):
    keras_file(tmp_path / "weights.h5")
    out = tmp_path / "original.safetensors"
    assert ImportKeras(tmp_path / "weights.h5", out).run() == 0
    agent = load(out)
    assert (agent.config, agent.name) == (ORIGINAL, "original weights")
    envs = HouseVectorEnv([sample_houses.example()], num_envs=2, preset="paper")
    policy = policy_of(agent.network, agent.config, envs)
    assert isinstance(policy, QPolicy)
    assert (policy.epsilon, policy.homing, policy.forward) == (0.025, True, 0.92)
    policy.begin(2)
    envs.step(policy(torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(2, dtype=torch.bool)).numpy())


def test_random_actions_of_the_original_go_forward_where_a_middle_ray_sees_the_target():
    envs = HouseVectorEnv([sample_houses.example()], num_envs=2, preset="paper")
    policy = policy_of(PaperNetwork.of(ORIGINAL), ORIGINAL, envs)
    assert isinstance(policy, QPolicy)
    policy.epsilon, policy.avoidance = 1.0, Free()
    seen = torch.ones(400, 40, 3)
    seen[..., -1] = 0
    seen[:200, 19, -1] = 1
    seen[200:, 21, -1] = 1
    policy.begin(400)
    forward = policy(seen, torch.zeros(400, dtype=torch.bool)) == 2
    assert forward[:200].all()
    assert 0 < (~forward[200:]).sum() < 60


def test_the_released_weights_do_in_the_papers_house_what_they_did_in_an_exact_twin_of_the_original():
    """It had 9.3 targets an episode in the main room. Here: 16 episodes."""
    envs, agent = make_envs(named("paper-house"), 16, "paper-main", preset="paper"), load("paper-original")
    scores = play(envs, policy_of(agent.network, agent.config, envs), 0, np.zeros(16, int))
    assert 6 < scores.targets.mean() < 13
    assert scores.steps > 0.9 * 16 * envs.config.steps


@pytest.mark.parametrize(
    ("made", "reason"),
    [
        ({"shapes": [(3, 25), (1000, 40), (40, 100), *SHAPES[3:]]}, r"dense_2/kernel:0 is \(1000, 40\)"),
        ({"layers": LAYERS[:-1]}, "10 arrays of weights; the paper's network has 12"),
        (
            {"layers": [*LAYERS, "dense_7"], "shapes": [*SHAPES, (3, 3)]},
            "more arrays of weights; the paper's network has 12",
        ),
        ({"value": np.nan}, "some weights are no finite numbers"),
    ],
    ids=["other shapes", "too few layers", "too many layers", "no numbers"],
)
def test_a_file_of_another_network_is_refused(tmp_path, made, reason):
    keras_file(tmp_path / "weights.h5", **made)
    with pytest.raises(CheckpointError, match=reason):
        import_keras(tmp_path / "weights.h5", "mine")


def test_weights_of_another_file_are_refused(tmp_path):
    keras_file(tmp_path / "other.h5")
    keras_file(tmp_path / "weights.h5")
    layout = h5py.VirtualLayout(shape=(3, 25), dtype="f4")
    layout[...] = h5py.VirtualSource(tmp_path / "other.h5", "model_weights/dense_1/dense_1/kernel:0", (3, 25))
    with h5py.File(tmp_path / "weights.h5", "a") as file:
        group: Any = file["model_weights/dense_1"]
        del group["dense_1/kernel:0"]
        group.create_virtual_dataset("dense_1/kernel:0", layout)
    with pytest.raises(CheckpointError, match="kernel:0 lies in another file"):
        import_keras(tmp_path / "weights.h5", "mine")


def test_a_file_that_is_none_is_refused(tmp_path):
    with pytest.raises(CheckpointError, match="there is no such file"):
        import_keras(tmp_path / "absent.h5", "mine")
    (tmp_path / "text.h5").write_text("no HDF5")
    with pytest.raises(CheckpointError, match="no weights that Keras wrote"):
        import_keras(tmp_path / "text.h5", "mine")
    with h5py.File(tmp_path / "empty.h5", "w"):
        pass
    with pytest.raises(CheckpointError, match="no weights that Keras wrote"):
        import_keras(tmp_path / "empty.h5", "mine")
    with pytest.raises(CheckpointError, match="no weights that Keras wrote"):
        import_keras(tmp_path, "mine")
