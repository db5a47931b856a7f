"""A grammar's rule files, read without running them: what they state, or what is wrong with them."""

import re
from collections.abc import Iterator
from typing import Any

from clingo import Function, Symbol

from logic.audit import audit
from logic.errors import GrammarError
from logic.grammar import Grammar
from logic.layout import Program
from logic.placement import Placer, unknown
from logic.programs import Programs
from logic.spelling import closest
from logic.terms import Lengths, length_facts
from logic.units import unlikely
from logic.vocabulary import misspelt, place_of


class LoadedGrammar:
    """What a grammar states, read in the order in which one mistake hides another."""

    def __init__(self, grammar: Grammar, cell: float = 0.0) -> None:
        """Load the files, for houses on a grid of such cells (m) if not 0.

        ``errors`` is what is wrong with them: the rest stands only where it is empty. ``warnings`` are about
        lengths that are no likely number of metres.
        """
        self._grammar = grammar
        self.placer = Placer(grammar, cell)
        self.types: list[Symbol] = []
        self.furniture: dict[str, list[str]] = {}
        self._extremes: dict[str, Any] = {}
        self.errors = [*audit(grammar.asp), *self.placer.problems] or list(self._errors())
        self.lengths: Lengths = {} if self.errors else length_facts(self._extremes)
        self.warnings = [] if self.errors else list(unlikely(self._extremes, self.placer.origins))
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
        wrong = [*self._wrong(probe), *misspelt(self._grammar.asp, (name for _, name, *_ in sized))]
        yield from wrong
        if not self.types:
            yield GrammarError("no room type: state type/1 in a .lp file", self._grammar.directory)
        if wrong or unnamed or not self.types:
            return
        self.furniture = _furniture(probe)
        turned = {str(symbol.arguments[0]) for symbol in probe.atoms("turns", 2)}
        turned |= {str(symbol.arguments[1]) for symbol in probe.atoms("around", 4)}
        self._extremes, errors, absent = self.placer.lengths(self.furniture, turned)
        yield from errors
        yield from {str(error): error for error in map(self._absent, absent)}.values()
        names = {
            "room_size": set(self.furniture),
            "piece_size": {p for ps in self.furniture.values() for p in ps},
        }
        for predicate, name, file, line, column in sized:
            if name not in names[predicate]:
                kind = "room type: see type/1" if predicate == "room_size" else "piece in any room: see may/4"
                meant = closest(name, names[predicate])
                hint = f". Did you mean {meant}?" if meant else ""
                yield unknown(name, f"{predicate}: {name} is no {kind}{hint}", file, line, column)

    def _absent(self, clause: Symbol) -> GrammarError:
        """An error for a clause that no ``.pl`` file states: at the fact that calls for it."""
        if clause.name == "length":
            name = clause.arguments[0].name
            hint = f"{name}/1 has no clause: add one, as {name}(0.5). for half a metre"
            return GrammarError(hint, self._grammar.prolog[-1], 1, 1)
        *room, name = clause.arguments
        facts = [("type", [name])]
        if room:
            facts = [("may", [*room, name]), ("beside", [name]), ("around", [name])]
        why = f"{'piece_size/4' if room else 'room_size/3'} has no clause for {name}: add one to a .pl file"
        errors = [self._at(Function(predicate, names), why) for predicate, names in facts]
        return next((error for error in errors if error.line), errors[0])

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
