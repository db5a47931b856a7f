"""Interface to Quadrants, the maintained fork of Taichi, for ``sim.tracing`` and ``sim.runtime``.

This is the only module that imports Quadrants. It has the same names as ``sim.compiler.taichi``, which
explains them.
"""

import os
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

os.environ.setdefault("QD_ENABLE_PYBUF", "0")  # else Quadrants takes a redirection for a notebook's

import quadrants as ti
from quadrants._lib import core
from quadrants.lang import _ndarray, _wrap_inspect, impl, matrix
from quadrants.lang._quadrants_callable import BoundQuadrantsCallable, QuadrantsCallable

__all__ = ["LOCK", "NAME", "Compiled", "core", "impl", "program", "read_sources_by", "ti"]

NAME, LOCK = "Quadrants", "qdcache.lock"

_ndarray.get_traceback = matrix.get_traceback = lambda: ""


def _bound(self: QuadrantsCallable, instance: Any, owner: Any) -> Any:
    """Bind a method without storing it in the object.

    The method of Quadrants stores the bound method among the object's attributes, so that the object cannot
    be pickled.
    """
    return self if instance is None else BoundQuadrantsCallable(instance, self)


QuadrantsCallable.__get__ = _bound


def program() -> Any:
    """Return the program that runs in this process, or ``None``."""
    return impl.get_runtime()._prog


def read_sources_by(lines_of: Callable[[Any], tuple[list[str], int]]) -> None:
    """Let Quadrants read source code with ``lines_of``.

    ``lines_of`` returns a function's lines, and the number of its first line.
    """
    _wrap_inspect.getsourcelines = lines_of


class QuadrantsKernel:
    """A kernel in a running program, for arrays of certain kinds."""

    def __init__(self, program: Any, kernel: Any, elements: dict[str, Any]) -> None:
        """Compile the kernel.

        ``elements``: the element type of each argument, in the order of the arguments.
        """
        primal = kernel._primal
        primal.raise_on_templated_floats = impl.current_cfg().raise_on_templated_floats  # as a call does
        # Quadrants has no arguments without memory. These arrays tell it the kinds, and are then dropped.
        key = primal.ensure_compiled(*(ti.ndarray(element, 1) for element in elements.values()))
        self.program, self.kernel = program, primal.materialized_kernels[key]
        made = program.compile_kernel(program.config(), program.get_device_caps(), self.kernel)
        self.code = made.compiled_kernel_data

    def on_host(self, memory: Sequence[tuple[int, int, int]]) -> Callable[[], None]:
        """Return a function that launches the kernel on host memory.

        ``memory``: address, number of bytes and number of elements of each argument.
        """
        context = self.kernel.make_launch_context()
        for place, (address, size, length) in enumerate(memory):
            context.set_arg_external_array_with_shape(place, address, size, (length,), 0)
        return partial(self.program.launch_kernel, self.code, context)

    def on_device(self, arrays: Sequence[Any]) -> Callable[[], None]:
        """Return a function that launches the kernel on these arrays of the device's memory."""
        context = self.kernel.make_launch_context()
        for place, array in enumerate(arrays):
            context.set_arg_ndarray(place, array.arr)
        return partial(self.program.launch_kernel, self.code, context)


Compiled = QuadrantsKernel
