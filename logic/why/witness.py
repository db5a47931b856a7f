"""Witness: a house that is generated again and whose layout is asked for its reasons.

This module is for all houses; ``star.py`` and ``shared_walls.py`` add the rest.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import msgspec
from clingo import Symbol, parse_term

from vitruvius.logic.errors import HouseFileError, Reason, RequestError
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.generation.loop import NoLayout
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import part_names
from vitruvius.logic.house.parts import Provenance
from vitruvius.logic.layout.terms import brief_requirements, granted
from vitruvius.logic.placement.bounds import room_bounds
from vitruvius.logic.placement.layout import RoomLayout
from vitruvius.logic.placement.placer import located
from vitruvius.logic.proofs.answer import unsatisfiable
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article
from vitruvius.logic.why.alternatives import Search, Tried
from vitruvius.logic.why.answer import Alternative, Bound, Choice, Length, Why
from vitruvius.logic.why.support import Support

Lengths = tuple[tuple[Length, ...], tuple[Bound, ...]]
"""Lengths, and the bounds that are tight."""


class Witness(ABC):
    """House that is generated again, with all atoms that held in the process."""

    def __init__(self, builder: Builder, house: House) -> None:
        """Generate the house again from its provenance. Raises ``HouseFileError`` if the result differs."""
        made = house.provenance
        assert made is not None
        self._builder, self._request, self._house = builder, HouseRequest.read(made.request), house
        self._origin = f"{made.grammar}, seed {made.seed}, house {made.index}"
        again, why = None, "it was edited"
        try:
            again = self._made_again(made)
        except NoLayout as found:
            why = str(unsatisfiable(found))
        except RequestError as error:
            why = str(error)
        parts = again and (again.rooms, again.doors, again.windows)
        if parts != (house.rooms, house.doors, house.windows):
            if made.versions != builder.versions:
                why = f"it was made by other versions, {made.versions}, not {builder.versions}"
            if made.grammar_hash != builder.grammar.hash:
                place = builder.grammar.directory
                why = f"others than those in {place} and the core made it: name its own by --grammar"
            raise HouseFileError(f"the rules do not make this house of {self._origin}: {why}")

    def why(self, target: str, until: float = math.inf) -> Why:
        """Return the whole explanation of a part of the house: see ``parts``."""
        found = self.parts(target, until)
        whole = next(found)
        for part in found:
            whole = whole.joined(part)
        return whole

    @abstractmethod
    def parts(self, target: str, until: float = math.inf) -> Iterator[Why]:
        """Yield the explanation of a part of the house, by its name (``part_names``), as it is found.

        The derivation comes first. Then come alternatives, for which the search ends at ``until``, of
        ``time.monotonic``.
        """

    @abstractmethod
    def _made_again(self, made: Provenance) -> House:
        """Return the house that is generated again, and store its origin."""

    def _answer(
        self,
        why: Why,
        support: Support,
        variables: Sequence[Symbol],
        lengths: Callable[[], Lengths],
        search: Callable[[], Search],
        until: float,
    ) -> Iterator[Why]:
        """Yield an answer, its lengths, and alternatives to the variables' values."""
        options = support.chosen.options
        yield msgspec.structs.replace(
            why, others=why.others + sum(len(options[each]) - 1 for each in variables)
        )
        found, tight = lengths()
        if found or tight:
            yield Why(why.target, "", lengths=found, tight=tight)
        yield from self._tried(why.target, search().choices(variables, until) if variables else ())

    def _tried(self, target: str, tried: Iterable[Tried]) -> Iterator[Why]:
        """Yield the findings about choices."""
        for choice, number in tried:
            yield Why(target, "", choices=() if choice is None else (choice,), tried=number)

    def _piece(
        self,
        target: str,
        room: RoomLayout,
        index: int,
        support: Support,
        search: Callable[[], Search],
        until: float,
    ) -> Iterator[Why]:
        """Yield the explanation of the place of a piece or a companion."""
        type_, atom = self._builder.placer.pieces(room)[index]
        piece = atom.arguments[:2]
        if atom.name == "with":
            atoms, subject = [atom], [*piece, atom.arguments[3]]
        else:
            own = [each for each in room.furniture if each.arguments[:2] == piece and each.name != "with"]
            atoms, subject = [atom, *(each for each in own if each != atom)], piece
        where = f"{self._house.counted[room.number].name}, {article(str(room.type))}"
        about = f"{article(str(type_))} in {where} ({self._origin})"
        why, own = Why(target, about, support.trees(atoms)), support.variables(subject)
        yield from self._answer(why, support, own, lambda: self._lengths(room, atom), search, until)

    def _furnishable(self, feasibility: Feasibility, choice: Choice) -> Choice:
        """Return a choice of a room's type in which types without possible furniture are impossible."""

        def judged(other: Alternative) -> Alternative:
            never = not (other.possible or other.also)
            if never or feasibility.is_furnishable(self._request, other.value):
                return other
            return Alternative(other.value, False, (), (Reason(f"no {other.value} can be furnished"),))

        return Choice(choice.name, choice.value, tuple(map(judged, choice.instead)))

    def _lengths(self, room: RoomLayout, target: Symbol, taken: float | None = None) -> Lengths:
        """Return the lengths of a target in a room, and the tight bounds on it: see ``room_bounds``."""
        types, atoms = zip(*self._builder.placer.pieces(room), strict=True)
        names = dict(zip(map(str, atoms), part_names(types), strict=True))
        return self._bounds(room_bounds(self._builder.placer, room, target, taken), names)

    def _bounds(self, found: Mapping[str, Any], names: Mapping[str, str]) -> Lengths:
        """Return lengths and tight bounds from SWI-Prolog (``why/bounds.pl``), with names in words."""
        lengths = tuple(
            Length(name, value, least, greatest, self._reasons(no_less), self._reasons(no_more))
            for name, value, least, no_less, greatest, no_more in found["lengths"]
        )
        # A length with only one value explains itself.
        single = [length.name for length in lengths if length.greatest - length.least < 1e-6]
        tight = tuple(
            Bound(_in_words(terms, relation, constant, names), self._reasons(reasons))
            for terms, relation, constant, reasons in found["binding"]
            if not (len(terms) == 1 and terms[0][2] in single)
        )
        return lengths, tight

    @cached_property
    def _brief(self) -> dict[str, str]:
        """Lines of the request's brief, by the atoms that represent them."""
        lines = brief_requirements(self._request.brief) if self._request.brief else ()
        return {str(granted(term)): words for words, terms in lines for term in terms}

    def _reasons(self, reasons: Iterable[tuple[str, str]]) -> tuple[Reason, ...]:
        """Return reasons from SWI-Prolog: clauses by their places, then atoms that hold and that fail."""
        clauses = [parse_term(text) for kind, text in reasons if kind == "clause"]
        places = self._builder.placer.origins(clauses)
        found = [located(*places[clause]) for clause in clauses if clause in places]
        found += [Reason(self._brief.get(text, text)) for kind, text in reasons if kind == "holds"]
        return (*found, *(Reason(f"not {text}") for kind, text in reasons if kind == "fails"))


def _in_words(
    terms: Iterable[tuple[float, str, str]], relation: str, constant: float, names: Mapping[str, str]
) -> str:
    """Return a sum that is at most zero, or zero, with its negative terms on the other side."""
    sides: dict[bool, list[str]] = {True: [], False: []}
    for factor, thing, what in terms:
        number = "" if abs(factor) == 1 else f"{abs(factor):.4g} "
        sides[factor > 0].append(f"{number}{names.get(thing, thing)}.{what}")
    if abs(constant) > 1e-9:
        sides[constant > 0].append(f"{abs(constant):.4g}")
    left, right = (" + ".join(sides[positive]) or "0" for positive in (True, False))
    return f"{left} {'=' if relation == '=' else '<='} {right}"
