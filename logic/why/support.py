# clingo.ast leaves the attributes of its nodes untyped.
# pyright: reportAttributeAccessIssue=false, reportOptionalMemberAccess=false, reportArgumentType=false
"""Support of a layout: the rules that derive its atoms, down to facts and picks.

Each rule ``h :- b, not c.`` of the core and the grammar is grounded as ``support(N,h,(b,)) :- b, not c.``
with the atoms of the layout as facts. The derived atoms are the instances of the rule that hold (as in
xclingo: Cabalar, Fandinno and Muñiz, "A system for explainable answer set programming", ICLP 2020).
"""

from collections.abc import Iterable, Sequence
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

import clingo
from clingo import Number, Symbol, ast
from msgspec import structs

from vitruvius.logic.errors import Reason
from vitruvius.logic.language.reference import asp_entries
from vitruvius.logic.layout.conditional import HERE
from vitruvius.logic.layout.messages import written
from vitruvius.logic.layout.program import CORE, Program
from vitruvius.logic.layout.reading import parse
from vitruvius.logic.why.alternatives import Chosen
from vitruvius.logic.why.answer import Derivation

SUPPORT = "support'"
"""Name that no rule of a user derives, although names may end with a quote."""


class _Instance(NamedTuple):
    """Ground rule that holds: the rule's number, and its positive body."""

    rule: int
    body: tuple[Symbol, ...]


class Support:
    """Rules that hold in one layout."""

    def __init__(self, program: Program, atoms: Iterable[Symbol]) -> None:
        """Ground the rules of a program over all atoms that hold in one of its layouts."""
        self.rules: list[Reason] = []
        known = asp_entries()
        self._entries = {
            (entry.name, len(entry.arguments)): entry
            for part in ("base", "topology", *(name for name, _ in program.parts), "pick")
            for entry in known.get(part, ())
        }
        constants = [f"-c{name}={value}" for name, value in program.constants.items()]
        control = clingo.Control(constants, logger=lambda *_: None)
        holds = set(atoms)
        with ast.ProgramBuilder(control) as builder:
            builder.add(ast.Program(HERE, "base", []))
            for atom in holds:
                builder.add(ast.Rule(HERE, ast.Literal(HERE, ast.Sign.NoSign, _fact(atom)), []))
            parse(
                [CORE, *program.files],
                lambda statement: self._add(statement, builder),
                left_out=program.left_out,
            )
        control.ground([("base", []), *program.parts, ("pick", [])])
        self._instances: dict[Symbol, list[_Instance]] = {atom: [] for atom in holds}
        for atom in control.symbolic_atoms.by_signature(SUPPORT, 3):
            number, head, body = atom.symbol.arguments
            # A pool or an interval represents each of its values, some of which may not hold.
            if head in holds:
                self._instances[head].append(_Instance(number.number, tuple(body.arguments)))
        self._levels = self._derived()
        self.chosen = Chosen(_by_variable(holds, "pick"), _by_variable(holds, "option"))

    def _add(self, statement: ast.AST, builder: ast.ProgramBuilder) -> None:
        """Add a statement of the rules, and for a rule its instances."""
        if statement.ast_type in {ast.ASTType.Program, ast.ASTType.Definition}:
            builder.add(statement)
        elif statement.ast_type == ast.ASTType.Rule:
            named = _Named()
            body = [named.visit(literal) if _positive(literal) else literal for literal in statement.body]
            for head, conditions in _heads(statement.head):
                condition = [named.visit(literal) for literal in conditions]
                terms = [each.atom.symbol for each in (condition or body) if _positive(each)]
                number = ast.SymbolicTerm(HERE, Number(len(self.rules)))
                support = [number, head, ast.Function(HERE, "", terms, False)]
                atom = ast.SymbolicAtom(ast.Function(HERE, SUPPORT, support, False))
                literal = ast.Literal(HERE, ast.Sign.NoSign, atom)
                builder.add(ast.Rule(HERE, literal, [*condition, *body]))
            begin = statement.location.begin
            self.rules.append(Reason(written(statement), begin.filename, begin.line, begin.column))

    def _derived(self) -> dict[Symbol, int]:
        """Return the number of steps that derive each atom. A proof in fewest steps is never circular."""
        levels: dict[Symbol, int] = {}
        open_ = set(self._instances)
        for level in range(len(open_) + 1):
            new = {
                atom
                for atom in open_
                if any(all(each in levels for each in instance.body) for instance in self._instances[atom])
            }
            if not new:
                break
            levels |= dict.fromkeys(new, level)
            open_ -= new
        return levels

    def variables(self, subject: Sequence[Symbol]) -> list[Symbol]:
        """Return the variables that pick one value for a subject, as ``place(bed,1)`` for bed 1."""
        return [
            variable
            for variable, values in self.chosen.picks.items()
            if len(values) == 1
            and variable.arguments in ([subject[0]], [*subject, *variable.arguments[len(subject) :]])
        ]

    def trees(self, atoms: Iterable[Symbol]) -> tuple[Derivation, ...]:
        """Return the derivations of atoms that hold.

        Each only names atoms that an earlier one has derived.
        """
        explained: set[Symbol] = set()
        nodes = [node for atom in atoms for node in self._nodes(atom, explained, frozenset())]
        means = [node.means for node in nodes]
        return tuple(
            structs.replace(node, means="") if node.means in means[:place] else node
            for place, node in enumerate(nodes)
        )

    def _nodes(self, atom: Symbol, explained: set[Symbol], above: frozenset[int]) -> list[Derivation]:
        """Return an atom's derivation, or only its body if a rule ``above`` recurs."""
        if atom in explained:
            return [Derivation(str(atom))]
        instance = self._best(atom)
        if instance is None:
            return [Derivation(str(atom))]
        same = {each for each in instance.body if each.match(atom.name, len(atom.arguments))}
        body = [
            node
            for each in dict.fromkeys(instance.body)
            for node in self._nodes(each, explained, above | {instance.rule} if each in same else frozenset())
        ]
        if instance.rule in above:
            return body
        if body:  # a fact is as short as its name
            explained.add(atom)
        options = self._options(atom.arguments[0]) if atom.match("pick", 2) else ()
        means = "" if options else self.means(atom)
        if options and (variable := atom.arguments[0]) not in explained:
            explained.add(variable)
            means = _remark(next((each.rule for each in body if each.atom.startswith("option(")), None))
        return [Derivation(str(atom), self.rules[instance.rule], means, options, tuple(body))]

    def _options(self, variable: Symbol) -> tuple[str, ...]:
        """Return the options of a variable, with weights if these differ."""
        weights = {
            option.arguments[1]: option.arguments[2]
            for option in self._instances
            if option.match("option", 3) and option.arguments[0] == variable
        }
        same = len(set(weights.values())) == 1
        return tuple(
            f"{value}" if same else f"{value} (weight {weight})" for value, weight in sorted(weights.items())
        )

    def _best(self, atom: Symbol) -> _Instance | None:
        """Return the instance that derives an atom in the fewest steps, and then from the fewest atoms."""

        def effort(instance: _Instance) -> tuple[int, int, int]:
            steps = max((self._levels[each] for each in instance.body), default=-1)
            return steps, len(set(instance.body)), instance.rule

        known = [each for each in self._instances[atom] if all(part in self._levels for part in each.body)]
        return min(known, key=effort, default=None)

    def means(self, atom: Symbol) -> str:
        """Return the reference's text on this predicate, as in ``side(Number,Side): that room stands ..``."""
        entry = self._entries.get((atom.name, len(atom.arguments)))
        return f"{entry.name}({','.join(entry.arguments)}): {entry.text}" if entry else ""


def _remark(rule: Reason | None) -> str:
    """Return the whole comment right above a rule, which explains a choice."""
    if rule is None or not rule.file or not rule.line:
        return ""
    above = Path(rule.file).read_text(encoding="utf-8").split("\n")[: rule.line - 1]
    comment = takewhile(lambda line: line.startswith("% ") and not line.startswith("% -"), reversed(above))
    return " ".join(line.removeprefix("% ").strip() for line in reversed([*comment]))


def _by_variable(atoms: Iterable[Symbol], name: str) -> dict[Symbol, list[Symbol]]:
    """Return variables and their values, in order, from the atoms ``pick(V,X)`` or ``option(V,X,W)``."""
    found: dict[Symbol, list[Symbol]] = {}
    for atom in sorted(atom for atom in atoms if atom.name == name):
        found.setdefault(atom.arguments[0], []).append(atom.arguments[1])
    return found


class _Named(ast.Transformer):
    """Transformer that names each anonymous variable, which a term of a head requires."""

    def __init__(self) -> None:
        self._number = 0

    def visit_Variable(self, node: ast.AST) -> ast.AST:
        """Return a variable with a name."""
        if node.name != "_":
            return node
        self._number += 1
        return node.update(name=f"_Any{self._number}")


def _heads(head: ast.AST) -> list[tuple[ast.AST, list[ast.AST]]]:
    """Return the atoms that a head may make true, as terms, each with its condition."""
    if head.ast_type == ast.ASTType.Literal:
        return [(head.atom.symbol, [])] if _positive(head) else []
    if head.ast_type == ast.ASTType.Aggregate:
        return [(each.literal.atom.symbol, list(each.condition)) for each in head.elements]
    return []


def _positive(literal: ast.AST) -> bool:
    """Return True if a literal is an atom without negation."""
    return (
        literal.ast_type == ast.ASTType.Literal
        and literal.sign == ast.Sign.NoSign
        and literal.atom.ast_type == ast.ASTType.SymbolicAtom
    )


def _fact(symbol: Symbol) -> ast.AST:
    terms = [ast.SymbolicTerm(HERE, argument) for argument in symbol.arguments]
    atom = ast.Function(HERE, symbol.name, terms, False)
    return ast.SymbolicAtom(
        atom if symbol.positive else ast.UnaryOperation(HERE, ast.UnaryOperator.Minus, atom)
    )
