"""Data-parallel training: several processes train together (``torchrun --nproc-per-node 2 ...``).

Each rank steps its share of the environments and learns from them. An all-reduce sums the gradients of all
ranks before each step of the optimiser, so all ranks have the same weights at all times. Without ``torchrun``
there is one rank, and the functions here do nothing.
"""

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import torch
import torch.distributed as dist
from torch import Tensor, nn

from vitruvius.logic.errors import Killed

LOST = re.compile(r"(closed|reset) by peer|timed out|broken pipe|NETWORK_ERROR", re.IGNORECASE)
"""Messages of gloo if another rank does not answer: gloo has no error class for this."""


@contextmanager
def joined() -> Iterator[None]:
    """Join the ranks that ``torchrun`` started while the block runs; do nothing without ``torchrun``.

    If a machine has processors for all of its ranks, each rank keeps to its own share of them. Call this
    function before Taichi or torch start their threads.
    """
    if "RANK" not in os.environ or dist.is_initialized():
        yield
        return
    _keep_to_own_processors(int(os.environ["LOCAL_RANK"]), int(os.environ["LOCAL_WORLD_SIZE"]))
    # The optimiser imports this module late, and its functions' default arguments then hold the present group
    # for good: gloo's threads outlive the interpreter and may abort the process as it ends
    # (https://github.com/pytorch/pytorch/issues/190489). An early import finds no group to hold.
    import torch.distributed.nn.functional  # noqa: F401

    # gloo also takes tensors of GPUs, and several ranks that share a GPU; NCCL does not.
    dist.init_process_group("gloo")
    try:
        yield
        with _all_there():
            dist.barrier()  # a rank that leaves while others still communicate would end them
    finally:
        dist.destroy_process_group()


def rank() -> int:
    """Return the number of this process among the ranks."""
    return dist.get_rank() if dist.is_initialized() else 0


def size() -> int:
    """Return the number of processes."""
    return dist.get_world_size() if dist.is_initialized() else 1


def total(values: Sequence[float]) -> list[float]:
    """Return the sums over all ranks, the same on each."""
    if size() == 1:
        return list(values)
    sums = torch.tensor(values, dtype=torch.float64)
    with _all_there():
        dist.all_reduce(sums)
    return sums.tolist()


def first(value: float) -> float:
    """Return the first rank's value, on each rank."""
    if size() == 1:
        return value
    given = torch.tensor([value], dtype=torch.float64)
    with _all_there():
        dist.broadcast(given, 0)
    return float(given)


def gathered(value: Any) -> list[Any]:
    """Return all ranks' values on the first rank, an empty list elsewhere; pickle must carry the values."""
    if size() == 1:
        return [value]
    values: list[Any] | None = [None] * size() if rank() == 0 else None
    with _all_there():
        dist.gather_object(value, values)
    return values or []


def all_reduce(values: Tensor) -> None:
    """Replace a tensor by its sum over all ranks, in place."""
    if size() > 1:
        with _all_there():
            dist.all_reduce(values)


def all_reduce_gradients(network: nn.Module) -> None:
    """Replace the gradients of all parameters by their sums over all ranks, in one message."""
    if size() == 1:
        return
    gradients = [p.grad for p in network.parameters() if p.grad is not None]
    flat = torch.cat([gradient.flatten() for gradient in gradients])
    all_reduce(flat)
    for gradient, part in zip(gradients, flat.split([g.numel() for g in gradients]), strict=True):
        gradient.copy_(part.view_as(gradient))


@contextmanager
def _all_there() -> Iterator[None]:
    """Raise ``Killed`` if a rank is lost while others wait for it."""
    try:
        yield
    except RuntimeError as error:
        if not LOST.search(str(error)):
            raise
        raise Killed(
            f"rank {dist.get_rank()} of {dist.get_world_size()} lost contact with another rank, so the run "
            "ends. Restart all ranks with --resume: the run continues from its last report"
        ) from error


def _keep_to_own_processors(local: int, ranks: int) -> None:
    if not hasattr(os, "sched_setaffinity"):
        return
    processors = sorted(os.sched_getaffinity(0))
    if len(processors) >= ranks:
        os.sched_setaffinity(0, processors[local::ranks])
