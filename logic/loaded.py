"""A grammar's rule files, read without running them: what they state, or what is wrong with them."""

import re
from collections.abc import Iterator
from typing import Any

from clingo import Function, Symbol

from logic.audit import audit
from logic.errors import GrammarError
from logic.grammar import Grammar
from logic.layout import Program
from logic.placement import Placer
from logic.programs import Programs
from logic.terms import Lengths, length_facts
from logic.vocabulary import misspelt, place_of


class LoadedGrammar:
    """What a grammar states, read in the order in which one mistake hides another."""

    def __init__(self, grammar: Grammar, cell: float = 0.0) -> None:
        """Load the files, for houses on a grid of such cells (m) if not 0.

        ``errors`` is what is wrong with them: the rest stands only where it is empty.
        """
        self._grammar = grammar
        self.placer = Placer(grammar, cell)
        self.types: list[Symbol] = []
        self.furniture: dict[str, list[str]] = {}
        self._extremes: dict[str, Any] = {}
        self.errors = [*audit(grammar.asp), *self.placer.problems] or list(self._errors())
        self.lengths: Lengths = {} if self.errors else length_facts(self._extremes)
        self.programs = Programs(grammar, self.furniture, self.lengths)

    def _errors(self) -> Iterator[GrammarError]:
        try:
            probe = Program(self._grammar.asp, {"rooms": 1}, [("house", [])])
        except GrammarError as error:
            yield error
            return
        sized = self.placer.sized()
        self.types = sorted(symbol.arguments[0] for symbol in probe.atoms("type", 1))
        unnamed = [type_ for type_ in self.types if not re.fullmatch("[a-z][A-Za-z0-9_]*", str(type_))]
        for type_ in unnamed:
            why = f"{type_}: a type is named by a word that begins in lower case, as in bedroom"
            yield self._at(Function("type", [type_]), why)
        wrong = [*self._wrong(probe), *misspelt(self._grammar.asp, (name for _, name, _, _ in sized))]
        yield from wrong
        if not self.types:
            yield GrammarError("no room type: state type/1 in a .lp file", self._grammar.directory)
        if wrong or unnamed or not self.types:
            return
        self.furniture = _furniture(probe)
        self._extremes, errors = self.placer.lengths(self.furniture)
        yield from errors
        names = {
            "room_size": set(self.furniture),
            "piece_size": {p for ps in self.furniture.values() for p in ps},
        }
        for predicate, name, file, line in sized:
            if name not in names[predicate]:
                kind = "room type: see type/1" if predicate == "room_size" else "piece in any room: see may/4"
                yield GrammarError(f"{predicate}: {name} is no {kind}", file, line, 1)

    def _wrong(self, probe: Program) -> Iterator[GrammarError]:
        """What the core's own rules find wrong with the grammar's facts (``rules/grammar.lp``)."""
        for symbol in probe.atoms("wrong", 2):
            fact, why = symbol.arguments
            if fact.name == "companions":  # of both kinds: the grammar's own fact is named by the first
                fact = Function(fact.arguments[0].name, fact.arguments[1:])
            yield self._at(fact, f"{fact}: {why.string}")

    def _at(self, fact: Symbol, why: str) -> GrammarError:
        """An error at the fact's place in the files."""
        file, line, column = place_of(fact, self._grammar.asp) or (self._grammar.directory, None, None)
        return GrammarError(why, file, line, column)


def _furniture(probe: Program) -> dict[str, list[str]]:
    """For each room type the pieces that it may have, and their companions."""
    furniture: dict[str, list[str]] = {str(symbol.arguments[0]): [] for symbol in probe.atoms("type", 1)}
    for symbol in probe.atoms("may", 4):
        furniture[str(symbol.arguments[0])].append(str(symbol.arguments[1]))
    for symbol in [*probe.atoms("beside", 4), *probe.atoms("around", 4)]:
        piece, companion = map(str, symbol.arguments[:2])
        for pieces in furniture.values():
            if piece in pieces and companion not in pieces:
                pieces.append(companion)
    return furniture
