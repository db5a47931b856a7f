"""Selection of the kernel compiler, and its input: cached source code, and records of arrays as parameters.

The compiler is Taichi, unless the environment variable ``VITRUVIUS_RUNTIME`` is ``quadrants``, the maintained
fork of Taichi. Both print a greeting on standard output. Standard output belongs to the program that imports
this module, so the greeting is discarded.
"""

import ast
import contextlib
import importlib.util
import inspect
import io
import os
import textwrap
from collections.abc import Callable
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any

from vitruvius.logic.errors import MissingProgram, RequestError
from vitruvius.logic.installation import X11, linux_command
from vitruvius.sim import cache

VARIABLE = "VITRUVIUS_RUNTIME"
COMPILERS = "taichi", "quadrants"
KEEPS_KERNELS = cache.provide()
"""True if compiled kernels can be kept on disk for the next process."""

if TYPE_CHECKING:
    import vitruvius.sim.compiler.taichi as compiler
    from vitruvius.sim.compiler.taichi import core, impl, ti


def _named() -> str:
    """Return the compiler that the variable names, or else the first one that is installed.

    Raises ``RequestError`` for another name.
    """
    installed = (name for name in COMPILERS if importlib.util.find_spec(name))
    name = os.environ.get(VARIABLE) or next(installed, COMPILERS[0])
    if name not in COMPILERS:
        raise RequestError(f"{VARIABLE}: there is no {name!r}: use one of {', '.join(COMPILERS)}")
    return name


if not TYPE_CHECKING:
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            compiler = importlib.import_module(f"vitruvius.sim.compiler.{_named()}")
        except ImportError as error:
            if "libX11" not in str(error):
                raise
            raise MissingProgram(f"Taichi needs libX11: {linux_command(X11)}") from error
    ti, core, impl = compiler.ti, compiler.core, compiler.impl

__all__ = ["KEEPS_KERNELS", "compiler", "core", "impl", "kernel", "ti"]


_sources: dict[CodeType, tuple[list[str], int]] = {}
"""Source lines of functions. Compilers read a function's file whenever they inline it, a quarter of tracing
time."""


def _source(function: Any) -> tuple[list[str], int]:
    """Return the source lines of a function, and the number of its first line."""
    if "__source__" in vars(function):
        return vars(function)["__source__"]
    if function.__code__ not in _sources:
        _sources[function.__code__] = inspect.getsourcelines(function)
    return _sources[function.__code__]


compiler.read_sources_by(_source)


def _seeing(function: Any, names: dict[str, Any]) -> Any:
    """Return the function, or a copy that also finds names which its module lacks."""
    if all(name in function.__globals__ for name in names):
        return function
    copy = FunctionType(
        function.__code__, function.__globals__ | names, function.__name__, None, function.__closure__
    )
    copy.__annotations__, copy.__doc__ = function.__annotations__, function.__doc__
    copy.__qualname__, copy.__module__ = function.__qualname__, function.__module__
    return copy


def kernel(function: Callable[..., None]) -> Any:
    """Compile a kernel whose parameters may be records of arrays.

    A record is a ``NamedTuple`` with fields annotated like a kernel's arguments. Compilers pass arrays one by
    one, so each field becomes an argument with the field's name. The kernel must not assign to these names.
    The record itself is available under the parameter's own name.
    """
    records = {name: kind for name, kind in function.__annotations__.items() if hasattr(kind, "_fields")}
    if records:
        types = {}
        for name, kind in records.items():
            known = function.__globals__.get(kind.__name__) is kind
            types[name] = kind.__name__ if known else f"_{name}_arrays"
        function = _seeing(function, {types[name]: kind for name, kind in records.items()})
        arguments = {}
        for name, kind in function.__annotations__.items():
            arguments |= kind.__annotations__ if name in records else {name: kind}
        lines, first = inspect.getsourcelines(function)
        tree = ast.parse(textwrap.dedent("".join(lines)))
        definition: Any = tree.body[0]
        definition.args.args = [ast.arg(name) for name in arguments]
        made = [f"{name} = ti.static({types[name]}{each._fields})" for name, each in records.items()]
        definition.body[:0] = ast.parse("\n".join(made).replace("'", "")).body
        # Stored with the function: the same code can have other records if a function defines it twice.
        vars(function)["__source__"] = ast.unparse(tree).splitlines(keepends=True), first
        named = inspect.Parameter.POSITIONAL_OR_KEYWORD
        parameters = [inspect.Parameter(name, named, annotation=each) for name, each in arguments.items()]
        vars(function)["__signature__"] = inspect.Signature(parameters)
    return ti.kernel(function)
