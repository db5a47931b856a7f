"""The words of a grammar's .lp files: what is misspelt, and what nothing uses."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from clingo import Symbol
from clingo.ast import AST, ASTSequence, ASTType, parse_files

from logic.errors import GrammarError
from logic.layout import CORE
from logic.spelling import closest

Signature = tuple[str, int]


@dataclass
class Words:
    """The predicates that files derive and use, their constants and #const names, each with its places."""

    derived: dict[Signature, list[Any]] = field(default_factory=dict)
    used: dict[Signature, list[Any]] = field(default_factory=dict)
    constants: dict[str, list[Any]] = field(default_factory=dict)
    defined: dict[str, Any] = field(default_factory=dict)
    facts: list[Any] = field(default_factory=list)


def words(files: Iterable[Path]) -> Words:
    """All words of these files and of what they include."""
    found = Words()

    def take(statement: Any) -> None:
        if statement.ast_type in {ASTType.Defined, ASTType.ShowSignature}:
            found.used.setdefault((statement.name, statement.arity), []).append(statement.location)
        elif statement.ast_type == ASTType.Definition:
            found.defined[statement.name] = statement.location
        elif statement.ast_type == ASTType.Rule:
            _read(statement.head, found, found.derived)
            for literal in statement.body:
                _read(literal, found, found.used)
            if not statement.body:
                found.facts.append(statement)

    parse_files([str(file) for file in files], take, logger=lambda *_: None)
    return found


def _read(node: Any, found: Words, atoms: dict[Signature, list[Any]]) -> None:
    """Collect atoms and constants below a node; conditions in a head are used, not derived."""
    if isinstance(node, ASTSequence | list | tuple):
        for part in node:
            _read(part, found, atoms)
        return
    if not isinstance(node, AST):
        return
    kind = node.ast_type
    if kind == ASTType.ConditionalLiteral:
        _read(node.literal, found, atoms)
        _read(node.condition, found, found.used)
        return
    if kind == ASTType.SymbolicAtom:
        symbol = node.symbol
        for atom in symbol.arguments if symbol.ast_type == ASTType.Pool else [symbol]:
            if atom.ast_type == ASTType.Function:
                arguments = atom.arguments
                atoms.setdefault((atom.name, len(arguments)), []).append(atom.location)
                _read(arguments, found, atoms)
        return
    if kind == ASTType.Function and not node.arguments:
        found.constants.setdefault(node.name, []).append(node.location)
    if kind == ASTType.SymbolicTerm and re.fullmatch("[a-z]\\w*", str(node.symbol)):
        found.constants.setdefault(str(node.symbol), []).append(node.location)
    if kind not in _CHILDREN:
        _CHILDREN[kind] = node.child_keys
    for key in _CHILDREN[kind]:
        _read(getattr(node, key), found, atoms)


_CHILDREN: dict[ASTType, list[str]] = {}
"""The children of each kind of node: to ask each node takes most of the time of reading."""


def misspelt(files: Sequence[Path], sized: Iterable[str]) -> Iterator[GrammarError]:
    """Predicates that nothing derives or uses, and constants that stand nowhere else.

    ``sized`` are the names that the ``.pl`` files know.
    """
    own, core = words(files), words([CORE])
    choices = {("option", 3), ("picks", 2), ("pick", 2)}
    known = set(core.used) | set(core.derived) | choices
    for signature, places in own.used.items():
        if signature not in own.derived and signature not in known:
            yield _unknown(signature, "nothing derives", places[0], known | set(own.derived))
    inputs = {signature for signature in core.used if signature not in core.derived} | choices
    for signature, places in own.derived.items():
        if signature not in own.used and signature not in known:
            yield _unknown(signature, "nothing uses", places[0], inputs | set(own.used))
    counted = Counter({name: len(places) for name, places in own.constants.items()})
    counted.update(name for name in core.constants if name in counted)
    counted.update(name for name in sized if name in counted)
    others = {*core.constants, *sized, *(name for name, count in counted.items() if count > 1)}
    for name, places in own.constants.items():
        if counted[name] == 1 and name not in own.defined:
            yield _at(places[0], f"{name} stands nowhere else{_meant(name, others)}")
    for name, place in own.defined.items():
        if name not in own.constants and name not in core.defined:
            yield _at(place, f"#const {name} is not used{_meant(name, [*core.defined, 'rooms'])}")


def place_of(fact: Symbol, files: Sequence[Path]) -> tuple[str, int, int] | None:
    """File, line and column of the fact, pools included, from which a ground atom comes."""
    for statement in words(files).facts:
        text = str(statement.head)
        if re.match(rf"{fact.name}\b", text) and all(
            re.search(rf"(?<!\w){re.escape(str(argument))}(?!\w)", text) for argument in fact.arguments
        ):
            begin = statement.location.begin
            return begin.filename, begin.line, begin.column
    return None


def _unknown(signature: Signature, what: str, place: Any, known: Iterable[Signature]) -> GrammarError:
    name, arity = signature
    same = [other for other in known if other[0] == name]
    hint = (
        f": did you mean {name}/{same[0][1]}?" if same else _meant(name, [other for other, _ in known], known)
    )
    return _at(place, f"{what} {name}/{arity}{hint}")


def _meant(name: str, names: Iterable[str], signatures: Iterable[Signature] = ()) -> str:
    close = closest(name, names)
    if close is None:
        return ""
    arity = next((f"/{arity}" for other, arity in sorted(signatures) if other == close), "")
    return f": did you mean {close}{arity}?"


def _at(location: Any, text: str) -> GrammarError:
    return GrammarError(text, location.begin.filename, location.begin.line, location.begin.column)
