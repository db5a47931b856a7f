"""Agents that come with the project, found by name without torch, so that a wrong name fails at once."""

from pathlib import Path

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.opener import opened
from vitruvius.logic.spelling import unknown

FORMAT = "vitruvius-agent-3"
"""Format of checkpoints, which ``agent.runs.checkpoint`` reads and writes."""

MAX_BYTES, MAX_HEADER_BYTES = 1 << 28, 1 << 20
"""Largest size of a checkpoint and of its header, in bytes: ours have less than 1 MiB, headers of 4 KiB."""

LEARNT_IN = "learnt_in"
"""Name of the tensor (H,) int64 of the training houses. A header with many houses would be too long."""


class CheckpointError(VitruviusError):
    """Error for a checkpoint that is absent, malformed, or holds a network of another shape."""

    exit_code = 5


def released() -> list[str]:
    """Return the names of the agents that come with the project."""
    return sorted(path.stem for path in Path(__file__).parent.glob("*.safetensors"))


def located(path: str | Path) -> Path:
    """Return the path of a checkpoint, given as a path or as the name of a released agent.

    Raises ``CheckpointError`` that suggests what was meant.
    """
    name = str(path)
    if Path(path).exists():
        return Path(path)
    if name in released():
        return Path(__file__).with_name(f"{name}.safetensors")
    if name in PRESETS:
        out = f"runs/{name}"
        raise CheckpointError(
            f"{name}: is a preset of train, not an agent. Train one: vitruvius train --preset {name} --out "
            f"{out}; then it is {out}/agent.safetensors"
        )
    if Path(path).suffix or "/" in name:
        raise CheckpointError(f"{path}: there is no such file. Make one with: vitruvius train")
    raise CheckpointError(f"{path}: there is no such file, and {unknown('agent', name, released())}")


def require_sizes(path: Path) -> None:
    """Raise ``CheckpointError`` for a file above the limits, and ``OSError`` clearer than safetensors's."""
    with opened(path, MAX_BYTES, unpack=False) as file:
        header = int.from_bytes(file.read(8), "little")
    if MAX_HEADER_BYTES < header < path.stat().st_size:
        raise CheckpointError(
            f"{path}: not a checkpoint: its header has more than {MAX_HEADER_BYTES >> 20} MiB"
        )
