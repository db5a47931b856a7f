"""Patches of Taichi's internals: five that save time, and one that hands it the sources of kernels.

The five save more than half of the time in which Taichi reads kernels. They change no result, so they can be
turned off: set the environment variable ``VITRUVIUS_TAICHI_PATCHES`` to ``off``. The sixth one,
``read_sources_by``, stays on, because kernels with records of arrays need it (``sim.tracing.kernel``).
"""

import inspect
import os
import textwrap
import warnings
from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import taichi
from taichi.lang import _ndarray, kernel_impl, matrix
from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext

SWITCH = "VITRUVIUS_TAICHI_PATCHES"
"""Environment variable that turns the five patches off."""

TESTED = ((1, 7, 4),)
"""Versions of Taichi with which the patches were tested."""


def patch() -> None:
    """Apply the five patches, unless they are turned off. Warn of a version that was not tested."""
    if os.environ.get(SWITCH, "on") == "off":
        return
    if taichi.__version__ not in TESTED:
        warnings.warn(untested(taichi.__version__), RuntimeWarning, stacklevel=2)
    # For error messages, Taichi formats the source of every expression each time it inlines it: half of the
    # tracing time. Once is enough.
    ASTTransformerContext.get_pos_info = _once(ASTTransformerContext.get_pos_info)
    # Taichi wraps each line of a function, and looks up its file, each time it inlines the function: a fifth
    # of the tracing time.
    kernel_impl.textwrap = SimpleNamespace(fill=cache(textwrap.fill), dedent=cache(textwrap.dedent))
    file_of = cache(inspect.getsourcefile)
    kernel_impl.getsourcefile = lambda function: file_of(function.__code__)
    # Taichi formats the whole stack for each array that it creates, in case that fails. That takes longer
    # than the creation.
    _ndarray.get_traceback = matrix.get_traceback = lambda: ""


def untested(version: tuple[int, ...]) -> str:
    """Return the warning for a version of Taichi."""
    ours, tested = (".".join(map(str, each)) for each in (version, TESTED[-1]))
    return (
        f"Taichi is {ours}: Vitruvius patches its internals, and the patches were tested only with {tested}. "
        f"If kernels fail to compile, set {SWITCH}=off, or install taichi=={tested}"
    )


def _once(describe: Callable[[Any, Any], str]) -> Any:
    """Return a cached version of ``describe``, a function of a context and a node."""
    known: dict[tuple[Any, ...], str] = {}

    def describe_once(context: Any, node: Any) -> str:
        place = node.lineno, node.col_offset, node.end_lineno, node.end_col_offset
        key = context.file, context.lineno_offset, context.func.func.__name__, *place
        if key not in known:
            known[key] = describe(context, node)
        return known[key]

    return describe_once


def read_sources_by(lines_of: Callable[[Any], tuple[list[str], int]]) -> None:
    """Let Taichi read source code with ``lines_of``.

    ``lines_of`` returns a function's lines, and the number of its first line. Taichi itself reads a
    function's file whenever it inlines the function: a quarter of the tracing time.
    """
    kernel_impl.getsourcelines = lines_of
