"""Processes that learn, forked from one that has imported torch: that alone takes longer than a small run."""

import os
import sys
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.process import BaseProcess
from typing import Any

SERVER = get_context("forkserver")
SERVER.set_forkserver_preload(["torch._dynamo", "agent.evaluation.plots", "agent.runs", "tests.ranks"])


def start(*arguments: object) -> BaseProcess:
    """A process with the command ``vitruvius`` at work, which keeps all after every report."""
    process = SERVER.Process(target=vitruvius, args=list(map(str, arguments)))
    process.start()
    return process


def as_two_ranks(target: Callable[..., Any], *arguments: object) -> list[int | None]:
    """Call this in two processes, as ``torchrun`` starts them; their exit codes."""
    import torch.distributed as dist

    store = dist.TCPStore("localhost", 0, is_master=True, wait_for_workers=False)
    ranks = [
        SERVER.Process(target=_ranked, args=(rank, store.port, target, *map(str, arguments)))
        for rank in range(2)
    ]
    for process in ranks:
        process.start()
    for process in ranks:
        process.join(300)
    return [process.exitcode for process in ranks]


def vitruvius(*arguments: str) -> None:
    """The command, in this process."""
    from agent import cli, runs

    runs.SAVE_EVERY = 0.0
    sys.argv[1:] = arguments
    cli.main()


def _ranked(rank: int, port: int, target: Callable[..., Any], *arguments: str) -> None:
    os.environ |= {"RANK": str(rank), "LOCAL_RANK": str(rank), "WORLD_SIZE": "2", "LOCAL_WORLD_SIZE": "2"}
    os.environ |= {
        "MASTER_ADDR": "localhost",
        "MASTER_PORT": str(port),
        "TORCHELASTIC_USE_AGENT_STORE": "True",
    }
    target(*arguments)
