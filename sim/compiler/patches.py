"""Patches of Taichi's internals: five that save time, and one that hands it the sources of kernels.

The five save more than half of the time in which Taichi reads kernels. They change no result, so they can be
turned off: set the environment variable ``VITRUVIUS_TAICHI_PATCHES`` to ``off``. The sixth one,
``read_sources_by``, stays on, because kernels with records of arrays need it (``sim.tracing.kernel``).
"""

import ast
import inspect
import os
import textwrap
import warnings
from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any, cast

import taichi
from taichi.lang import _ndarray, kernel_impl, matrix
from taichi.lang.ast.ast_transformer_utils import ASTTransformerContext
from taichi.lang.ast.transform import transform_tree

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
    # For error messages, Taichi wraps and underlines the source of every expression that it inlines: half of
    # the tracing time. The line and a mark are enough.
    cast(Any, ASTTransformerContext).get_pos_info = _place
    # Taichi parses a function, wraps its lines, and looks up its file, each time it inlines the function: a
    # third of the tracing time.
    trees = _Trees()
    kernel_impl.ast, kernel_impl.transform_tree = SimpleNamespace(parse=trees.parse), trees.transform
    kernel_impl.textwrap = SimpleNamespace(fill=_unwrapped, dedent=cache(textwrap.dedent))
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


def _place(context: Any, node: Any) -> str:
    """Return the place of a node, for an error message: file, line and function, and the line with a mark."""
    line, name = node.lineno + context.lineno_offset, context.func.func.__name__
    text, mark = context.src[node.lineno - 1], " " * (context.indent + node.col_offset) + "^"
    return f'File "{context.file}", line {line}, in {name}:\n{text}\n{mark}\n'


def _unwrapped(line: str, tabsize: int, width: int) -> str:
    """Return a line of source as ``textwrap.fill`` does if the line is shorter than ``width``."""
    return line.expandtabs(tabsize).rstrip()


class _Trees:
    """Trees of inlined functions, by their source. Taichi notes values in a tree while it reads the tree."""

    def __init__(self) -> None:
        self.free: dict[str, Any] = {}

    def parse(self, source: str) -> Any:
        """Return a syntax tree that no other call is using: a function may inline itself."""
        tree: Any = self.free.pop(source, None) or ast.parse(source)
        tree.source = source
        return tree

    def transform(self, tree: Any, context: Any) -> Any:
        """Inline a function or read a kernel, whose arguments Taichi removes from its tree."""
        found = transform_tree(tree, context)
        if not (context.is_kernel or context.is_real_function):
            self.free[tree.source] = tree
        return found


def read_sources_by(lines_of: Callable[[Any], tuple[list[str], int]]) -> None:
    """Let Taichi read source code with ``lines_of``.

    ``lines_of`` returns a function's lines, and the number of its first line. Taichi itself reads a
    function's file whenever it inlines the function: a quarter of the tracing time.
    """
    kernel_impl.getsourcelines = lines_of
