"""Mutants of files, and the edits that make mutants of Python files."""

import ast
import itertools
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
from msgspec.structs import replace

from benchmarks.reliability.rule_changes import lp_edits, pl_edits

Edit = tuple[str, int, int, str]
"""Operator, first and last byte of the old text, and the new text."""

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
"""Replacements of each comparison: off by one, and reversed."""

NEGATED = {"bool": "not", "int": "-", "float": "-"}
"""Operator that negates the value of a function, by the annotated type of the value."""

ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)

SMALLEST = 1e-3
"""Smallest constant that a mutant changes: smaller constants are tolerances."""

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
    """Text of the line, without indentation."""
    before: str
    after: str
    start: int
    """Place of the replaced text, in bytes."""
    end: int
    number: int = 0
    """Number of equal mutants above this one in the file."""

    @property
    def name(self) -> str:
        """File, line and change in words."""
        before, after = (" ".join(text.split()) for text in (self.before, self.after))
        return f"{self.file}: {self.code}: {before[:60]} -> {after[:60]}"

    @property
    def key(self) -> tuple[str, str, str, str, str, int]:
        """Identity of the mutant, which does not depend on the lines above."""
        return self.file, self.operator, self.code, self.before, self.after, self.number

    def applied(self, content: bytes) -> bytes:
        """Return the content of the file with the change."""
        return content[: self.start] + self.after.encode() + content[self.end :]


def mutants(root: Path, file: str) -> list[Mutant]:
    """Return all mutants of a file of the checkout at ``root``, from top to bottom."""
    content = (root / file).read_bytes()
    edits: Callable[[bytes], Iterator[Edit]] = {".py": python_edits, ".lp": lp_edits, ".pl": pl_edits}[
        Path(file).suffix
    ]
    lines, found, above = content.decode().splitlines(), list[Mutant](), Counter[tuple[object, ...]]()
    for operator, start, end, after in sorted(set(edits(content)), key=lambda edit: edit[1:]):
        line = content.count(b"\n", 0, start) + 1
        before = content[start:end].decode()
        mutant = Mutant(file, line, operator, lines[line - 1].strip(), before, after, start, end)
        found.append(replace(mutant, number=above[mutant.key]))
        above[mutant.key] += 1
    return found


def python_edits(content: bytes) -> Iterator[Edit]:
    """Yield the edits of a Python file, but none of a file with kernels."""
    tree, starts = ast.parse(content), [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    if any(ast.unparse(each) in KERNELS for function in functions for each in function.decorator_list):
        return
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    symmetric = {arg for call in calls if ast.unparse(call.func) == "abs" for arg in call.args}
    sizes = [arg for call in calls if ast.unparse(call.func).endswith(".reshape") for arg in call.args]
    # A negative size stands for the size that NumPy computes, whatever the number.
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
    """Yield the nodes below a node that run, each with the return annotation of its function."""
    for name, value in ast.iter_fields(node):
        if name in NOT_RUN and not isinstance(node, ast.Call):
            continue
        for child in value if isinstance(value, list) else [value]:
            # Python 3.11 has no places for the parts of an f-string.
            if not isinstance(child, ast.AST) or isinstance(child, ast.JoinedStr | ast.Assert):
                continue
            if isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING":
                continue
            function = isinstance(child, ast.FunctionDef) and child.returns
            within = ast.unparse(function) if function else returned
            yield child, within
            yield from _nodes(child, within)


def _changes(node: ast.AST, returned: str) -> Iterator[tuple[str, ast.stmt | ast.expr, str]]:
    """Yield the edits of a node: an operator, the node to replace, and the new text."""
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
            pass  # a docstring; without its only yield, a generator is a function
        case ast.Expr() | ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break() | ast.If(orelse=[]):
            yield "statement", node, "pass"
    if isinstance(node, ast.If | ast.While | ast.IfExp) and not _is_negated(node.test):
        yield "condition", node.test, f"(not ({ast.unparse(node.test)}))"
    elif isinstance(node, ast.comprehension):
        for condition in itertools.filterfalse(_is_negated, node.ifs):
            yield "condition", condition, f"(not ({ast.unparse(condition)}))"


def _is_tolerant(node: ast.Compare) -> bool:
    """Return True for an order of lengths with a tolerance, where ``<`` and ``<=`` make no difference."""
    numbers = [each.value for each in node.comparators if isinstance(each, ast.Constant)]
    small = any(isinstance(number, float) and 0 < number <= SMALLEST for number in numbers)
    return isinstance(node.ops[0], ORDERS) and (small or "TOLERANCE" in ast.unparse(node))


def _is_negated(test: ast.expr) -> bool:
    """Return True for a condition whose comparison has its negation as a mutant."""
    return isinstance(test, ast.Compare) and len(test.ops) == 1 and len(COMPARISONS[type(test.ops[0])]) == 1


def _is_distance(node: ast.BinOp, symmetric: set[ast.expr]) -> bool:
    """Return True for a difference whose sign has no effect."""
    return isinstance(node.op, ast.Sub) and node in symmetric
