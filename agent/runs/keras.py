"""The original program's weights, from the HDF5 file that Keras wrote, as a checkpoint of ours.

The file is read as arrays: its description of the model is not run, and not needed.
"""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, cast

import h5py
import numpy as np
import torch

from agent.algorithms.paper.config import PaperConfig
from agent.algorithms.paper.learner import PaperNetwork
from agent.algorithms.table import PRESETS
from agent.banks import bank_hash, house_key
from agent.runs.checkpoint import Checkpoint
from agent.runs.hdf5 import at
from agent.runs.released import CheckpointError
from logic.opener import reason, require_file
from sim.environment.arguments import PAPER_HOUSE, house_list

MAX_BYTES = 1 << 28
"""Size of a file."""

ORIGINAL = cast(PaperConfig, PRESETS["paper"])
"""How the original's network reads, plays and learnt, as far as its code and its file say."""


def import_keras(path: str | Path, name: str, command: str = "") -> Checkpoint:
    """A checkpoint of the weights in a Keras file (``model.save`` or ``save_weights``) of the original's
    layers: dense 25 for each ray, flatten, 50, 100, 50, 25, 3.

    Its ``steps`` are 0: the file has the updates of its training, not the steps. Raises ``CheckpointError``
    for a file that is none, of other layers or of other shapes.
    """
    network = PaperNetwork.of(ORIGINAL)
    expected = {key: tuple(value.shape) for key, value in network.named_parameters()}
    try:
        require_file(path, MAX_BYTES)
        with h5py.File(path) as file:
            found = list(islice(_arrays(file), len(expected) + 1))
    except FileNotFoundError:
        raise CheckpointError(f"{path}: there is no such file") from None
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise CheckpointError(f"{path}: no weights that Keras wrote: {reason(error)}") from None
    shapes = [array.shape[::-1] for _, array in found]
    if len(shapes) != len(expected):
        number = f"{len(shapes)}" if len(shapes) < len(expected) else "more"
        raise CheckpointError(f"{path}: {number} arrays of weights; the paper's network has {len(expected)}")
    for (label, _), shape, wanted in zip(found, shapes, expected.values(), strict=True):
        if shape != wanted:
            raise CheckpointError(f"{path}: {label} is {shape[::-1]}; the paper's network has {wanted[::-1]}")
    tensors = {key: torch.from_numpy(array.T.copy()) for key, (_, array) in zip(expected, found, strict=True)}
    network.load_state_dict(tensors, strict=False)
    if not all(value.isfinite().all() for value in tensors.values()):
        raise CheckpointError(f"{path}: some weights are no finite numbers")
    house = house_list(PAPER_HOUSE)  # the program that learns has no other
    learnt_in = frozenset(map(house_key, house))
    return Checkpoint(network.eval(), ORIGINAL, 0, name, bank_hash(house), command, learnt_in)


def _arrays(file: Any) -> Iterator[tuple[str, np.ndarray]]:
    """Each layer's kernel (inputs, outputs) and bias, with its name, in the model's order."""
    layers = at(file, "model_weights") if "model_weights" in file else file
    for layer in layers.attrs["layer_names"]:
        group = at(layers, _text(layer))
        for weight in group.attrs["weight_names"]:
            data = at(group, _text(weight))
            if data.external or data.is_virtual:
                raise ValueError(f"{_text(weight)} lies in another file")
            if data.size > 1_000_000:
                raise ValueError(f"{_text(weight)} has {data.size:,} numbers")
            yield _text(weight), np.asarray(data, np.float32)


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)
