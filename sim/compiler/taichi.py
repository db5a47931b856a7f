"""Taichi, as ``sim.tracing`` and ``sim.runtime`` use it. The one module that imports it.

Of the names that both compilers have: ``ti``, ``core`` and ``impl`` are its modules, ``NAME`` is its own,
``LOCK`` the file in its folder of kernels that a process holds while it writes there, ``Compiled`` a kernel.
"""

import inspect
import os
import textwrap
from collections.abc import Callable, Sequence
from functools import cache, partial
from types import SimpleNamespace
from typing import Any

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# Else Taichi takes the redirection for a notebook's, says so, and wraps each launch to print through it.
os.environ.setdefault("TI_ENABLE_PYBUF", "0")
# Taichi would ask its makers for a newer version once a day, by a name that it keeps for this machine.
os.environ["TI_SKIP_VERSION_CHECK"] = "ON"

import taichi as ti
from taichi._lib import core
from taichi.graph._graph import gen_cpp_kernel
from taichi.lang import _ndarray, impl, kernel_impl, matrix
from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

__all__ = ["LOCK", "NAME", "Compiled", "core", "impl", "program", "read_sources_by", "ti"]

NAME, LOCK = "Taichi", "ticache.lock"


def _once(describe: Callable[[Any, Any], str]) -> Any:
    """Taichi formats the source of every expression that it meets, for errors, each time it is inlined: half
    of the time of tracing. Once is enough.
    """
    known: dict[tuple[Any, ...], str] = {}

    def describe_once(context: Any, node: Any) -> str:
        place = node.lineno, node.col_offset, node.end_lineno, node.end_col_offset
        key = context.file, context.lineno_offset, context.func.func.__name__, *place
        if key not in known:
            known[key] = describe(context, node)
        return known[key]

    return describe_once


ASTTransformerContext.get_pos_info = _once(ASTTransformerContext.get_pos_info)
# Taichi wraps each line of a function, and looks for its file, each time that it inlines it: a fifth of
# tracing.
kernel_impl.textwrap = SimpleNamespace(fill=cache(textwrap.fill), dedent=cache(textwrap.dedent))
_file_of = cache(inspect.getsourcefile)
kernel_impl.getsourcefile = lambda function: _file_of(function.__code__)
# Taichi formats the whole stack for each array that it makes, should that fail: longer than to make it.
_ndarray.get_traceback = matrix.get_traceback = lambda: ""


def program() -> Any:
    """The program that runs in this process, or ``None``."""
    return impl.get_runtime().prog


def read_sources_by(lines_of: Callable[[Any], tuple[list[str], int]]) -> None:
    """Let kernels be read by a function that gives a function's lines, and the number of the first one."""
    kernel_impl.getsourcelines = lines_of


class TaichiKernel:
    """A kernel in a running program, for arrays of certain kinds."""

    def __init__(self, program: Any, kernel: Any, elements: dict[str, Any]) -> None:
        """``elements``: Taichi's type of an element of each argument, in their order."""
        kind = ti.graph.ArgKind.NDARRAY
        symbols = [ti.graph.Arg(kind, name, element, ndim=1) for name, element in elements.items()]
        self.program, self.names = program, list(elements)
        if impl.current_cfg().arch == ti.cuda:  # there a launch would copy host memory: a graph of one node
            builder = ti.graph.GraphBuilder()
            builder.dispatch(kernel, *symbols)
            self.graph = builder.compile()._compiled_graph  # its ``run`` looks at each argument, 5 us in all
            return
        self.kernel = gen_cpp_kernel(kernel, symbols)
        self.code = program.compile_kernel(program.config(), program.get_device_caps(), self.kernel)

    def on_host(self, memory: Sequence[tuple[int, int, int]]) -> Callable[[], None]:
        """What launches it on these addresses, numbers of bytes and of elements, one for each argument."""
        context = self.kernel.make_launch_context()
        for place, (address, size, length) in enumerate(memory):
            context.set_arg_external_array_with_shape((place,), address, size, (length,), 0)
        return partial(self.program.launch_kernel, self.code, context)

    def on_device(self, arrays: Sequence[Any]) -> Callable[[], None]:
        """What launches it on these arrays of the device's memory."""
        given = {name: array.arr for name, array in zip(self.names, arrays, strict=True)}
        return partial(self.graph.jit_run, self.program.config(), given)


Compiled = TaichiKernel
