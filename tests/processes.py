"""Processes that are forked from one that has imported torch: the import takes longer than a small run."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.process import BaseProcess

import torch
from torch.distributed import TCPStore  # pyright: ignore[reportPrivateImportUsage]

from tests.programs import PATIENCE

SERVER = get_context("forkserver")
SERVER.set_forkserver_preload(
    [
        "torch._dynamo",
        "torch.utils.tensorboard",
        "vitruvius.agent.evaluation.plots",
        "vitruvius.agent.runs.runs",
        __name__,
    ]
)


def vitruvius(*arguments: str) -> None:
    """Run the command; it saves the run after every report."""
    from vitruvius import cli
    from vitruvius.agent.runs import runs

    runs.SAVE_SECONDS = 0.0
    sys.argv = ["vitruvius", *arguments]
    cli.main()


def start(*arguments: str, job: Callable[..., None] = vitruvius, **environment: str) -> BaseProcess:
    """Start a job in a process of this environment."""
    process = SERVER.Process(target=_work, args=(job, arguments, environment))
    process.start()
    return process


def as_two_ranks(*arguments: str, job: Callable[..., None] = vitruvius) -> list[int | None]:
    """Run two processes in the environment of ``torchrun`` to their ends; return their exit codes."""
    with two_ranks(*arguments, job=job) as ranks:
        for process in ranks:
            process.join(PATIENCE)
        return [process.exitcode for process in ranks]


@contextmanager
def two_ranks(*arguments: str, job: Callable[..., None] = vitruvius) -> Iterator[list[BaseProcess]]:
    """Yield these processes at work."""
    store = TCPStore("localhost", 0, is_master=True, wait_for_workers=False)
    shared = {"WORLD_SIZE": "2", "LOCAL_WORLD_SIZE": "2", "MASTER_ADDR": "localhost"}
    shared |= {"MASTER_PORT": str(store.port), "TORCHELASTIC_USE_AGENT_STORE": "True"}
    yield [start(*arguments, job=job, **shared, RANK=rank, LOCAL_RANK=rank) for rank in "01"]


def _work(job: Callable[..., None], arguments: tuple[str, ...], environment: dict[str, str]) -> None:
    os.environ.update(environment)
    torch.set_num_threads(1)
    job(*arguments)
