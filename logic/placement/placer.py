"""Stage 2, SWI-Prolog through pyswip: CLP(R) turns a layout into a house with coordinates in metres.

Each house takes one goal, with terms in and JSON out: see ``logic.placement.prolog``.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import msgspec
import numpy as np
from clingo import Symbol, parse_term
from msgspec.structs import replace

from vitruvius.logic.errors import GrammarError, OutOfInferences, Reason
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.includes import height
from vitruvius.logic.layout import account
from vitruvius.logic.layout.account import Account
from vitruvius.logic.layout.program import Conflict
from vitruvius.logic.placement import prolog
from vitruvius.logic.placement.compiled import CORE
from vitruvius.logic.placement.layout import Layout, RoomLayout
from vitruvius.logic.placement.plan import Pieces, Plan, StarPlan, UnitRange
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.fixed_rooms import FixedRoom

THOROUGH = "thorough"
"""Atom of a layout that stage 2 must decide thoroughly."""

S = TypeVar("S", Plan, UnitRange)


class Failure(Exception):
    """Layout that cannot become a house. ``logic.generation.loop`` excludes similar layouts."""


class Infeasible(Failure):
    """Proof that no sizes and places satisfy the rules for some rooms of a layout, or for a plan's walls."""

    def __init__(self, conflicts: Mapping[int, Conflict], inferences: int, undecided: bool = False) -> None:
        """Set the conflict in each room, by number, and the Prolog inferences of the proof.

        ``undecided``: there is neither a proof nor a solution, only this conflict.
        """
        super().__init__(f"rooms {list(conflicts)} are infeasible")
        self.conflicts, self.inferences, self.undecided = conflicts, inferences, undecided


class Misfit(Failure):
    """These rooms do not fit between the fixed rooms, or leave a main room no area.

    If ``infeasible`` is True, no other sizes fit either.
    """

    def __init__(self, infeasible: bool, inferences: int) -> None:
        """Set the Prolog inferences of the search."""
        super().__init__("the rooms do not fit together")
        self.infeasible, self.inferences = infeasible, inferences


class Placer:
    """Prolog engine of this process with one grammar's lengths."""

    _loaded: "ClassVar[Placer | None]" = None
    """Placer whose lengths the Prolog engine has loaded."""

    def __init__(self, grammar: Grammar, cell: float = 0.0) -> None:
        """Load the core and the grammar's ``.pl`` files, for houses on a grid if ``cell`` is not 0.

        ``cell`` is the side of a cell, metres. ``problems`` holds the mistakes in the files, as ``[file,
        line, column, text, name]``. The ``name`` is that of an unknown predicate, or empty.
        """
        self._grammar, self.cell = grammar, cell
        self.account = Account(self._located)
        prolog.load(CORE)
        self.kind_of_walls = "shared" if grammar.shares_walls else "apart"
        self.problems: list[list[Any]] = []
        self.load()

    def load(self) -> None:
        """Load the grammar's ``.pl`` files, which replace those of another grammar."""
        if Placer._loaded is not self:
            files = [_below_its_includes(file) for file in self._grammar.prolog]
            left_out = [Term("-", file, line) for file, line, _ in self._grammar.left_out]
            self.problems = self.ask("grammar_problems", files, left_out, self.kind_of_walls, self.cell)
            self._typical = {(file, line) for file, line in self.ask("grammar_typical")}
            Placer._loaded = self

    def place(
        self, layout: Layout, rng: np.random.Generator, inferences: int, minimal: bool = True
    ) -> StarPlan:
        """Place a layout, metres.

        Conflicts are ``minimal``, or else found five times as quickly. Raises ``Infeasible`` if the
        constraints have no solution, ``Misfit`` if the rooms do not fit together, ``LimitReached`` after this
        number of inferences, and ``GrammarError`` for a clause that does not end.
        """
        # Seeds for the rooms and the main room: passing thousands of numbers costs more than sampling them.
        rooms = [
            _fixed(room.number, room.fixed)
            if room.fixed
            else Term("room", room.number, room.type, room.side, room.furniture, room.seed)
            for room in layout.rooms
        ]
        self.account.at(account.LENGTHS, "the lengths of the rooms and of their furniture (CLP(R))")
        seed, proof = int(rng.integers(2**63)), "minimal" if minimal else "quick"
        answer = self.ask("placed", Term("layout", rooms, layout.corners, seed, proof), inferences)
        if "wrong" in answer:
            file, line, column, text = answer["wrong"]
            raise GrammarError(text, file, line, column)
        if "limit" in answer:
            raise OutOfInferences
        if "misfit" in answer:
            raise Misfit(answer["misfit"], answer["inferences"])
        if "infeasible" in answer:
            raise Infeasible(
                {room: _conflict(why) for room, why in answer["infeasible"]}, answer["inferences"]
            )
        return msgspec.convert(answer, StarPlan)

    def area_conflict(
        self, layout: Layout, fixed: Sequence[FixedRoom], types: Iterable[str], without: Iterable[Symbol] = ()
    ) -> Conflict | None:
        """Return the conflict of a star with these types and sides with the stated area, or None."""
        rooms = [
            Term(
                "fixed",
                fixed.index(room.fixed),
                room.number,
                room.side,
                float(room.fixed.width),
                float(room.fixed.depth),
            )
            if room.fixed
            else Term("room", room.number, room.type, room.side)
            for room in layout.rooms
        ]
        reasons = self.ask("layout_area_conflict", rooms, layout.corners, types, without)
        return None if reasons is None else _conflict(reasons)

    def walls(
        self,
        layout: Iterable[Symbol],
        seed: int,
        inferences: int,
        given: Iterable[Term] = (),
        thorough: bool = False,
    ) -> Plan:
        """Place the walls, doors and windows of a plan, metres, with the ``given`` places: ``plans.pl``.

        ``thorough`` considers all sizes that an area allows, and takes longer. Raises ``Infeasible`` for room
        0 if the constraints have no solution, proved in rational arithmetic, and ``LimitReached`` after this
        number of inferences.
        """
        self.account.at(account.LENGTHS, "the lengths of walls (CLP(R))")
        plan = Term("plan", [*layout, *([THOROUGH] if thorough else [])], list(given), seed, "minimal")
        placed = self._solved("plan_placed", plan, inferences, Plan)
        placed.wall_thickness = self.wall_thickness
        return placed

    @cached_property
    def wall_thickness(self) -> Thickness | None:
        """Thickness of walls that rooms share, or None for walls without thickness."""
        inner, outer = self.ask("wall_thicknesses")
        return Thickness(inner, outer) if outer else None

    def unit_range(self, layout: Iterable[Symbol], axis: str, depth: float, inferences: int) -> UnitRange:
        """Return the range of lengths of a unit with this depth along an axis, metres.

        Raises as ``walls`` does.
        """
        self.account.at(account.LENGTHS, "the lengths of a unit's walls (CLP(R))")
        unit = Term("unit", layout, axis, depth, "minimal")
        return self._solved("unit_extremes", unit, inferences, UnitRange)

    def _solved(self, predicate: str, asked: Term, inferences: int, kind: type[S]) -> S:
        """Return the walls in the answer of a predicate of ``plans.pl``."""
        answer = self.ask(predicate, asked, inferences)
        if "limit" in answer:
            raise OutOfInferences
        if "infeasible" in answer:
            raise Infeasible({0: _conflict(answer["infeasible"])}, answer["inferences"], "open" in answer)
        return msgspec.convert(answer, kind)

    def wall_conflict(
        self, layout: Iterable[Symbol], without: Iterable[Symbol], thorough: bool = False
    ) -> Conflict | None:
        """Return a minimal conflict of a plan's walls without some clauses, or None if they have places.

        ``thorough``: see ``walls``.
        """
        reasons = self.ask("plan_conflict", [*layout, *([THOROUGH] if thorough else [])], without)
        return None if reasons is None else _conflict(reasons)

    def furnish(
        self, rooms: Sequence[Any], inferences: int, minimal: bool = True
    ) -> tuple[list[Pieces | None], dict[int, Conflict], int]:
        """Furnish rooms of given sizes, terms as in ``rules/room/given_rooms.pl``.

        Returns the pieces of each room, or None; the conflict in each room that cannot have its furniture, by
        its index in ``rooms``; and the number of Prolog inferences. Raises ``LimitReached`` after
        ``inferences``.
        """
        proof = "minimal" if minimal else "quick"
        answer = self.ask("rooms_furnished", rooms, proof, inferences)
        if "limit" in answer:
            raise OutOfInferences
        conflicts = {place: _conflict(why) for place, why in answer["infeasible"]}
        return msgspec.convert(answer["rooms"], list[Pieces | None]), conflicts, answer["inferences"]

    def loose_conflict(self, room: Term, without: Iterable[Symbol] = ()) -> Conflict | None:
        """Return a minimal conflict, without some clauses, of a room whose doors may move, or None."""
        reasons = self.ask("loose_room_conflict", room, without)
        return None if reasons is None else _conflict(reasons)

    def loose_starts(self, room: Term, seed: int) -> list[list[float]]:
        """Return the starts of the doors on each wall of such a room, metres, if it has no conflict."""
        return self.ask("loose_room_starts", room, seed)

    def pieces(self, room: RoomLayout) -> list[tuple[str, Symbol]]:
        """Return the pieces and companions of a room in a house file's order: type and atom of stage 1."""
        found = self.ask("room_pieces", room.type, room.furniture, room.given)
        return [(type_, parse_term(atom)) for type_, atom in found]

    def origins(self, clauses: Iterable[Symbol]) -> dict[Symbol, tuple[str, int]]:
        """Return file and line of the clauses that the grammar states, named as in ``Conflict``."""
        found = self.ask("grammar_origins", clauses)
        return {parse_term(clause): (file, line) for clause, file, line in found}

    def _located(self, clauses: Iterable[Symbol]) -> dict[Symbol, Reason]:
        """Return clauses with their text and places."""
        return {clause: located(*place) for clause, place in self.origins(clauses).items()}

    def conflict(
        self, type_: Symbol, furniture: Iterable[Symbol], without: Iterable[Symbol]
    ) -> Conflict | None:
        """Return a minimal conflict of a room with this furniture, without some clauses, or None."""
        reasons = self.ask("room_conflict", type_, furniture, without)
        return None if reasons is None else _conflict(reasons)

    def reason(self, file: str, line: int) -> Reason:
        """Return the clause at a line, marked if it is typical."""
        return replace(located(file, line), typical=(file, line) in self._typical)

    def version(self) -> str:
        """Return SWI-Prolog's version, as in 9.0.4."""
        number = self.ask("solver_version")
        return f"{number // 10000}.{number // 100 % 100}.{number % 100}"

    def ask(self, predicate: str, *arguments: Any) -> Any:
        """Call ``prolog.ask``. An error that a predicate raises is a fault of the grammar."""
        try:
            return prolog.ask(predicate, *arguments)
        except prolog.PrologError as error:
            raise GrammarError(f"a clause raises an error: {error}", self._grammar.directory) from None


def located(file: str, line: int) -> Reason:
    """Return the clause at a line, with its source from its first line to the full stop."""
    with open(file, encoding="utf-8") as rules:
        lines = rules.read().split("\n")[line - 1 :]
    text = ""
    for part in lines:
        text += " " + part.partition("%")[0].strip()
        if text.endswith("."):
            break
    return Reason(" ".join(text.split()), file, line, 1)


def _below_its_includes(file: Path) -> str | Term:
    """Return a file for ``rules/language/written.pl``, with the number of lines that hold its includes."""
    lines = height(file.read_text("utf-8", "replace"), file.suffix)
    return Term("-", str(file), lines) if lines else str(file)


def _fixed(number: int, room: FixedRoom) -> Term:
    size, place = Term("size", room.width, room.depth, room.door), Term("at", room.along, room.wall)
    return Term("fixed", number, room.side, size, place)


def _conflict(reasons: Iterable[tuple[str, str]]) -> Conflict:
    """Return a conflict from SWI-Prolog's reasons by kind: an atom that holds or fails, or a clause."""
    terms = [(kind, parse_term(text)) for kind, text in reasons]
    return Conflict(
        {term: kind == "holds" for kind, term in terms if kind != "clause"},
        tuple(term for kind, term in terms if kind == "clause"),
    )
