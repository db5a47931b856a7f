"""Which compiler of kernels runs, and how it reads them: the source of each function once, and records of
arrays.

Taichi does, or what the variable ``VITRUVIUS_RUNTIME`` names: ``taichi`` or ``quadrants``, its maintained
fork. They greet on standard output, which belongs to the program that imports us: the greeting is dropped.
"""

import ast
import contextlib
import importlib.util
import inspect
import io
import os
import textwrap
from collections.abc import Callable
from types import CodeType
from typing import TYPE_CHECKING, Any

from logic.errors import RequestError
from sim import cache

VARIABLE = "VITRUVIUS_RUNTIME"
COMPILERS = "taichi", "quadrants"
KEEPS_KERNELS = cache.provide()
"""Whether what is compiled can be kept on disk for the next process."""

if TYPE_CHECKING:
    import sim.compiler.taichi as compiler
    from sim.compiler.taichi import core, impl, ti


def _named() -> str:
    """The compiler that the variable names, or else the first that is installed.

    Raises ``RequestError`` for another name.
    """
    installed = (name for name in COMPILERS if importlib.util.find_spec(name))
    name = os.environ.get(VARIABLE) or next(installed, COMPILERS[0])
    if name not in COMPILERS:
        raise RequestError(f"{VARIABLE}: there is no {name!r}: take one of {', '.join(COMPILERS)}")
    return name


if not TYPE_CHECKING:
    with contextlib.redirect_stdout(io.StringIO()):
        compiler = importlib.import_module(f"sim.compiler.{_named()}")
    ti, core, impl = compiler.ti, compiler.core, compiler.impl

__all__ = ["KEEPS_KERNELS", "compiler", "core", "impl", "kernel", "ti"]


_sources: dict[CodeType, tuple[list[str], int]] = {}
"""A compiler finds a function's source in its file each time that it inlines it: a quarter of tracing."""


def _source(function: Any) -> tuple[list[str], int]:
    """A function's lines, and the number of the first one."""
    if "__source__" in vars(function):
        return vars(function)["__source__"]
    if function.__code__ not in _sources:
        _sources[function.__code__] = inspect.getsourcelines(function)
    return _sources[function.__code__]


compiler.read_sources_by(_source)


def kernel(function: Callable[..., None]) -> Any:
    """A kernel whose parameters may be records of arrays: a ``NamedTuple`` of its module, whose fields
    are annotated as a kernel's arguments are. Compilers pass arrays one by one, so each field becomes an
    argument by its name, which the function may not assign to, and the record of them is under its own.
    """
    records = {name: kind for name, kind in function.__annotations__.items() if hasattr(kind, "_fields")}
    if records:
        arguments = {}
        for name, kind in function.__annotations__.items():
            arguments |= kind.__annotations__ if name in records else {name: kind}
        lines, first = inspect.getsourcelines(function)
        tree = ast.parse(textwrap.dedent("".join(lines)))
        definition: Any = tree.body[0]
        definition.args.args = [ast.arg(name) for name in arguments]
        made = [f"{name} = ti.static({each.__name__}{each._fields})" for name, each in records.items()]
        definition.body[:0] = ast.parse("\n".join(made).replace("'", "")).body
        # The function's own: the same code may have other records where a function defines it twice.
        vars(function)["__source__"] = ast.unparse(tree).splitlines(keepends=True), first
        named = inspect.Parameter.POSITIONAL_OR_KEYWORD
        parameters = [inspect.Parameter(name, named, annotation=each) for name, each in arguments.items()]
        vars(function)["__signature__"] = inspect.Signature(parameters)
    return ti.kernel(function)
