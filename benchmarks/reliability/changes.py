"""Mutants of Python files: the places where one could be wrong, each changed by a small edit of its text."""

import ast
import itertools
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec

from benchmarks.reliability.rule_changes import lp_edits, pl_edits

Edit = tuple[str, int, int, str]
"""An operator, where the text begins and ends that it replaces (bytes), and the text in its place."""

COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
}
"""The comparisons in the place of each: off by one, and turned."""

NEGATED = {"bool": "not", "int": "-", "float": "-"}
"""How a function's value is negated, by what its annotation says that it returns."""

ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)

SMALLEST = 1e-3
"""Constants below this are tolerances: 1 % more is no mistake."""

NOT_RUN = ("annotation", "returns", "decorator_list", "bases", "keywords")
"""Fields of statements, arguments and classes that no mutant changes."""

KERNELS = ("ti.kernel", "ti.func", "kernel")
"""Decorators of functions that Taichi compiles."""


class Mutant(msgspec.Struct, frozen=True):
    """A file with one small change."""

    file: str
    """Path in the checkout."""
    line: int
    operator: str
    code: str
    """The line as it is written, without indentation."""
    before: str
    after: str
    start: int
    """Place of the replaced text, in bytes."""
    end: int

    def applied(self, content: bytes) -> bytes:
        """Return the file's content with the change."""
        return content[: self.start] + self.after.encode() + content[self.end :]


def mutants(root: Path, file: str) -> list[Mutant]:
    """Return all mutants of a file of the checkout at ``root``, in the order of their places."""
    content = (root / file).read_bytes()
    edits: Callable[[bytes], Iterator[Edit]] = {".py": python_edits, ".lp": lp_edits, ".pl": pl_edits}[
        Path(file).suffix
    ]
    lines, found = content.decode().splitlines(), []
    for operator, start, end, after in sorted(set(edits(content)), key=lambda edit: edit[1:]):
        line = content.count(b"\n", 0, start) + 1
        before = content[start:end].decode()
        found.append(Mutant(file, line, operator, lines[line - 1].strip(), before, after, start, end))
    return found


def python_edits(content: bytes) -> Iterator[Edit]:
    """Yield the edits of a Python file; none of a file that holds functions which Taichi compiles."""
    tree, starts = ast.parse(content), [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    if any(ast.unparse(each) in KERNELS for function in functions for each in function.decorator_list):
        return
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    symmetric = {arg for call in calls if ast.unparse(call.func) == "abs" for arg in call.args}
    sizes = [arg for call in calls if ast.unparse(call.func).endswith(".reshape") for arg in call.args]
    # NumPy computes any negative size.
    computed = {size.operand for size in sizes if isinstance(size, ast.UnaryOp)}
    for node, returned in _nodes(tree, ""):
        if node in computed:
            continue
        for operator, changed, text in _changes(node, returned):
            if operator == "operands" and isinstance(node, ast.BinOp) and _is_distance(node, symmetric):
                continue
            start = starts[changed.lineno - 1] + changed.col_offset
            yield operator, start, starts[(changed.end_lineno or 0) - 1] + (changed.end_col_offset or 0), text


def _nodes(node: ast.AST, returned: str) -> Iterator[tuple[ast.AST, str]]:
    """Yield what runs below a node, each with the annotation of what its function returns."""
    for name, value in ast.iter_fields(node):
        if name in NOT_RUN and not isinstance(node, ast.Call):
            continue
        for child in value if isinstance(value, list) else [value]:
            # Python 3.11 does not know the places of the parts of an f-string.
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr | ast.Assert):
                continue
            if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
                continue
            function = isinstance(child, ast.FunctionDef) and child.returns
            within = ast.unparse(function) if function else returned
            yield child, within
            yield from _nodes(child, within)


def _changes(node: ast.AST, returned: str) -> Iterator[tuple[str, ast.stmt | ast.expr, str]]:
    """Yield operators, the nodes that each replaces, and the text in their place."""
    match node:
        case ast.Compare():
            for place, op in enumerate(node.ops):
                for other in COMPARISONS[type(op)][_is_tolerant(node) :]:
                    ops = [*node.ops[:place], other(), *node.ops[place + 1 :]]
                    changed = ast.Compare(node.left, ops, node.comparators)
                    yield "comparison", node, f"({ast.unparse(changed)})"
        case ast.BoolOp():
            other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield "and/or", node, f"({ast.unparse(ast.BoolOp(other, node.values))})"
        case ast.Constant(value=bool()):
            yield "constant", node, str(not node.value)
        case ast.Constant(value=int(number)):
            yield "constant", node, str(number + 1)
        case ast.Constant(value=float(number)) if not 0 < number < SMALLEST:
            yield "constant", node, repr(number * 1.01 or 0.01)
        case ast.BinOp(op=ast.Sub() | ast.Div() | ast.FloorDiv() | ast.Mod()):
            yield "operands", node, f"({ast.unparse(ast.BinOp(node.right, node.op, node.left))})"
        case ast.Return(value=ast.expr() as value) if returned in NEGATED:
            yield "return", node, f"return {NEGATED[returned]} ({ast.unparse(value)})"
        case ast.Expr(value=ast.Constant() | ast.Yield() | ast.YieldFrom()):
            pass  # a docstring; a generator without its only yield is none
        case ast.Expr() | ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break() | ast.If(orelse=[]):
            yield "statement", node, "pass"
    if isinstance(node, ast.If | ast.While | ast.IfExp) and not _is_negated(node.test):
        yield "condition", node.test, f"(not ({ast.unparse(node.test)}))"
    elif isinstance(node, ast.comprehension):
        for condition in itertools.filterfalse(_is_negated, node.ifs):
            yield "condition", condition, f"(not ({ast.unparse(condition)}))"


def _is_tolerant(node: ast.Compare) -> bool:
    """Return True for an order of lengths with a tolerance: no test can tell ``<`` from ``<=`` there."""
    numbers = [each.value for each in node.comparators if isinstance(each, ast.Constant)]
    small = any(isinstance(number, float) and 0 < number <= SMALLEST for number in numbers)
    return isinstance(node.ops[0], ORDERS) and (small or "TOLERANCE" in ast.unparse(node))


def _is_negated(test: ast.expr) -> bool:
    """Return True if a mutant of its comparison is a condition's negation."""
    return isinstance(test, ast.Compare) and len(test.ops) == 1 and len(COMPARISONS[type(test.ops[0])]) == 1


def _is_distance(node: ast.BinOp, symmetric: set[ast.expr]) -> bool:
    """Return True for a difference whose sign does not count."""
    return isinstance(node.op, ast.Sub) and node in symmetric
