"""Tasks on a cluster: Ray starts and distributes them, and begins those again whose process or node is lost.

Of Ray this is its core alone: https://docs.ray.io/en/latest/ray-core/walkthrough.html.
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

from logic.errors import Killed, MissingProgram, RequestError, VitruviusError
from logic.terminal import say

Item = TypeVar("Item")
Result = TypeVar("Result")

RETRIES = 5
"""Times that a task is begun again whose process or node is lost."""

AHEAD = 2
"""Tasks for each processor, at work or waiting: none waits for its next one."""

CONNECTS, ANSWERS = 5.0, 15.0
"""Seconds in which a machine must accept a connection, and a cluster must answer."""

STORE = 80 << 20
"""Bytes of shared memory for a cluster here, about the least that Ray takes: what tasks return is small."""

ENVIRONMENT = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_UV_RUN_RUNTIME_ENV": "0"}
"""Ray reports nothing to its makers; under ``uv run`` its workers do not install the project again."""

TRY = """
import sys, ray
try:
    ray.init(sys.argv[1], log_to_driver=False, logging_level="critical")
except Exception as error:
    sys.exit(" ".join(str(error).split()))
"""
"""Connects to a cluster. Where none answers Ray waits for a minute, or ends the process."""


class Returned(NamedTuple, Generic[Result]):
    """What a task brings back."""

    result: Result | None
    error: Exception | None
    warned: list[Warning]
    node: str
    """The address of the machine."""


class Cluster:
    """A cluster that this process is connected to."""

    def __init__(self, address: str | None, workers: int | None) -> None:
        """See ``connected``."""
        self._address, self._most = address, workers if address else None
        self._warned: set[str] = set()

    def each(
        self, function: Callable[[Item], Result], items: Sequence[Item], alone: bool = False
    ) -> Iterator[tuple[int, Result]]:
        """Call a function of a module with each item, in tasks of one processor: the place of an item and
        what came of it, as they are done. A task that is to be ``alone``, for its time, has a whole node, of
        those with the most processors.

        Raises what the function raises, and ``Killed`` where the process or node of a task is lost each time
        that it is begun. What the function warns of is said here, once.
        """
        import ray

        nodes = [int(node["Resources"].get("CPU", 0)) for node in ray.nodes() if node["Alive"]]
        processors = max(1, *nodes) if alone else 1
        task = ray.remote(num_cpus=processors, max_retries=RETRIES)(_called)
        waiting, begun = dict[Any, int](), 0
        while waiting or begun < len(items):
            while begun < len(items) and len(waiting) < self._room():
                waiting[task.remote(function, items[begun])] = begun
                begun += 1
            [done], _ = ray.wait([*waiting])
            yield waiting.pop(done), self._result(done)

    def map(self, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
        """What comes of the items, in their order: see ``each``."""
        return [result for _, result in sorted(self.each(function, items), key=lambda found: found[0])]

    def _room(self) -> int:
        """How many tasks may be at work or wait: machines come and go."""
        import ray

        return self._most or AHEAD * max(1, int(ray.cluster_resources().get("CPU", 0)))

    def _result(self, done: Any) -> Any:
        import ray
        from ray.exceptions import RayError, RayTaskError

        try:
            returned: Returned[Any] = ray.get(done)
        except RayTaskError as error:  # it could not be read there, or what came of it cannot be pickled
            why = _last(str(error))
            raise MissingProgram(
                f"a node cannot run a task or return its result: {why}: see docs/scale.md"
            ) from None
        except RayError as error:
            why = _sentence(str(error))
            raise Killed(f"the process or node of a task was lost {RETRIES + 1} times: {why}") from None
        for each in returned.warned:
            if str(each) not in self._warned:
                self._warned.add(str(each))
                warnings.warn(each, stacklevel=4)
        if returned.error:
            raise _placed(returned.error, f" (node {returned.node})" if self._address else "")
        return returned.result


@contextmanager
def connected(address: str | None = None, workers: int | None = None) -> Iterator[Cluster]:
    """Use the cluster at an address (``HOST:PORT`` of its head, or ``auto`` for that of this machine), with
    at most so many tasks at once. Without an address, one of so many processors, by default all of this
    machine, is started here, and ends with the block.

    Raises ``RequestError`` for what is no address, and ``MissingProgram`` if no cluster answers there.
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
        ray_worker.print_to_stdstream = _Said()  # it would print on the standard output
        try:
            try:
                with chdir(folder):  # the current folder goes before installed packages in all processes
                    ray.init(address or "local", **quiet, **({} if address else own))
            except Exception as error:
                raise MissingProgram(f"Ray does not start: {_last(str(error))}") from error
            finally:
                if threading.current_thread() is threading.main_thread():
                    signal.signal(signal.SIGTERM, ends)  # Ray has put its own in its place
            yield Cluster(address, workers)
        finally:
            ray.shutdown()


def engine(
    name: str | None, address: str | None = None, workers: int | None = None
) -> AbstractContextManager[Cluster | None]:
    """What ``--engine``, ``--address`` and ``--workers`` of a command say: see ``connected``; without an
    engine, None. Raises ``RequestError`` for an address without one.
    """
    if name:
        return connected(address, workers)
    if address is not None:
        raise RequestError("--address: is of --engine ray: add it")
    return nullcontext()


class _Said:
    """What is done with messages of the cluster itself: of each kind the first is said, on stderr."""

    def __init__(self) -> None:
        """Nothing is said yet."""
        self._before: set[str] = set()

    def __call__(self, data: dict[str, Any], **_: Any) -> None:
        """Say lines that have not been said."""
        for line in data["lines"]:
            first = _sentence(line)
            if first not in self._before:
                self._before.add(first)
                say(f"Ray: {first}")


def _require_answer(address: str) -> None:
    """Raise unless a cluster answers: another process tries it."""
    named = re.fullmatch(r"auto|(?!.*://)(.+):(\d+)", address)
    if not named:
        raise RequestError(
            f"--address {address}: name a cluster of Ray as HOST:PORT, or auto for that of here"
        )
    try:
        if named[1]:
            socket.create_connection((named[1].strip("[]"), int(named[2])), CONNECTS).close()
        command = [sys.executable, "-P", "-c", TRY, address]
        tried = subprocess.run(command, capture_output=True, text=True, timeout=ANSWERS, check=False)
        why = (_last(tried.stderr) or f"exit code {tried.returncode}") if tried.returncode else ""
    except (OSError, OverflowError, ValueError) as error:  # the last two: no host or port can be named so
        why = str(getattr(error, "strerror", None) or error)
    except subprocess.TimeoutExpired:
        why = f"none answered in {ANSWERS:g} s"
    if why:
        raise MissingProgram(f"--address {address}: no cluster of Ray to connect to: {why}")


def _called(function: Callable[[Any], Any], item: Any) -> Returned[Any]:
    """What a task runs."""
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
    """An error that a machine is at fault for, with where that is."""
    if isinstance(error, MissingProgram | ModuleNotFoundError):
        return MissingProgram(f"{error}{where}")
    if isinstance(error, OSError) and error.filename:
        error.filename = f"{error.filename}{where}"
    return error


def _sentence(text: str) -> str:
    """The first sentence."""
    return " ".join(text.split()).partition(". ")[0].removesuffix(".")


def _last(text: str) -> str:
    """The last line."""
    return (text.strip().splitlines() or [""])[-1]
