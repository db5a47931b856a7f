"""Stage 2, SWI-Prolog through pyswip: CLP(R) turns a layout into a house with coordinates in metres.

One goal a house, terms in and JSON out: see ``logic.placement.prolog``.
"""

from collections import defaultdict
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from clingo import Function, Symbol, parse_term

from logic.errors import GrammarError, OutOfInferences, Reason
from logic.grammar import LENGTHS, RULES, Grammar
from logic.house.parts import OUTSIDE, Rect
from logic.includes import height
from logic.layout import account
from logic.layout.account import Account
from logic.layout.program import Conflict
from logic.placement import prolog
from logic.placement.plan import Pieces, Plan, PlanDoor, PlanWindow, StarPlan, UnitRange
from logic.placement.prolog import Term
from logic.request.fixed_rooms import FixedRoom
from logic.request.given_plan import OwnPlan

S = TypeVar("S", Plan, UnitRange)


@dataclass(frozen=True)
class RoomLayout:
    """One room of a layout: its number, type and side, the atoms that furnish it, the seed of its lengths.

    ``given`` is what is known of it before, its size and doors: see ``rules/room/given_rooms.pl``.
    """

    number: int
    type: Symbol
    side: Symbol
    furniture: Sequence[Symbol]
    seed: int = 0
    fixed: FixedRoom | None = None
    given: Term | str = "any"


@dataclass(frozen=True)
class Layout:
    """An answer of stage 1: the rooms, clockwise, and which side may stand out past each corner."""

    rooms: Sequence[RoomLayout]
    corners: Sequence[Symbol]


class Infeasible(Exception):
    """Proved: no sizes and places satisfy the rules for these rooms of a layout, or for a plan's walls."""

    def __init__(self, conflicts: Mapping[int, Conflict], inferences: int) -> None:
        """Keep the conflict in each room, by number, and the Prolog inferences that the proof took."""
        super().__init__(f"rooms {list(conflicts)} are infeasible")
        self.conflicts, self.inferences = conflicts, inferences


class Misfit(Exception):
    """These rooms do not fit between the fixed rooms, or leave a main room no area; where that is infeasible,
    no other sizes do either.
    """

    def __init__(self, infeasible: bool, inferences: int) -> None:
        """Keep the Prolog inferences that it took."""
        super().__init__("the rooms do not fit together")
        self.infeasible, self.inferences = infeasible, inferences


class Placer:
    """The Prolog engine of this process with one grammar's lengths."""

    def __init__(self, grammar: Grammar, cell: float = 0.0) -> None:
        """Load the core and the grammar's ``.pl`` files, for houses on a grid of such cells (m) if not 0.

        ``problems`` holds what is wrong with them, as ``[file, line, column, text, name]``: the ``name`` of a
        predicate that is not known, or empty.
        """
        self._directory = grammar.directory
        self.account = Account(self._located)
        prolog.load(RULES / "core.pl")
        files = [_below_its_includes(file) for file in grammar.prolog]
        self._walls = "shared" if grammar.shares_walls else "apart"
        self.problems: list[list[Any]] = self._ask("grammar_problems", files, self._walls, cell)

    def lengths(
        self, furniture: Mapping[str, Iterable[str]], turned: Container[str] = ()
    ) -> tuple[dict[str, Any], list[GrammarError], list[Symbol]]:
        """The named lengths, and the extremes of each room type and its pieces, in metres.

        ``{"lengths": {name: m}, "rooms": {type: extremes}, "pieces": {type: {piece: extremes}}}``, where
        extremes are ``[least width, greatest width, least depth, greatest depth]``; an error for each clause
        that is of no use; and the clauses that are absent, named as in ``Conflict``. Pieces that may be
        ``turned`` need no wall as long as they are.
        """
        wanted = [
            Term("furniture", type_, [Term("piece", p, "true" if p in turned else "false") for p in pieces])
            for type_, pieces in furniture.items()
        ]
        report = self._ask("grammar_lengths", wanted, LENGTHS)
        wrong: list[Any] = []
        absent: list[Symbol] = []

        def used(kind: str, names: Iterable[str], value: Any) -> Any:
            if value is None:
                absent.append(Function(kind, [Function(name) for name in names]))
            elif isinstance(value, dict):
                wrong.append(value["wrong"])
            return value

        named = {name: used("length", [name], value) for name, value in report["lengths"]}
        rooms, extents = {}, {}
        for type_, room, each in report["types"]:
            rooms[type_] = used("size", [type_], room)
            extents[type_] = {piece: used("size", [type_, piece], extent) for piece, extent in each}
        return {"lengths": named, "rooms": rooms, "pieces": extents}, _first_at_each_place(wrong), absent

    def disagreements(self, types: Mapping[str, bool], units: bool, most_rooms: int) -> list[GrammarError]:
        """What is wrong with lengths that only some grammars state, and between lengths: ``agreement.pl``.

        ``types`` have a size, each with whether such rooms have windows; houses are with or without units.
        """
        topology = Term("topology", self._walls, "true" if units else "false", most_rooms)
        rooms = [Term("room", type_, "true" if lit else "false") for type_, lit in types.items()]
        return _first_at_each_place(self._ask("grammar_disagreements", topology, rooms))

    def metres(self, types: Iterable[str]) -> dict[str, Any]:
        """``lengths`` by name (m), and ``areas`` of these room types (square metres), as they are written."""
        return self._ask("grammar_metres", LENGTHS, list(types))

    def sized(self) -> list[tuple[str, str, str, int, int]]:
        """Predicate, name, file, line and column of each clause that gives a room or piece type its size."""
        return [tuple(row) for row in self._ask("grammar_sized")]

    def place(
        self, layout: Layout, rng: np.random.Generator, inferences: int, minimal: bool = True
    ) -> StarPlan:
        """Place a layout, metres.

        Conflicts are ``minimal``, or else found five times as quickly.

        Raises ``Infeasible`` where the constraints have no solution, ``Misfit`` where the rooms do not fit
        together, ``LimitReached`` past this number of inferences, ``GrammarError`` for a
        clause that does not end.
        """
        # Seeds for the rooms and the main room: thousands of numbers cost more to pass than to sample.
        rooms = [
            _fixed(room.number, room.fixed)
            if room.fixed
            else Term("room", room.number, room.type, room.side, room.furniture, room.seed)
            for room in layout.rooms
        ]
        self.account.at(account.LENGTHS, "the lengths of the rooms and of their furniture (CLP(R))")
        seed, proof = int(rng.integers(2**63)), "minimal" if minimal else "quick"
        answer = self._ask("placed", Term("layout", rooms, layout.corners, seed, proof), inferences)
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

    def wall_lengths(self, types: Iterable[str]) -> list[Any]:
        """How much wall a door takes, how much rooms share that share one, and the extremes of each room
        type's size, metres: ``plans.pl``.
        """
        return self._ask("plan_lengths", types)

    def areas(self, types: Iterable[str]) -> list[Any]:
        """The least and greatest area of the house; type, areas and widths of each type of room. In metres
        and square metres, and empty where no area of the house is stated: ``totals.pl``.
        """
        return self._ask("house_areas", types)

    def area_conflict(
        self,
        layout: Iterable[Symbol],
        fixed: Sequence[FixedRoom],
        types: Iterable[str],
        without: Iterable[Symbol] = (),
    ) -> Conflict | None:
        """Why no star with these types and sides has the area that is stated; None where some may have it."""
        named = defaultdict[str, dict[int, Symbol]](dict)
        corners = []
        for atom in layout:
            if atom.name == "corner":
                corners.append(atom)
            elif atom.name in {"room", "side", "numbered"}:
                number, value = atom.arguments if atom.name != "numbered" else reversed(atom.arguments)
                named[atom.name][number.number] = value
        rooms = []
        for number, type_ in sorted(named["room"].items()):
            side, place = named["side"][number], named["numbered"].get(number)
            if place is None:
                rooms.append(Term("room", number, type_, side))
            else:
                its = fixed[place.number]
                rooms.append(Term("fixed", place.number, number, side, float(its.width), float(its.depth)))
        reasons = self._ask("layout_area_conflict", rooms, corners, types, without)
        return None if reasons is None else _conflict(reasons)

    def walls(self, layout: Iterable[Symbol], seed: int, inferences: int, given: Iterable[Term] = ()) -> Plan:
        """Place the walls, doors and windows of a plan, metres, with what is ``given``: ``plans.pl``.

        Raises ``Infeasible`` for room 0 where the constraints have no solution, proved in rational
        arithmetic, ``LimitReached`` past this number of inferences.
        """
        self.account.at(account.LENGTHS, "the lengths of walls (CLP(R))")
        plan = Term("plan", layout, list(given), seed, "minimal")
        return self._solved("plan_placed", plan, inferences, Plan)

    def unit_range(self, layout: Iterable[Symbol], axis: str, depth: float, inferences: int) -> UnitRange:
        """How long a unit may be that is this deep along an axis, metres.

        Raises as ``walls``.
        """
        self.account.at(account.LENGTHS, "the lengths of a unit's walls (CLP(R))")
        unit = Term("unit", layout, axis, depth, "minimal")
        return self._solved("unit_extremes", unit, inferences, UnitRange)

    def unit_depths(self) -> tuple[float, float] | None:
        """How deep units may be, metres; None where no clause bounds it."""
        range_ = self._ask("unit_depths")
        return range_ and tuple(range_)

    def _solved(self, predicate: str, asked: Term, inferences: int, kind: type[S]) -> S:
        """What walls are, as a predicate of ``plans.pl`` answers."""
        answer = self._ask(predicate, asked, inferences)
        if "limit" in answer:
            raise OutOfInferences
        if "infeasible" in answer:
            raise Infeasible({0: _conflict(answer["infeasible"])}, answer["inferences"])
        return msgspec.convert(answer, kind)

    def wall_conflict(self, layout: Iterable[Symbol], without: Iterable[Symbol]) -> Conflict | None:
        """A minimal conflict of the walls of a plan, some clauses left out; None if they have places."""
        reasons = self._ask("plan_conflict", layout, without)
        return None if reasons is None else _conflict(reasons)

    def own_plan_faults(self, plan: OwnPlan, types: Iterable[str]) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
        """What the lengths forbid in a user's plan: facts of ``own.lp``, each with its clauses."""
        rooms = [
            Term("room", number, float(room.width), float(room.height))
            for number, room in enumerate(plan.rooms)
        ]
        west, north, east, south = plan.outline
        size = Term("size", float(east - west), float(south - north))
        doors = []
        for door in plan.doors:
            if wall := plan.wall_of(door):
                behind = wall.side if wall.behind is None else wall.behind
                doors.append(Term("door", wall.room, behind, float(door.length)))
        found = self._ask("own_plan_faults", size, rooms, _walls(plan), doors, types)
        return [(parse_term(fact), tuple(map(parse_term, clauses))) for fact, clauses in found]

    def own_openings(
        self, plan: OwnPlan, layout: Sequence[Symbol], seed: int
    ) -> tuple[list[PlanDoor], list[PlanWindow]]:
        """Doors and windows with their places in a plan of the user's, metres: see ``own_plan.pl``."""
        types = [Term("-", *atom.arguments) for atom in layout if atom.name == "room"]
        found = self._ask("own_openings", layout, types, _walls(plan), seed)
        return msgspec.convert((found["doors"], found["windows"]), tuple[list[PlanDoor], list[PlanWindow]])

    def furnish(
        self, rooms: Sequence[Any], inferences: int, minimal: bool = True
    ) -> tuple[list[Pieces | None], dict[int, Conflict], int]:
        """Furnish rooms of given sizes, terms as in ``rules/room/given_rooms.pl``.

        Gives the pieces of each room, or None; the conflict in each room that cannot have
        its furniture, by its place in ``rooms``; and the Prolog inferences that it took. Raises
        ``LimitReached`` past this number of them.
        """
        proof = "minimal" if minimal else "quick"
        answer = self._ask("rooms_furnished", rooms, proof, inferences)
        if "limit" in answer:
            raise OutOfInferences
        conflicts = {place: _conflict(why) for place, why in answer["infeasible"]}
        return msgspec.convert(answer["rooms"], list[Pieces | None]), conflicts, answer["inferences"]

    def loose_conflict(self, room: Term, without: Iterable[Symbol] = ()) -> Conflict | None:
        """A minimal conflict of a room of given size whose doors may move, some clauses left out, or None."""
        reasons = self._ask("loose_room_conflict", room, without)
        return None if reasons is None else _conflict(reasons)

    def loose_starts(self, room: Term, seed: int) -> list[list[float]]:
        """Where the doors of such a room start on each of its walls, metres, if it has no conflict."""
        return self._ask("loose_room_starts", room, seed)

    def pieces(self, room: RoomLayout) -> list[tuple[str, Symbol]]:
        """The pieces and companions of a room, as a house file lists them: type and atom of stage 1."""
        found = self._ask("room_pieces", room.type, room.furniture, room.given)
        return [(type_, parse_term(atom)) for type_, atom in found]

    def bounds(self, room: RoomLayout, target: Symbol, taken: float | None = None) -> dict[str, Any]:
        """What the lengths of a target in a room could have been, and which constraints bind: see core.pl.

        ``taken``: the area of all other rooms of a star, square metres, of whose area the room has the rest.
        """
        others = "any" if taken is None else float(taken)
        return self._ask("room_lengths", room.type, room.furniture, room.given, others, room.seed, target)

    def wall_bounds(
        self, layout: Iterable[Symbol], rooms: Sequence[Rect], number: int, outlined: bool = False
    ) -> dict[str, Any]:
        """What the sizes of a plan's room could have been, and which constraints bind: ``plan_bounds.pl``.

        ``outlined``: where the outline of the plan stays as it is.
        """
        west, north = min(room.x for room in rooms), min(room.y for room in rooms)
        boxes = [
            Term(
                "box",
                place,
                *(float(x - west) for x in room.box[::2]),
                *(float(y - north) for y in room.box[1::2]),
            )
            for place, room in enumerate(rooms)
        ]
        ends = {"west": 0.0, "north": 0.0}
        ends["east"] = float(max(room.x + room.width for room in rooms) - west)
        ends["south"] = float(max(room.y + room.height for room in rooms) - north)
        lines = [Term("at", Function("outline", [Function(side)]), place) for side, place in ends.items()]
        return self._ask("plan_room_lengths", layout, lines if outlined else [], boxes, number)

    def opening_lengths(self, type_: str, start: float, end: float) -> dict[str, Any]:
        """Lengths (m) of a door, and of a window of a room of this type, in a wall: ``plan_bounds.pl``."""
        return self._ask("opening_lengths", type_, float(start), float(end))

    def main_bounds(
        self, rooms: Iterable[FixedRoom], corners: Iterable[Symbol], width: float
    ) -> dict[str, Any]:
        """What the main room's lengths could have been around rooms of these sizes: see core.pl."""
        outlines = [Term("outline", room.side, room.width, room.depth, room.door) for room in rooms]
        return self._ask("main_lengths", outlines, corners, width)

    def origins(self, clauses: Iterable[Symbol]) -> dict[Symbol, tuple[str, int]]:
        """File and line of clauses, named as in ``Conflict``; those that the grammar states."""
        found = self._ask("grammar_origins", clauses)
        return {parse_term(clause): (file, line) for clause, file, line in found}

    def _located(self, clauses: Iterable[Symbol]) -> dict[Symbol, Reason]:
        """Clauses with their text, by where they stand."""
        return {clause: located(*place) for clause, place in self.origins(clauses).items()}

    def conflict(
        self, type_: Symbol, furniture: Iterable[Symbol], without: Iterable[Symbol]
    ) -> Conflict | None:
        """A minimal conflict of a room with this furniture, some clauses left out; None if it has places."""
        reasons = self._ask("room_conflict", type_, furniture, without)
        return None if reasons is None else _conflict(reasons)

    def version(self) -> str:
        """SWI-Prolog's version, as in 9.0.4."""
        number = self._ask("solver_version")
        return f"{number // 10000}.{number // 100 % 100}.{number % 100}"

    def _ask(self, predicate: str, *arguments: Any) -> Any:
        """As ``prolog.ask``; an error that a predicate raises is a fault of the grammar's."""
        try:
            return prolog.ask(predicate, *arguments)
        except prolog.PrologError as error:
            raise GrammarError(f"a clause raises an error: {error}", self._directory) from None


def located(file: str, line: int) -> Reason:
    """The clause at a line, with its source from its first line to the full stop."""
    with open(file, encoding="utf-8") as rules:
        lines = rules.read().split("\n")[line - 1 :]
    text = ""
    for part in lines:
        text += " " + part.partition("%")[0].strip()
        if text.endswith("."):
            break
    return Reason(" ".join(text.split()), file, line, 1)


def _below_its_includes(file: Path) -> str | Term:
    """A file for ``rules/language/written.pl``."""
    lines = height(file.read_text("utf-8", "replace"), file.suffix)
    return Term("-", str(file), lines) if lines else str(file)


def _first_at_each_place(wrong: Iterable[Sequence[Any]]) -> list[GrammarError]:
    """Errors of ``[file, line, column, text]``: one clause may be wrong in each of several types of room."""
    errors = {}
    for file, line, column, text in wrong:
        errors.setdefault((file, line, column), GrammarError(text, file, line, column))
    return list(errors.values())


def _fixed(number: int, room: FixedRoom) -> Term:
    size, place = Term("size", room.width, room.depth, room.door), Term("at", room.along, room.wall)
    return Term("fixed", number, room.side, size, place)


def _walls(plan: OwnPlan) -> list[Term]:
    return [
        Term(
            "wall",
            wall.room,
            wall.side,
            OUTSIDE if wall.behind is None else wall.behind,
            *map(float, (wall.place, wall.start, wall.end)),
        )
        for wall in plan.walls
    ]


def _conflict(reasons: Iterable[tuple[str, str]]) -> Conflict:
    """Reasons as SWI-Prolog gives them, by kind: an atom that holds or fails, a clause."""
    terms = [(kind, parse_term(text)) for kind, text in reasons]
    return Conflict(
        {term: kind == "holds" for kind, term in terms if kind != "clause"},
        tuple(term for kind, term in terms if kind == "clause"),
    )
