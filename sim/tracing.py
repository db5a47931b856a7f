"""The one place that imports Taichi, so that a maintained fork can take its place here; and how it reads
kernels: the source of each function once, and records of arrays.

Taichi greets on standard output, which belongs to the program that imports us: the greeting is dropped.
"""

import ast
import contextlib
import inspect
import io
import os
import textwrap
from collections.abc import Callable
from types import CodeType
from typing import Any

from sim import cache

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
# Else Taichi takes the redirection for a notebook's, says so, and wraps each launch to print through it.
os.environ.setdefault("TI_ENABLE_PYBUF", "0")
# Taichi would ask its makers for a newer version once a day, by a name that it keeps for this machine.
os.environ["TI_SKIP_VERSION_CHECK"] = "ON"
KEEPS_KERNELS = cache.provide()
"""Whether what is compiled can be kept on disk for the next process."""
with contextlib.redirect_stdout(io.StringIO()):
    import taichi as ti
    from taichi._lib import core
    from taichi.graph._graph import gen_cpp_kernel
    from taichi.lang import _ndarray, impl, kernel_impl, matrix
    from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

__all__ = ["KEEPS_KERNELS", "core", "gen_cpp_kernel", "impl", "kernel", "ti"]


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


_sources: dict[CodeType, tuple[list[str], int]] = {}
"""Taichi finds a function's source in its file each time that it inlines it: a quarter of the rest."""


def _source(function: Any) -> tuple[list[str], int]:
    """A function's lines, and the number of the first one."""
    if "__source__" in vars(function):
        return vars(function)["__source__"]
    if function.__code__ not in _sources:
        _sources[function.__code__] = inspect.getsourcelines(function)
    return _sources[function.__code__]


ASTTransformerContext.get_pos_info = _once(ASTTransformerContext.get_pos_info)
kernel_impl.getsourcelines = _source
# Taichi formats the whole stack for each array that it makes, should that fail: longer than to make it.
_ndarray.get_traceback = matrix.get_traceback = lambda: ""


def kernel(function: Callable[..., None]) -> Any:
    """A Taichi kernel whose parameters may be records of arrays: a ``NamedTuple`` of its module, whose fields
    are annotated as a kernel's arguments are. Taichi passes arrays one by one, so each field becomes an
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
