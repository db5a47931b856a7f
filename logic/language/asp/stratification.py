"""Rules that depend on their own negation, and so choose without the picks or exclude every layout.

``a :- not b. b :- not a.`` has two answers for one layout, of which a solver takes either. Therefore no
predicate of a grammar may depend on itself through negation, an aggregate or a condition.
"""

from collections.abc import Iterable, Iterator
from typing import Any

from clingo.ast import AST, ASTSequence, ASTType, Sign

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.language.asp.statements import Statement
from vitruvius.logic.layout.reading import children


def unstratified(statements: Iterable[Statement]) -> Iterator[GrammarError]:
    """Yield an error for each rule whose head depends on a negation of itself."""
    needs: dict[str, set[str]] = {}
    negations: list[tuple[Statement, str, str]] = []
    for statement in statements:
        node = statement.node
        if node.ast_type != ASTType.Rule:
            continue
        for head in _atoms(node.head):
            for literal in node.body:
                plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
                plain = plain and literal.atom.ast_type == ASTType.SymbolicAtom
                for atom in _atoms(literal):
                    needs.setdefault(head, set()).add(atom)
                    if not plain:
                        negations.append((statement, head, atom))
    said = set()
    for statement, head, atom in negations:
        if id(statement.node) not in said and head in _reached(atom, needs):
            said.add(id(statement.node))
            way = f"{head} depends on its own negation" + (f" through {atom}" if atom != head else "")
            yield statement.error(f"{way}: a choice is made by option/3, a condition is a constraint")


def _atoms(node: Any) -> set[str]:
    """Return the predicates below a node, as in ``near/2``, or ``-near/2`` for classical negation."""
    if isinstance(node, ASTSequence | list | tuple):
        return {name for part in node for name in _atoms(part)}
    if not isinstance(node, AST):
        return set()
    if node.ast_type == ASTType.SymbolicAtom:
        return _names(node.symbol, "")
    return {name for child in children(node) for name in _atoms(child)}


def _names(symbol: Any, sign: str) -> set[str]:
    if symbol.ast_type == ASTType.Pool:
        return {name for part in symbol.arguments for name in _names(part, sign)}
    if symbol.ast_type == ASTType.UnaryOperation:
        return _names(symbol.argument, "" if sign else "-")
    return {f"{sign}{symbol.name}/{len(symbol.arguments)}"}


def _reached(start: str, needs: dict[str, set[str]]) -> set[str]:
    """Return the predicates on which a predicate depends, and the predicate itself."""
    found, left = {start}, [start]
    while left:
        new = needs.get(left.pop(), set()) - found
        found |= new
        left += new
    return found
