"""Checkpoints: a network with the config that made it, in one safetensors file that is whole or absent."""

import json
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import msgspec
import safetensors
import safetensors.torch
import torch

from vitruvius.agent.algorithms.build import network_of
from vitruvius.agent.algorithms.table import ALGORITHMS
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.runs.released import FORMAT, LEARNT_IN, CheckpointError, located, require_sizes
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.spelling import printable

MAX_LEARNT_HOUSES = 1 << 20
"""Largest number of houses that a checkpoint names; a house file holds at most the same number."""


@dataclass(frozen=True)
class Checkpoint:
    """Trained network, with the config of its run, the number of its training steps, and its origin."""

    network: Any
    config: TrainConfig
    steps: int
    name: str = "agent"
    """Name of the agent: the preset's name."""
    houses: str = ""
    """``agent.banks.bank_hash`` of the training houses."""
    command: str = ""
    """Command that made the checkpoint."""
    learnt_in: frozenset[int] = frozenset()
    """``agent.banks.house_key`` of each training house; empty if the houses are not known."""


def save(checkpoint: Checkpoint, path: str | Path) -> None:
    """Write the checkpoint next to its place and rename it: a kill leaves the old file or the new one."""
    record = {
        "format": FORMAT,
        "algorithm": checkpoint.config.algorithm,
        "config": json.dumps(asdict(checkpoint.config)),
        "steps": str(checkpoint.steps),
        "name": checkpoint.name,
        "houses": checkpoint.houses,
        "command": checkpoint.command,
    }
    tensors = {name: value.cpu().contiguous() for name, value in checkpoint.network.state_dict().items()}
    if checkpoint.learnt_in:
        tensors[LEARNT_IN] = torch.tensor(sorted(checkpoint.learnt_in), dtype=torch.int64)
    write_whole(path, safetensors.torch.save(tensors, metadata=record))


def load(path: str | Path) -> Checkpoint:
    """Read a checkpoint, which holds tensors and text, never code.

    ``path`` may be the name of a released agent. Raises ``CheckpointError``.
    """
    path = located(path)
    if path.is_dir():
        hint = f": did you mean {run}?" if (run := path / "agent.safetensors").exists() else ""
        raise CheckpointError(f"{path}: is a folder, not an agent{hint}")
    try:
        require_sizes(path)
        with safetensors.safe_open(path, framework="pt") as file:
            record = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except OSError as error:
        raise CheckpointError(f"{path}: cannot be read: {error.strerror or error}") from None
    except safetensors.SafetensorError:
        raise CheckpointError(f"{path}: not a checkpoint. Make one with: vitruvius train") from None
    if record.get("format") != FORMAT:
        raise CheckpointError(
            f"{path}: not a checkpoint of this version ({FORMAT}). Train again: vitruvius train"
        )
    try:
        config = config_of(record["algorithm"], json.loads(record["config"]))
        try:
            network = network_of(config)
        except RequestError as error:  # a user-defined module, which no file may name
            raise CheckpointError(f"{path}: {error}") from None
        learnt_in = _keys(tensors.pop(LEARNT_IN, None))
        network.load_state_dict(tensors)
        if not all(value.isfinite().all() for value in network.state_dict().values()):
            raise ValueError("some weights are not finite numbers")
        provenance = {name: printable(record[name]) for name in ("name", "houses", "command")}
        steps = int(record["steps"])
        return Checkpoint(network.eval(), config, steps, **provenance, learnt_in=learnt_in)
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise CheckpointError(
            f"{path}: the checkpoint does not fit this network: {reason}. Train again"
        ) from None


def _keys(tensor: torch.Tensor | None) -> frozenset[int]:
    """Return the houses that a file names. Raises ``ValueError`` for a malformed tensor."""
    if tensor is None:
        return frozenset()
    if tensor.dtype != torch.int64 or tensor.ndim != 1 or len(tensor) > MAX_LEARNT_HOUSES:
        raise ValueError(
            f"{LEARNT_IN} must be at most {MAX_LEARNT_HOUSES:,} 64-bit numbers, one for each house"
        )
    return frozenset(tensor.tolist())


def config_of(algorithm: str, values: dict[str, Any]) -> TrainConfig:
    """Return a config from its JSON values. Raises ``ValueError`` that names the wrong value."""
    if algorithm not in ALGORITHMS:
        raise ValueError(f"unknown algorithm {algorithm!r}")
    kind = ALGORITHMS[algorithm].config
    if unknown := set(values) - {field.name for field in fields(kind)}:
        raise ValueError(f"unknown field {min(unknown)!r}")
    return msgspec.convert(values, kind)
