"""Mistakes in the facts of a grammar's .lp files, and missing facts, each with its place."""

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import Any

from clingo import Function, Symbol, SymbolType
from clingo.ast import ASTType

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.parts import OUTSIDE
from vitruvius.logic.language.asp.causes import Mistake
from vitruvius.logic.language.asp.statements import error_at
from vitruvius.logic.language.asp.vocabulary import Use, Words, alternatives
from vitruvius.logic.layout.program import Program
from vitruvius.logic.spelling import closest

MOST_NAMED = 3
"""Largest number of names with an error each, if the same is wrong with all of them."""

NAME = re.compile("[a-z][A-Za-z0-9_]*")
"""Names of types and pieces that clingo, SWI-Prolog and a house file write in the same way."""

NO_NAME = {
    "type": "a type is named by a word that begins in lower case, as in bedroom",
    "piece": "a piece is named by a word that begins in lower case, as in bed",
}
"""Messages for other names."""


PREDICATE = re.compile(r"\b[a-z]\w*/\d")
"""Name of the predicate that should state a missing thing, in the message about a fact."""


class Facts:
    """Facts of a grammar with these words."""

    def __init__(self, grammar: Grammar, words: Words) -> None:
        """Set the grammar and its words."""
        self._grammar, self._words = grammar, words

    def at(self, fact: Symbol, why: str) -> GrammarError:
        """Return an error at the fact's place in the files."""
        found = places(fact, self._words)
        return error_at(found[0].node, why) if found else GrammarError(why, self._grammar.directory)

    def _place(self, fact: Symbol) -> tuple[bool, str, int, int]:
        """Return a sort key of the fact's place; facts of a shipped grammar precede the user's own."""
        found = self.at(fact, "")
        own = self._grammar.directory in Path(str(found.file)).parents
        return own, str(found.file), found.line or 0, found.column or 0

    def absent_from(self, kind: str, names: Sequence[str], files: Sequence[Path]) -> Mistake:
        """Return the mistake that no file of a kind states these predicates."""
        there = ", ".join(file.name for file in files)
        why = f"no {kind} file states {', '.join(names)}: is a file gone? There is {there}"
        return Mistake(GrammarError(why, self._grammar.directory), frozenset({*names, "topology/1"}))

    def absent(self, clauses: Sequence[Symbol]) -> Iterator[GrammarError]:
        """Yield an error for each clause that no ``.pl`` file states, or one for many of one predicate."""
        for size in ("room_size/3", "piece_size/4"):
            each = {
                c.arguments[-1].name: c for c in clauses if len(c.arguments) == 1 + (size == "piece_size/4")
            }
            each = {name: c for name, c in each.items() if c.name == "size"}
            if len(each) > MOST_NAMED:
                names = ", ".join(list(each)[:MOST_NAMED])
                why = (
                    f"{size} has no clause for {names} and {len(each) - MOST_NAMED} more: is a .pl file gone?"
                )
                yield GrammarError(why, self._grammar.directory)
            else:
                yield from map(self._absent_clause, each.values())
        yield from (self._absent_clause(clause) for clause in clauses if clause.name == "length")

    def _absent_clause(self, clause: Symbol) -> GrammarError:
        """Return an error for a clause that no ``.pl`` file states, at the fact that needs the clause."""
        if clause.name == "length":
            name = clause.arguments[0].name
            hint = f"{name}/1 has no clause: add one, as {name}(0.5). for half a metre"
            return GrammarError(hint, self._grammar.prolog[-1], 1, 1)
        *room, name = clause.arguments
        facts = [("type", [name])]
        if room:
            facts = [("may", [*room, name]), ("beside", [name]), ("around", [name])]
        why = f"{'piece_size/4' if room else 'room_size/3'} has no clause for {name}: add one to a .pl file"
        errors = [self.at(Function(predicate, names), why) for predicate, names in facts]
        return next((error for error in errors if error.line), errors[0])

    def wrong(self, probe: Program, strange: Set[str]) -> tuple[list[Mistake], list[Mistake]]:
        """Return the mistakes in the grammar's facts that the core's own rules find (``grammar.lp``).

        The first list is about values, and explains the ``strange`` names among them. The second is about
        missing things. For several facts that name one unknown thing, it has the first fact.
        """
        types = {OUTSIDE, *(str(symbol.arguments[0]) for symbol in probe.atoms("type", 1))}
        of_values: dict[tuple[Any, ...], Mistake] = {}  # One statement may state many facts.
        absent: dict[tuple[str, str], Mistake] = {}
        said = [(stated(each.arguments[0]), each.arguments[1].string) for each in probe.atoms("wrong", 2)]
        spare: set[str] = set()
        with_values = {fact for fact, why in said if not PREDICATE.search(why)}
        for fact, why in sorted(said, key=lambda each: each[1].startswith("this type has no furniture")):
            names = [str(each) for each in fact.arguments]
            error = self.at(fact, f"{fact}: {why}")
            if "type/1" in why and self._is_included(error):
                spare |= {*names} - types  # The grammar may leave out a type that an included file furnishes.
                continue
            if why.startswith("this type has no furniture") and (meant := closest(names[0], spare)):
                error = self.at(fact, f"{fact}: {why}. Did you mean {meant}, as included?")
            if not PREDICATE.search(why):
                place = (error.file, error.line, error.column, why)
                of_values.setdefault(place, Mistake(error, frozenset(names) & strange))
            elif fact not in with_values:
                known = types if "type/1" in why else ()
                name = next((each for each in names if each not in known), names[0])
                explains = {name} if ": see " in why else set[str]()
                absent.setdefault((name, why), Mistake(error, frozenset(explains)))
        values = list(of_values.values())
        for symbol in probe.atoms("twice", 2):
            facts = sorted(map(stated, symbol.arguments), key=self._place)
            first = self.at(facts[0], "")
            place = ""
            if first.line:
                place = f", at {self._grammar.name_of(Path(str(first.file)))}:{first.line}:{first.column}"
            why = f"{facts[1]}: {facts[0]} is stated too{place}: keep one of them"
            values.append(Mistake(self.at(facts[1], why)))
        return values, _renamed(absent)

    def _is_included(self, error: GrammarError) -> bool:
        return bool(error.line) and self._grammar.directory not in Path(str(error.file)).parents

    def misnamed(self, probe: Program) -> Iterator[Mistake]:
        """Yield a mistake for each type and piece whose name is no plain word."""
        pieces = [fact for name in ("may", "beside", "around") for fact in probe.atoms(name, 4)]
        for facts, place, what in (
            (probe.atoms("type", 1), 0, NO_NAME["type"]),
            (pieces, 1, NO_NAME["piece"]),
        ):
            for fact in sorted(facts):
                name = str(fact.arguments[place])
                if not NAME.fullmatch(name):
                    yield Mistake(self.at(fact, f"{name}: {what}"), frozenset(re.findall(r"\w+", name)))


def _renamed(absent: Mapping[tuple[str, str], Mistake]) -> list[Mistake]:
    """Return the mistakes about absent names.

    If one type is unknown and one has no furniture, they are likely the same type, renamed in some places.
    Then the mistakes say so.
    """
    unknown = {name for name, why in absent if "type/1" in why}
    empty = {name for name, why in absent if why.startswith("this type has no furniture")}
    if not (len(unknown) == len(empty) == 1):
        return list(absent.values())
    meant = f". Did you mean {min(empty)}, which has no furniture?"
    found = []
    for (name, _), mistake in absent.items():
        if name in unknown:
            error = mistake.error
            error = GrammarError(error.message + meant, error.file, error.line, error.column)
            found.insert(0, Mistake(error, frozenset(unknown | empty)))
        else:
            found.append(mistake)
    return found


def stated(fact: Symbol) -> Symbol:
    """Return the grammar's own fact; for companions the first argument is its name."""
    if fact.name != "companions":
        return fact
    return Function(fact.arguments[0].name, fact.arguments[1:])


def places(atom: Symbol, own: Words) -> list[Use]:
    """Return the heads that name a ground atom, in the files' order, or else those that may derive it."""

    def names(argument: Symbol, text: str) -> bool:
        return bool(re.search(rf"(?<!\w){re.escape(str(argument))}(?!\w)", text))

    def each_in_place(use: Use) -> bool:
        within = [str(argument) for argument in getattr(use.node, "arguments", ())]
        return len(within) == len(atom.arguments) and all(map(names, atom.arguments, within))

    heads = [use for (name, _), uses in own.derived.items() if name == atom.name for use in uses]
    named = [use for use in heads if all(names(each, str(use.node)) for each in atom.arguments)]
    rules = [use for use in heads if use.statement.node.body]
    return (
        [use for use in named if each_in_place(use)]
        or named
        or [use for use in rules if _may_be(use.node, atom, {})]
        or rules
    )


def _may_be(term: Any, value: Symbol, bound: dict[str, Symbol]) -> bool:
    """Return True if a term can have a value, by its form. Some of its variables are ``bound``."""
    if term.ast_type == ASTType.Variable:
        return term.name == "_" or bound.setdefault(term.name, value) == value
    if term.ast_type == ASTType.SymbolicTerm:
        return term.symbol == value
    if term.ast_type == ASTType.Pool:
        return any(_may_be(each, value, dict(bound)) for each in alternatives(term))
    if term.ast_type != ASTType.Function:
        return value.type == SymbolType.Number
    if value.type != SymbolType.Function or (term.name, len(term.arguments)) != (
        value.name,
        len(value.arguments),
    ):
        return not term.arguments and value.type == SymbolType.Number  # a constant such as rooms
    return all(_may_be(each, its, bound) for each, its in zip(term.arguments, value.arguments, strict=True))
