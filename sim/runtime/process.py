"""Start of the compiler in a process, and the thread that owns it.

Taichi prints a greeting on standard output. Standard output belongs to the program that imports this module,
so the greeting is discarded.
"""

import atexit
import contextlib
import io
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from vitruvius.sim.runtime.forks import compiling, require_threads
from vitruvius.sim.runtime.lock import drop_stale_lock
from vitruvius.sim.runtime.workers import spread, threads_now
from vitruvius.sim.tracing import KEEPS_KERNELS, compiler, core, impl, ti


class Owner:
    """The thread that starts the compiler, which is the only thread that can then create fields.

    On the CPU it is a thread of this module, because a caller's thread may end, or wait for another thread
    that needs a field. On a GPU it is the caller's thread: if another thread starts the compiler, the driver
    fails when the process ends.
    """

    def __init__(self, device: str) -> None:
        """Start the thread, which ends with the process."""
        self.pool = ThreadPoolExecutor(1, "taichi") if device == "cpu" else None
        self.caller = threading.current_thread()

    def call(self, make: Callable[[], Any]) -> Any:
        """Call ``make`` in the thread and return its result."""
        if self.pool:
            return self.pool.submit(make).result()
        if self.caller is not threading.current_thread():
            raise RuntimeError(
                f"{compiler.NAME} was started on the GPU in the thread {self.caller.name}: create "
                "environments in that thread; any thread may step them"
            )
        return make()


_owners: dict[Any, Owner] = {}
"""Owners of the programs that ``start`` began."""


def start(device: str | None = None, threads: int | None = None) -> Any:
    """Start Taichi if it does not run yet, and return its program.

    If Taichi runs already, started here or by the caller, it is left as it is. ``device``: ``cpu`` or
    ``cuda``; by default the device that Taichi runs on, or else the CPU. ``threads``: the largest number of
    worker threads, by default all cores. Environments can be made and stepped in any thread. On a GPU, or
    after the caller's own ``ti.init``, environments must be made in the thread that started Taichi.

    Raises ``ValueError`` if the device is missing or Taichi runs on another one, and ``RuntimeError`` in a
    fork of a process in which Taichi ran.
    """
    require_threads()
    with compiling:
        if compiler.program() is None:
            device = device or "cpu"
            arch = {"cpu": ti.cpu, "cuda": ti.cuda}[device]
            if device == "cuda" and not has_cuda():  # Taichi would use the CPU instead
                raise ValueError(
                    "device 'cuda' cannot be used: no GPU with a CUDA driver was found: use device 'cpu'"
                )
            owner = Owner(device)
            owner.call(lambda: _begin(arch, threads))
            _owners[compiler.program()] = owner
    running = impl.current_cfg().arch
    if device and (running == ti.cuda) != (device == "cuda"):
        names = {ti.x64: "the CPU", ti.arm64: "the CPU", ti.cuda: "a GPU"}
        now = names.get(running, running.name)
        raise ValueError(f"device {device!r} cannot be used: {compiler.NAME} runs on {now} in this process")
    return compiler.program()


def has_cuda() -> bool:
    """Return True if Taichi finds a GPU with a CUDA driver."""
    ti.set_logging_level(ti.ERROR)  # Taichi warns if there is no driver.
    return bool(core.with_cuda())


def _begin(arch: Any, threads: int | None) -> None:
    # Without fast_math, all machines compute the same hits. Taichi's own passes do not help kernels that LLVM
    # optimises again, and take half of the compile time.
    options = {"arch": arch, "fast_math": False, "log_level": ti.ERROR}
    options |= {"advanced_optimization": False, "cfg_optimization": False}
    # Taichi keeps kernels on disk for the next process. Our kernels need more than its default limit of 100
    # MB.
    options |= {"offline_cache": KEEPS_KERNELS, "offline_cache_max_size_of_files": 1 << 30}
    if threads is not None:
        options["cpu_max_num_threads"] = threads
    if not KEEPS_KERNELS:  # Taichi aborts at exit if it cannot create its folder, and / exists
        options["offline_cache_file_path"] = os.path.abspath(os.sep)
    if KEEPS_KERNELS:
        drop_stale_lock(Path(impl.default_cfg().offline_cache_file_path))
    before = threads_now()
    with contextlib.redirect_stdout(io.StringIO()):
        ti.init(**options)
    # Taichi stores kernels as its program ends, which the order in which Python clears modules may prevent.
    atexit.register(ti.reset)
    # Only this thread can materialize. Then other threads can compile and launch before any field exists.
    impl.get_runtime().materialize()
    spread(sorted(threads_now() - before), threads)


def by_owner(program: Any, make: Callable[[], Any]) -> Any:
    """Return the result of ``make``, called in the thread that owns a program that ``start`` began."""
    owner = _owners.get(program)
    return owner.call(make) if owner else make()


def on_gpu() -> bool:
    """Return True if Taichi runs on a GPU."""
    return impl.current_cfg().arch == ti.cuda
