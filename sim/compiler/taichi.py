"""Interface to Taichi for ``sim.tracing`` and ``sim.runtime``.

Only this module and ``patches`` import Taichi. Both compilers have these names: ``ti``, ``core`` and ``impl``
are modules of the compiler, and ``NAME`` is its name. ``LOCK`` is the file in its cache folder that a process
holds while it writes there. ``Compiled`` is a kernel.
"""

import inspect
import os
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# Else Taichi takes the redirection for a notebook's, prints a message, and wraps each launch to print through
# it.
os.environ.setdefault("TI_ENABLE_PYBUF", "0")
# Taichi would ask its makers once a day for a newer version, with an identifier that it keeps for this
# machine.
os.environ["TI_SKIP_VERSION_CHECK"] = "ON"

# As it is imported, Taichi reads the source around each of its functions, for which Python goes through all
# modules. That is half of the time of the import once torch is there, and finds nothing that it needs.
module_of, inspect.getmodule = inspect.getmodule, lambda *_: None
import taichi as ti

inspect.getmodule = module_of
from taichi._lib import core
from taichi.graph._graph import gen_cpp_kernel
from taichi.lang import impl

from vitruvius.sim.compiler.patches import patch, read_sources_by

__all__ = ["LOCK", "NAME", "Compiled", "core", "impl", "program", "read_sources_by", "ti"]

NAME, LOCK = "Taichi", "ticache.lock"

patch()


def program() -> Any:
    """Return the program that runs in this process, or ``None``."""
    return impl.get_runtime().prog


class TaichiKernel:
    """A kernel in a running program, for arrays of certain kinds."""

    def __init__(self, program: Any, kernel: Any, elements: dict[str, Any]) -> None:
        """Compile the kernel.

        ``elements``: Taichi's element type of each argument, in the order of the arguments.
        """
        kind = ti.graph.ArgKind.NDARRAY
        symbols = [ti.graph.Arg(kind, name, element, ndim=1) for name, element in elements.items()]
        self.program, self.names = program, list(elements)
        if impl.current_cfg().arch == ti.cuda:  # a launch would copy host memory: use a graph of one node
            builder = ti.graph.GraphBuilder()
            builder.dispatch(kernel, *symbols)
            self.graph = builder.compile()._compiled_graph  # its ``run`` checks each argument, 5 us in all
            return
        self.kernel = gen_cpp_kernel(kernel, symbols)
        self.code = program.compile_kernel(program.config(), program.get_device_caps(), self.kernel)

    def on_host(self, memory: Sequence[tuple[int, int, int]]) -> Callable[[], None]:
        """Return a function that launches the kernel on host memory.

        ``memory``: address, number of bytes and number of elements of each argument.
        """
        context = self.kernel.make_launch_context()
        for place, (address, size, length) in enumerate(memory):
            context.set_arg_external_array_with_shape((place,), address, size, (length,), 0)
        return partial(self.program.launch_kernel, self.code, context)

    def on_device(self, arrays: Sequence[Any]) -> Callable[[], None]:
        """Return a function that launches the kernel on these arrays of the device's memory."""
        given = {name: array.arr for name, array in zip(self.names, arrays, strict=True)}
        return partial(self.graph.jit_run, self.program.config(), given)


Compiled = TaichiKernel
