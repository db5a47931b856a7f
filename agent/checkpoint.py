"""Checkpoints: a network with the config that made it, in one file that is whole or absent."""

import io
from dataclasses import asdict, dataclass
from pathlib import Path

import torch

from agent.config import Config
from agent.network import QNetwork
from logic.errors import VitruviusError
from logic.files import write_whole

FORMAT = "vitruvius-agent-1"


class CheckpointError(VitruviusError):
    """A checkpoint is absent, is no checkpoint, or holds a network of another shape."""

    exit_code = 5


@dataclass(frozen=True)
class Checkpoint:
    """A trained network, the config of its run and the steps that it has seen."""

    network: QNetwork
    config: Config
    steps: int


def save(checkpoint: Checkpoint, path: str | Path) -> None:
    """Write the checkpoint beside its place and rename it: a kill leaves the old file or the new one."""
    content = io.BytesIO()
    record = {
        "format": FORMAT,
        "shape": checkpoint.network.shape,
        "config": asdict(checkpoint.config),
        "steps": checkpoint.steps,
        "network": checkpoint.network.state_dict(),
    }
    torch.save(record, content)
    write_whole(path, content.getvalue())


def load(path: str | Path, shape: tuple[int, int] | None = None) -> Checkpoint:
    """Read a checkpoint; ``shape`` is the (rays, channels) of the world that it is to act in.

    Only tensors and plain values are read, never code. Raises ``CheckpointError``.
    """
    try:
        record = torch.load(path, map_location="cpu", weights_only=True)
    except OSError as error:
        raise CheckpointError(f"{path}: cannot be read: {error.strerror or error}") from None
    except Exception:  # torch raises many kinds for bytes that it did not write
        raise CheckpointError(f"{path}: not a checkpoint. Make one with: vitruvius train") from None
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise CheckpointError(
            f"{path}: not a checkpoint of this version ({FORMAT}). Train anew: vitruvius train"
        )
    try:
        rays, channels, half_lives, *features = record["shape"]
        network = QNetwork(rays, channels, tuple(half_lives), *features)
        network.load_state_dict(record["network"])
        checkpoint = Checkpoint(network.eval(), Config(**record["config"]), int(record["steps"]))
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = str(error).splitlines()[0]
        raise CheckpointError(f"{path}: a checkpoint of another shape: {reason}. Train anew") from None
    if shape is not None and (rays, channels) != shape:
        raise CheckpointError(
            f"{path}: the network reads {rays} rays x {channels}, this world gives {shape[0]} x {shape[1]}"
        )
    return checkpoint
