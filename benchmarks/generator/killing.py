"""Processes that ``vitruvius bench shards`` kills: the command, its workers, and nodes of a cluster."""

import os
import random
import secrets
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from vitruvius.logic.cluster import ENVIRONMENT, STORE


class Plain:
    """The command without an engine."""

    kinds: tuple[str, ...] = ("driver", "worker")
    """Kinds of processes to kill; ``driver`` is the command itself."""

    words: tuple[str, ...] = ()
    """Arguments of the command in addition to its request."""

    def kill(self, kind: str, driver: int, moments: random.Random) -> bool:
        """Kill a process of a kind by SIGKILL, and return True if there was one.

        ``driver`` is the command's process.
        """
        found = [driver] if kind == "driver" else self._workers(driver)
        return bool(found) and _killed(moments.choice(found))

    def _workers(self, driver: int) -> list[int]:
        return below(driver)


class OnRay(Plain):
    """The command with a local cluster of nodes of one processor each; its head makes no houses."""

    kinds = ("driver", "worker", "raylet")

    def __init__(self, cluster: Any, nodes: int) -> None:
        """Use a cluster of ``ray.cluster_utils``, with ``nodes`` nodes."""
        self._cluster = cluster
        self._nodes = [self._node() for _ in range(nodes)]
        self.words = ("--engine", "ray", "--address", cluster.address)

    def kill(self, kind: str, driver: int, moments: random.Random) -> bool:
        """Kill a process of a kind. A raylet takes the tasks of its node with it, and a new node joins."""
        if kind != "raylet":
            return super().kill(kind, driver, moments)
        node = self._nodes.pop(moments.randrange(len(self._nodes)))
        _killed(_raylet(node))
        self._cluster.remove_node(node, allow_graceful=False)
        self._nodes.append(self._node())
        return True

    def _node(self) -> Any:
        return self._cluster.add_node(num_cpus=1, object_store_memory=STORE)

    def _workers(self, driver: int) -> list[int]:
        """Return the processes of tasks, and the solver processes that they have started."""
        tasks = [each for node in self._nodes for each in below(_raylet(node)) if "_called" in _command(each)]
        return [each for task in tasks for each in (task, *below(task))]


@contextmanager
def victims(engine: str | None, workers: int) -> Iterator[Plain]:
    """Yield the processes to kill while ``workers`` processes make houses, with or without Ray."""
    if engine is None:
        yield Plain()
        return
    os.environ.update(ENVIRONMENT, RAY_AUTH_TOKEN=secrets.token_hex(32))
    from ray.cluster_utils import Cluster

    head = {"num_cpus": 0, "object_store_memory": STORE, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=head)
    try:
        yield OnRay(cluster, workers)
    finally:
        cluster.shutdown()


def below(process: int) -> list[int]:
    """Return the descendants of a process."""
    children = dict[int, list[int]]()
    for each in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((each / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:  # the process has ended
            continue
        children.setdefault(parent, []).append(int(each.name))
    found = children.get(process, [])
    for each in found:
        found += children.get(each, [])
    return found


def _command(process: int) -> str:
    try:
        return Path(f"/proc/{process}/cmdline").read_text()
    except OSError:
        return ""


def _raylet(node: Any) -> int:
    [raylet] = node.all_processes["raylet"]
    return raylet.process.pid


def _killed(process: int) -> bool:
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return False
    return True
