"""Kernels with their arrays bound, which are launched at each step."""

import inspect
from collections.abc import Mapping
from functools import cache
from typing import Any

from vitruvius.sim.runtime.arrays import TYPES, Array, element
from vitruvius.sim.runtime.forks import compiling, require_threads, stranded
from vitruvius.sim.runtime.process import on_gpu
from vitruvius.sim.tracing import compiler


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
        require_threads()  # compiling in such a fork never ends
        self.names = list(inspect.signature(kernel).parameters)
        kinds = tuple((name, arrays[name].dtype, arrays[name].shape[1:]) for name in self.names)
        with compiling:
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
        if stranded.is_set():
            require_threads()
        self._run()


Kinds = tuple[tuple[str, type, tuple[int, ...]], ...]
"""Names, types and widths of a kernel's arguments."""


@cache
def _compiled(program: Any, kernel: Any, kinds: Kinds) -> Any:
    """Return the kernel compiled in a running program."""
    return compiler.Compiled(
        program, kernel, {name: element(TYPES[dtype], *width) for name, dtype, width in kinds}
    )
