"""Quadrants, the maintained fork of Taichi, as ``sim.tracing`` and ``sim.runtime`` use it: see
``sim.compiler.taichi``, whose names are here too. The one module that imports it.
"""

import os
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

os.environ.setdefault("QD_ENABLE_PYBUF", "0")  # else it takes a redirection for a notebook's

import quadrants as ti
from quadrants._lib import core
from quadrants.lang import _ndarray, _wrap_inspect, impl, matrix
from quadrants.lang._quadrants_callable import BoundQuadrantsCallable, QuadrantsCallable

__all__ = ["LOCK", "NAME", "Compiled", "core", "impl", "program", "read_sources_by", "ti"]

NAME, LOCK = "Quadrants", "qdcache.lock"

_ndarray.get_traceback = matrix.get_traceback = lambda: ""


def _bound(self: QuadrantsCallable, instance: Any, owner: Any) -> Any:
    """Its own leaves what is bound among the attributes of the object, which then cannot be pickled."""
    return self if instance is None else BoundQuadrantsCallable(instance, self)


QuadrantsCallable.__get__ = _bound


def program() -> Any:
    """The program that runs in this process, or ``None``."""
    return impl.get_runtime()._prog


def read_sources_by(lines_of: Callable[[Any], tuple[list[str], int]]) -> None:
    """Let kernels be read by a function that gives a function's lines, and the number of the first one."""
    _wrap_inspect.getsourcelines = lines_of


class QuadrantsKernel:
    """A kernel in a running program, for arrays of certain kinds."""

    def __init__(self, program: Any, kernel: Any, elements: dict[str, Any]) -> None:
        """``elements``: the type of an element of each argument, in their order."""
        primal = kernel._primal
        primal.raise_on_templated_floats = impl.current_cfg().raise_on_templated_floats  # as a call does
        # It has no arguments without memory. These say of which kind the arrays are, and are dropped.
        key = primal.ensure_compiled(*(ti.ndarray(element, 1) for element in elements.values()))
        self.program, self.kernel = program, primal.materialized_kernels[key]
        made = program.compile_kernel(program.config(), program.get_device_caps(), self.kernel)
        self.code = made.compiled_kernel_data

    def on_host(self, memory: Sequence[tuple[int, int, int]]) -> Callable[[], None]:
        """What launches it on these addresses, numbers of bytes and of elements, one for each argument."""
        context = self.kernel.make_launch_context()
        for place, (address, size, length) in enumerate(memory):
            context.set_arg_external_array_with_shape(place, address, size, (length,), 0)
        return partial(self.program.launch_kernel, self.code, context)

    def on_device(self, arrays: Sequence[Any]) -> Callable[[], None]:
        """What launches it on these arrays of the device's memory."""
        context = self.kernel.make_launch_context()
        for place, array in enumerate(arrays):
            context.set_arg_ndarray(place, array.arr)
        return partial(self.program.launch_kernel, self.code, context)


Compiled = QuadrantsKernel
