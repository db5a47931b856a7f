"""Start of Taichi or of its fork (see ``sim.tracing``), its threads, and the arrays that kernels take.

Taichi prints a greeting on standard output. Standard output belongs to the program that imports this module,
so the greeting is discarded.
"""

import contextlib
import inspect
import io
import os
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vitruvius.sim.huge_pages import ask_for_huge_pages
from vitruvius.sim.tracing import KEEPS_KERNELS, compiler, core, impl, kernel, ti

if TYPE_CHECKING:
    import torch

LOCK_AGE = 60.0
"""Age of a lock that counts as stale, in seconds. Writing the kernels of a process takes less than one
second."""

__all__ = [
    "Array",
    "Bytes",
    "Floats",
    "Ints",
    "Launch",
    "Longs",
    "Shorts",
    "Words",
    "constants",
    "kernel",
    "start",
    "ti",
]


MOST_FIELDS = 500
"""Largest number of fields of a process. Taichi has room for 512, and crashes at the next one."""

_fields = Counter[Any]()
"""Number of fields of each program."""

_stranded = threading.Event()
"""Set in a fork of a process in which Taichi ran, because a fork lacks Taichi's threads."""

os.register_at_fork(after_in_child=lambda: _stranded.set() if compiler.program() else None)


def _require_threads() -> None:
    """Raise ``RuntimeError`` in a fork of a process in which Taichi ran."""
    if _stranded.is_set():
        raise RuntimeError(
            f"{compiler.NAME} ran before this process was forked, and cannot run in it: start processes "
            "by 'spawn', as in "
            'vector_kwargs={"context": "spawn"}; or make one HouseVectorEnv for all environments'
        )


_compiling = threading.RLock()
"""Lock for compiling: Taichi compiles for one thread at a time. Compiled kernels run in any thread, under
Python's own lock."""


class _Owner:
    """The thread that starts the compiler, which is the only thread that can then create fields.

    On the CPU it is a thread of this module, because a caller's thread may end, or wait for another thread
    that needs a field. On a GPU it is the caller's thread: if another thread starts the compiler, the driver
    fails when the process ends.
    """

    def __init__(self, device: str) -> None:
        """Start the thread, which ends with the process."""
        self.pool = ThreadPoolExecutor(1, "taichi") if device == "cpu" else None
        self.caller = threading.current_thread()
        self.program: Any = None

    def call(self, make: Callable[[], Any]) -> Any:
        """Call ``make`` in the thread and return its result."""
        if self.pool:
            return self.pool.submit(make).result()
        if self.caller is not threading.current_thread():
            raise RuntimeError(
                f"{compiler.NAME} was started on the GPU in the thread {self.caller.name}: make environments "
                "there; they step in any thread"
            )
        return make()


_owner: _Owner | None = None


def start(device: str | None = None, threads: int | None = None) -> Any:
    """Start Taichi if it does not run yet, and return its program.

    If Taichi runs already, started here or by the caller, it is left as it is. ``device``: ``cpu`` or
    ``cuda``; by default the device that Taichi runs on, or else the CPU. ``threads``: the largest number of
    worker threads, by default all cores. Environments can be made and stepped in any thread. On a GPU, or
    after the caller's own ``ti.init``, environments must be made in the thread that started Taichi.

    Raises ``ValueError`` if the device is missing or Taichi runs on another one, and ``RuntimeError`` in a
    fork of a process in which Taichi ran.
    """
    global _owner  # noqa: PLW0603 - Taichi has one program a process
    _require_threads()
    with _compiling:
        if compiler.program() is None:
            device = device or "cpu"
            arch = {"cpu": ti.cpu, "cuda": ti.cuda}[device]
            if device == "cuda" and not has_cuda():  # Taichi would use the CPU instead
                raise ValueError(
                    "device 'cuda' cannot be used: no GPU with a CUDA driver was found: use device 'cpu'"
                )
            owner = _Owner(device)
            owner.call(lambda: _begin(arch, threads))
            owner.program = compiler.program()
            _owner = owner
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
    if not KEEPS_KERNELS:  # Taichi aborts at exit if it cannot create its folder: / exists
        options["offline_cache_file_path"] = os.path.abspath(os.sep)
    if KEEPS_KERNELS:
        drop_stale_lock(Path(impl.default_cfg().offline_cache_file_path))
    before = _threads()
    with contextlib.redirect_stdout(io.StringIO()):
        ti.init(**options)
    # This thread alone can do so. Then other threads can compile and launch before any field exists.
    impl.get_runtime().materialize()
    _spread(sorted(_threads() - before), threads)


def constants(values: np.ndarray) -> Any:
    """Return a field with these numbers (n,), or vectors (n, width), for kernels.

    Equal values share one field.

    Raises ``RuntimeError`` for more than ``MOST_FIELDS`` different fields, and on a GPU in any thread other
    than the first that called ``start``.
    """
    with _compiling:
        return _field(compiler.program(), values.dtype.type, values.shape, values.tobytes())


@cache
def _field(program: Any, kind: type[np.generic], shape: tuple[int, ...], content: bytes) -> Any:
    if _fields[program] == MOST_FIELDS:
        raise RuntimeError(
            f"this process has made environments of so many kinds that {compiler.NAME} has no room for more "
            f"({MOST_FIELDS} tables of rays and headings): make these in another process"
        )
    _fields[program] += 1

    def make() -> Any:
        if len(shape) == 1:
            field = ti.field(_TYPES[kind], shape=shape[0])
        else:
            field = ti.Vector.field(shape[1], _TYPES[kind], shape=shape[0])
        field.from_numpy(np.frombuffer(content, kind).reshape(shape).copy())
        return field

    if _owner and _owner.program is program:
        return _owner.call(make)
    return make()


def drop_stale_lock(folder: Path) -> None:
    """Remove the lock of Taichi's kernel cache in a folder, if it is older than ``LOCK_AGE``.

    A process that is killed while it writes its kernels leaves the lock behind. While the lock exists, no
    process reads or writes the cache, so each process compiles all kernels.
    """
    lock = folder / compiler.LOCK
    with contextlib.suppress(FileNotFoundError):
        if time.time() - lock.stat().st_mtime > LOCK_AGE:
            lock.unlink()


def _threads() -> set[int]:
    """Return the ids of this process's threads, or an empty set on a system without ``/proc``."""
    return {int(task.name) for task in Path("/proc/self/task").glob("*")}


def _spread(started: list[int], workers: int | None) -> None:
    """Pin each of Taichi's workers, the last threads that it starts, to its own processor.

    Launches are so short that Linux otherwise leaves all workers on the processor that wakes them. Workers
    are pinned only if there is one for each processor; otherwise programs would crowd on the first
    processors.
    """
    if not started:
        return
    processors = sorted(os.sched_getaffinity(0))
    if 1 < len(processors) == (workers or os.cpu_count()):
        for thread, processor in zip(started[-len(processors) :], processors, strict=False):
            os.sched_setaffinity(thread, {processor})


Bytes, Shorts, Words = (ti.types.ndarray(kind, 1) for kind in (ti.u8, ti.u16, ti.u64))
Ints, Longs, Floats = (ti.types.ndarray(kind, 1) for kind in (ti.i32, ti.i64, ti.f32))
"""Annotations of a kernel's arrays of numbers."""


class Array:
    """Numbers or short vectors in contiguous memory of the device, initially zero.

    Kernels take ``.ndarray``. On the CPU, ``view()`` returns the same memory as a NumPy array.
    """

    def __init__(self, dtype: Any, length: int, width: int = 1) -> None:
        """Allocate ``length`` elements: numbers, or vectors if ``width`` is more than one."""
        self.shape = (length,) if width == 1 else (length, width)
        self.dtype: type = _NUMPY[dtype]
        # Taichi has no empty arrays.
        allotted = max(1, length)
        with _compiling:
            self.ndarray = ti.ndarray(_element(dtype, width), allotted)
        self.on_gpu = on_gpu()  # computed once, because each step copies several arrays
        self._view: np.ndarray | None = None
        if not self.on_gpu:
            ask_for_huge_pages(self.view())

    @classmethod
    def of(cls, values: np.ndarray) -> "Array":
        """Return an array that contains ``values`` (n,)."""
        array = cls(_TYPES[values.dtype.type], len(values))
        array.fill(values)
        return array

    def fill(self, values: np.ndarray) -> None:
        """Copy ``values`` into the array: (length,), or (length, width)."""
        if not self.on_gpu:
            self.view()[:] = values
        elif self.shape[0]:
            self.ndarray.from_numpy(np.ascontiguousarray(values))

    def numpy(self) -> np.ndarray:
        """Return a copy of the contents: (length,), or (length, width)."""
        if self._view is not None:
            return self._view.copy()
        if self.on_gpu:
            return self.ndarray.to_numpy()[: self.shape[0]]
        return self.view().copy()

    def view(self) -> np.ndarray:
        """Return the array's memory as a NumPy array, which keeps the memory alive.

        Raises ``RuntimeError`` on a GPU.
        """
        if self._view is None:
            if self.on_gpu:
                raise RuntimeError("NumPy cannot look into a GPU's memory: take numpy(), a copy, or tensor()")
            interface = self._interface(self.shape, self.dtype)
            self._view = np.asarray(_Memory(self.ndarray, {"__array_interface__": interface}))
        return self._view

    def tensor(self, dtype: type, shape: tuple[int, ...]) -> "torch.Tensor":
        """Return the memory as a tensor of this NumPy type and shape, which keeps the memory alive."""
        import torch

        if not self.on_gpu:
            return torch.from_numpy(self.view().view(dtype).reshape(shape))
        interface = self._interface(shape, dtype)
        return torch.as_tensor(_Memory(self.ndarray, {"__cuda_array_interface__": interface}), device="cuda")

    def _interface(self, shape: tuple[int, ...], dtype: type) -> dict[str, Any]:
        """Return the array interface of the memory, in the form that NumPy and CUDA define."""
        program: Any = compiler.program()
        pointer = program.get_ndarray_data_ptr_as_int(self.ndarray.arr)
        return {"data": (pointer, False), "shape": shape, "typestr": np.dtype(dtype).str, "version": 3}


class _Memory:
    """Object with the array interface that NumPy or torch reads.

    It keeps the memory alive as long as a view of it.
    """

    def __init__(self, owner: Any, interface: dict[str, Any]) -> None:
        self.owner = owner
        self.__dict__.update(interface)


def on_gpu() -> bool:
    """Return True if Taichi runs on a GPU."""
    return impl.current_cfg().arch == ti.cuda


_TYPES = {
    np.float32: ti.f32,
    np.int32: ti.i32,
    np.int64: ti.i64,
    np.int16: ti.i16,
    np.uint8: ti.u8,
    np.uint16: ti.u16,
    np.uint64: ti.u64,
}
_NUMPY = {theirs: ours for ours, theirs in _TYPES.items()}


class Launch:
    """A kernel with its arrays bound.

    On the CPU, the arguments are set once, as host memory. A launch takes 1 us, and 0.2 us for each argument.
    On a GPU, Taichi would copy host memory, so the kernel is a graph of one node whose arguments are set at
    each launch. Such a launch takes about 15 us.
    """

    def __init__(self, kernel: Any, arrays: Mapping[str, Array]) -> None:
        """Bind the arrays, after compiling the kernel for arrays of these kinds if necessary.

        All arguments of the kernel are arrays, with names from ``arrays``.
        """
        _require_threads()  # compiling in such a fork never ends
        self.names = list(inspect.signature(kernel).parameters)
        kinds = tuple((name, arrays[name].dtype, arrays[name].shape[1:]) for name in self.names)
        with _compiling:
            self._made = _compiled(compiler.program(), kernel, kinds)
        self.bind(arrays)

    def bind(self, arrays: Mapping[str, Array]) -> None:
        """Run on these arrays from now on; they must have the same kinds."""
        self._arrays = [arrays[name].ndarray for name in self.names]
        if on_gpu():
            self._run = self._made.on_device(self._arrays)
            return
        views = [arrays[name].view() for name in self.names]
        # Taichi has no empty arrays: their memory has at least one element.
        self._run = self._made.on_host([(v.ctypes.data, v.nbytes, max(1, v.shape[0])) for v in views])

    def __call__(self) -> None:
        """Run the kernel."""
        if _stranded.is_set():
            _require_threads()
        self._run()


Kinds = tuple[tuple[str, type, tuple[int, ...]], ...]
"""Names, types and widths of a kernel's arguments."""


@cache
def _compiled(program: Any, kernel: Any, kinds: Kinds) -> Any:
    """Return the kernel compiled in a running program."""
    return compiler.Compiled(
        program, kernel, {name: _element(_TYPES[dtype], *width) for name, dtype, width in kinds}
    )


def _element(dtype: Any, width: int = 1) -> Any:
    """Return Taichi's type of an array's elements."""
    return dtype if width == 1 else ti.types.vector(width, dtype)
