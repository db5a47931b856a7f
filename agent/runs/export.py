"""Export for other runtimes: one ONNX file, a pure function of the observation and the memory.

| input | shape | |
|---|---|---|
| ``observation`` | (B, R, C) float32 | distance / range, is target |
| ``memory`` | (B, M, S) float32 | averages of S signals (recurrent: (B, H)); zeros as an episode begins |
| ``blocked`` | (B,) bool | true if the last move was blocked |

| output | shape | |
|---|---|---|
| ``q`` | (B, A) float32 | value of each action, in discounted targets |
| ``memories`` | (B, A, M, S) float32 | next memory after each possible action |

Layers above the network, such as the shield, choose the action. So ``memories`` has one for each action, and
the caller takes that of the action made. Nothing is kept between two calls.
"""

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.files.writing import write_whole

INPUTS, OUTPUTS = ("observation", "memory", "blocked"), ("q", "memories")


class NoExporter(VitruviusError):
    """Error for missing packages that write ONNX files."""

    exit_code = 69


class ExportedStep(nn.Module):
    """Network with its memory, as the one function that is exported."""

    def __init__(self, network: Any) -> None:
        super().__init__()
        self.network = network

    def forward(self, observation: Tensor, memory: Tensor, blocked: Tensor) -> tuple[Tensor, Tensor]:
        """Return Q-values (B, A), and the memory (B, A, ...) after each action; for the inputs see above."""
        same = torch.zeros_like(blocked)
        each = [torch.full_like(blocked, action, dtype=torch.int64) for action in range(self.network.actions)]
        memories = [self.network.memory(memory, observation, blocked, action, same) for action in each]
        return self.network(observation, memory), torch.stack(memories, dim=1)

    def example(self, size: int, seed: int = 0) -> tuple[Tensor, ...]:
        """Return random inputs for a batch of ``size``, in the order of ``forward``."""
        generator = torch.Generator().manual_seed(seed)
        rays, channels, _ = self.network.shape
        kept = tuple(self.network.memory.empty(1).shape[1:])
        shapes = [(rays, channels), kept, ()]
        observation, memory, blocked = (torch.rand(size, *shape, generator=generator) for shape in shapes)
        observation[..., -1].round_()
        return observation, memory, blocked < 0.5


def export(network: Any, path: str | Path) -> None:
    """Write the network with its memory to an ONNX file, whole or not at all, for batches of any size.

    Raises ``RequestError`` for a network that works on a planner's map, such as map completion. Raises
    ``NoExporter`` if the packages ``onnx`` and ``onnxscript`` are missing.
    """
    if not hasattr(network, "memory"):
        raise RequestError(
            "only a Q-network over moves can be exported: this network needs the planner's whole map"
        )
    step = ExportedStep(network).eval()
    batch = torch.export.Dim("batch")
    try:
        with _quiet():
            program = torch.onnx.export(
                step,
                step.example(2),  # two: torch would take an axis of length one for a constant
                input_names=INPUTS,
                output_names=OUTPUTS,
                dynamic_shapes={name: {0: batch} for name in INPUTS},
                verbose=False,
            )
    except ImportError as error:
        raise NoExporter(f"ONNX needs the package {error.name}. Try: pip install onnx onnxscript") from None
    assert program is not None
    write_whole(path, program.model_proto.SerializeToString())


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence the exporter's remarks on packages and axes, which do not matter here."""
    before = logging.root.manager.disable
    logging.disable(logging.WARNING)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)
