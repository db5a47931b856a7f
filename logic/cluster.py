"""Tasks on a cluster: Ray starts and distributes the tasks, and restarts tasks whose process or node is lost.

This module uses only the core of Ray: https://docs.ray.io/en/latest/ray-core/walkthrough.html.
"""

import os
import re
import secrets
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, chdir, contextmanager, nullcontext
from typing import Any, Generic, NamedTuple, TypeVar

from vitruvius.logic.errors import Killed, MissingProgram, RequestError, VitruviusError
from vitruvius.logic.terminal import say

Item = TypeVar("Item")
Result = TypeVar("Result")

MAX_RETRIES = 5
"""Number of times that Ray restarts a task after its process or node is lost."""

TASKS_PER_PROCESSOR = 2
"""Number of running or queued tasks per processor, enough that no processor waits for its next task."""

CONNECTS, ANSWERS = 5.0, 15.0
"""Timeouts in seconds: for a machine to accept a connection, and for a cluster to answer."""

STORE = 80 << 20
"""Bytes of shared memory of a local cluster, about Ray's minimum, since the results of tasks are small."""

ENVIRONMENT = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_UV_RUN_RUNTIME_ENV": "0"}
"""Settings that turn off Ray's usage reports and its installation of the project under ``uv run``."""

TRY = """
import sys, ray
try:
    ray.init(sys.argv[1], log_to_driver=False, logging_level="critical")
except Exception as error:
    sys.exit(" ".join(str(error).split()))
"""
"""Program that connects to a cluster. If no cluster answers, Ray waits for a minute or ends the process."""


class Returned(NamedTuple, Generic[Result]):
    """Result of a task."""

    result: Result | None
    error: Exception | None
    warned: list[Warning]
    node: str
    """Address of the machine."""


class Cluster:
    """Cluster that this process is connected to."""

    def __init__(self, address: str | None, workers: int | None) -> None:
        """See ``connected``."""
        self._address, self._most = address, workers if address else None
        self._warned: set[str] = set()

    def each(
        self, function: Callable[[Item], Result], items: Sequence[Item], alone: bool = False
    ) -> Iterator[tuple[int, Result]]:
        """Call a function of a module with each item.

        Yield the index and the result of each item as it is done.

        Each task has one processor. With ``alone`` each task has a whole node for as long as it runs, one of
        the nodes with the most processors.

        Raises the errors of the function, and ``Killed`` if Ray loses the process or node of a task at every
        retry. Each warning of the function is given once in this process.
        """
        import ray

        nodes = [int(node["Resources"].get("CPU", 0)) for node in ray.nodes() if node["Alive"]]
        processors = max(1, *nodes) if alone else 1
        task = ray.remote(num_cpus=processors, max_retries=MAX_RETRIES)(_called)
        waiting, begun = dict[Any, int](), 0
        while waiting or begun < len(items):
            while begun < len(items) and len(waiting) < self._room():
                waiting[task.remote(function, items[begun])] = begun
                begun += 1
            [done], _ = ray.wait([*waiting])
            yield waiting.pop(done), self._result(done)

    def map(self, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
        """Return the results of all items, in the order of the items: see ``each``."""
        return [result for _, result in sorted(self.each(function, items), key=lambda found: found[0])]

    def _room(self) -> int:
        """Return the number of tasks that may run or wait now, since machines join and leave the cluster."""
        import ray

        return self._most or TASKS_PER_PROCESSOR * max(1, int(ray.cluster_resources().get("CPU", 0)))

    def _result(self, done: Any) -> Any:
        import ray
        from ray.exceptions import RayError, RayTaskError

        try:
            returned: Returned[Any] = ray.get(done)
        except RayTaskError as error:  # the node cannot read the task, or cannot pickle its result
            why = _last(str(error))
            raise MissingProgram(
                f"a node cannot run a task or return its result: {why}: see docs/scale.md"
            ) from None
        except RayError as error:
            why = _sentence(str(error))
            raise Killed(f"the process or node of a task was lost {MAX_RETRIES + 1} times: {why}") from None
        for each in returned.warned:
            if str(each) not in self._warned:
                self._warned.add(str(each))
                warnings.warn(each, stacklevel=4)
        if returned.error:
            raise _placed(returned.error, f" (node {returned.node})" if self._address else "")
        return returned.result


@contextmanager
def connected(address: str | None = None, workers: int | None = None) -> Iterator[Cluster]:
    """Use the cluster at an address, with at most ``workers`` tasks at once.

    The address is ``HOST:PORT`` of the cluster's head, or ``auto`` for the cluster of this machine. Without
    an address, a cluster of ``workers`` processors (default: all of this machine) starts here and ends with
    the block.

    Raises ``RequestError`` for a malformed address, and ``MissingProgram`` if no cluster answers there.
    """
    os.environ.update(ENVIRONMENT)
    import ray
    from ray._private import ray_constants
    from ray._private import worker as ray_worker

    if address:
        _require_answer(address)
    else:  # The cluster listens on this machine alone, and answers only clients that know the token.
        os.environ["RAY_AUTH_TOKEN"] = secrets.token_hex(32)
        ray_constants.ENABLE_RAY_CLUSTER = False  # else Ray replaces 127.0.0.1
    ends = signal.getsignal(signal.SIGTERM)
    with tempfile.TemporaryDirectory(prefix="ray-", ignore_cleanup_errors=True) as folder:
        own: dict[str, Any] = {
            "num_cpus": workers,
            "include_dashboard": False,
            "object_store_memory": STORE,
            "_node_ip_address": "127.0.0.1",
            "_temp_dir": folder,
        }
        quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "error"}
        ray_worker.print_to_stdstream = _Said()  # Ray would print on the standard output
        try:
            try:
                with chdir(folder):  # the current folder precedes installed packages in all processes
                    ray.init(address or "local", **quiet, **({} if address else own))
            except Exception as error:
                raise MissingProgram(f"Ray does not start: {_last(str(error))}") from error
            finally:
                if threading.current_thread() is threading.main_thread():
                    signal.signal(signal.SIGTERM, ends)  # Ray replaced the handler
            yield Cluster(address, workers)
        finally:
            ray.shutdown()


def engine(
    name: str | None, address: str | None = None, workers: int | None = None
) -> AbstractContextManager[Cluster | None]:
    """Return the cluster for ``--engine``, ``--address`` and ``--workers``, or None without an engine.

    Raises ``RequestError`` for an address without an engine. See ``connected``.
    """
    if name:
        return connected(address, workers)
    if address is not None:
        raise RequestError("--address needs --engine ray: add it")
    return nullcontext()


class _Said:
    """Handler of Ray's own messages, which prints the first message of each kind on stderr."""

    def __init__(self) -> None:
        """Begin with no printed messages."""
        self._before: set[str] = set()

    def __call__(self, data: dict[str, Any], **_: Any) -> None:
        """Print the lines that have not been printed."""
        for line in data["lines"]:
            first = _sentence(line)
            if first not in self._before:
                self._before.add(first)
                say(f"Ray: {first}")


def _require_answer(address: str) -> None:
    """Raise ``RequestError`` or ``MissingProgram`` unless a cluster answers.

    Another process connects to it.
    """
    named = re.fullmatch(r"auto|(?!.*://)(.+):(\d+)", address)
    if not named:
        raise RequestError(
            f"--address {address}: name a Ray cluster as HOST:PORT, or auto for the one on this machine"
        )
    try:
        if named[1]:
            socket.create_connection((named[1].strip("[]"), int(named[2])), CONNECTS).close()
        command = [sys.executable, "-P", "-c", TRY, address]
        tried = subprocess.run(command, capture_output=True, text=True, timeout=ANSWERS, check=False)
        why = (_last(tried.stderr) or f"exit code {tried.returncode}") if tried.returncode else ""
    except (OSError, OverflowError, ValueError) as error:  # the last two: the host or the port is impossible
        why = str(getattr(error, "strerror", None) or error)
    except subprocess.TimeoutExpired:
        why = f"none answered in {ANSWERS:g} s"
    if why:
        raise MissingProgram(f"--address {address}: cannot connect to a Ray cluster: {why}")


def _called(function: Callable[[Any], Any], item: Any) -> Returned[Any]:
    """Run a function in a task. Return its result or its error, and its warnings."""
    import ray

    result = error = None
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            result = function(item)
        except Exception as raised:
            error = raised
            if not isinstance(error, VitruviusError):
                error.add_note(traceback.format_exc())
    said = [each.message for each in warned if isinstance(each.message, Warning)]
    return Returned(result, error, said, ray.util.get_node_ip_address())


def _placed(error: Exception, where: str) -> Exception:
    """Return an error with ``where`` added, if a machine is at fault for the error."""
    if isinstance(error, MissingProgram | ModuleNotFoundError):
        return MissingProgram(f"{error}{where}")
    if isinstance(error, OSError) and error.filename:
        error.filename = f"{error.filename}{where}"
    return error


def _sentence(text: str) -> str:
    """Return the first sentence of a text."""
    return " ".join(text.split()).partition(". ")[0].removesuffix(".")


def _last(text: str) -> str:
    """Return the last line of a text."""
    return (text.strip().splitlines() or [""])[-1]
