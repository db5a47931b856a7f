"""The agents that come with the project, found by name without torch: a wrong name is told at once."""

from pathlib import Path

from agent.algorithms.table import PRESETS
from logic.errors import VitruviusError
from logic.opener import opened
from logic.spelling import unknown

FORMAT = "vitruvius-agent-3"
"""Of checkpoints, which ``agent.runs.checkpoint`` reads and writes."""

MOST_BYTES, MOST_HEADER = 1 << 28, 1 << 20
"""What is read of a checkpoint, and of its header: our networks have less than 1 MiB, their headers 4 KiB."""

LEARNT_IN = "learnt_in"
"""The tensor (H,) int64 beside the network's that names the houses: of many, a header would be too long."""


class CheckpointError(VitruviusError):
    """A checkpoint is absent, is no checkpoint, or holds a network of another shape."""

    exit_code = 5


def released() -> list[str]:
    """Names of the agents that come with the project, trained as their files say."""
    return sorted(path.stem for path in Path(__file__).parent.glob("*.safetensors"))


def located(path: str | Path) -> Path:
    """Where a checkpoint lies: a path, or the name of a released agent.

    Raises ``CheckpointError`` that says what was meant.
    """
    name = str(path)
    if Path(path).exists():
        return Path(path)
    if name in released():
        return Path(__file__).with_name(f"{name}.safetensors")
    if name in PRESETS:
        out = f"runs/{name}"
        raise CheckpointError(
            f"{name}: is a preset of train, and no agent. Train one: "
            f"vitruvius train --preset {name} --out {out}; then it is {out}/agent.safetensors"
        )
    if Path(path).suffix or "/" in name:
        raise CheckpointError(f"{path}: there is no such file. Make one with: vitruvius train")
    raise CheckpointError(f"{path}: there is no such file, and {unknown('agent', name, released())}")


def require_sizes(path: Path) -> None:
    """Raise ``CheckpointError`` for more than is read, ``OSError`` that says more than safetensors's."""
    with opened(path, MOST_BYTES, unpack=False) as file:
        header = int.from_bytes(file.read(8), "little")
    if MOST_HEADER < header < path.stat().st_size:
        raise CheckpointError(
            f"{path}: its header has more than {MOST_HEADER >> 20} MiB: no checkpoint's has"
        )
