"""Furniture for the rooms of a plan whose sizes, doors and windows are given.

Each room has its own frame, as seen from its entrance: x to the right along the front wall, y inwards. Rooms
do not depend on each other. Therefore a room that cannot have its furniture is furnished again while the
others stay.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from math import floor
from typing import NamedTuple

import numpy as np
from clingo import Function, Number, Symbol, parse_term

from vitruvius.logic.errors import OutOfInferences
from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.layout.account import FURNITURE
from vitruvius.logic.layout.program import Nogood, Program, TooMany
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.terms import granted
from vitruvius.logic.placement.layout import RoomLayout
from vitruvius.logic.placement.placer import Failure, Placer
from vitruvius.logic.placement.plan import Pieces
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article, numbered

WALLS = {
    "front": ("front_left", "front_right"),
    "left": ("left_front", "left_back"),
    "back": ("back_left", "back_right"),
    "right": ("right_front", "right_back"),
}
"""Walls of a room in its own frame, each with its stretches before the first and after the last door."""

STEP, BITS = 0.016, 9
"""Unit of a wall's shortness in ``rules/room/doors.lp``, metres, and the number of its bits."""

LARGEST = Function("largest", [])
"""Atom of ``rules/room/doors.lp`` of a room that is the largest of its type."""

Span = tuple[float, float]
"""Start and end along a wall, metres, from the left or from the front."""


@dataclass(frozen=True)
class GivenRoom:
    """Unfurnished room of a plan, metres: its type, rectangle, doors and windows, as segments on its walls.

    The first door is its entrance, from which the furniture is seen.
    """

    type: str
    rect: Rect
    doors: Sequence[Rect]
    windows: Sequence[Rect] = ()
    pieces: Pieces | None = None
    """Furniture of a room that is already furnished."""
    drawn_windows: bool = False
    """True if a user drew the windows, which may be nearer to corners than the grammar's margin."""
    largest: bool = False
    """True if no other room of its type in the house, or in its unit, has a larger floor."""
    name: str = ""
    """Name of the room in its plan."""

    def __str__(self) -> str:
        """Return the room's type, size and number of doors."""
        size = f"{self.rect.width:.2f} by {self.rect.height:.2f} m"
        return f"{article(self.type)} of {size} with {numbered(len(self.doors), 'door')}"


class Unfurnishable(Failure):
    """Error for the room number ``place`` of a plan, which cannot have the furniture that its type needs."""

    def __init__(self, place: int, room: GivenRoom, decided: bool = True) -> None:
        """Keep the room and its number in the plan. Unless ``decided``, the room is likely unfurnishable."""
        found = f"{room} cannot have the furniture that it needs"
        super().__init__(found if decided else f"no furniture was found in time for {room}")
        self.place, self.room, self.decided = place, room, decided


class Frame:
    """Room as seen from its entrance."""

    def __init__(self, room: GivenRoom) -> None:
        """Find the walls of the doors and windows. Raises ``ValueError`` for one that lies on no wall."""
        west, north, east, south = room.rect.box
        entrance = room.doors[0].box
        sides = {"north": (west, south), "east": (west, north), "south": (east, north), "west": (east, south)}
        lines = {"north": (1, south), "east": (0, west), "south": (1, north), "west": (0, east)}
        on = [
            side
            for side, (axis, line) in lines.items()
            if max(abs(entrance[axis] - line), abs(entrance[axis + 2] - line)) < TOLERANCE
        ]
        if not on:
            raise ValueError(f"the entrance of the {room.type} is not on its walls")
        self.side = on[0]
        self.x, self.y = sides[self.side]
        across = self.side in ("north", "south")
        self.width = room.rect.width if across else room.rect.height
        self.depth = room.rect.height if across else room.rect.width
        self.doors = self._by_wall(room.doors, room.type)
        self.windows = self._by_wall(room.windows, room.type)
        self._drawn_windows, self._largest = room.drawn_windows, room.largest

    def _by_wall(self, segments: Sequence[Rect], type_: str) -> dict[str, list[Span]]:
        found: dict[str, list[Span]] = {wall: [] for wall in WALLS}
        for segment in segments:
            wall, span = self.place(segment, type_)
            found[wall].append(span)
        return {wall: sorted(spans) for wall, spans in found.items()}

    def place(self, segment: Rect, type_: str = "room") -> tuple[str, Span]:
        """Return the wall of a door or window, and its span there."""
        left, front, right, back = self._own(segment.box)
        if right - left > back - front:
            walls = {"front": front, "back": self.depth - back}
            span = (left, right)
        else:
            walls = {"left": left, "right": self.width - right}
            span = (front, back)
        wall = min(walls, key=lambda each: abs(walls[each]))
        if abs(walls[wall]) > TOLERANCE:
            raise ValueError(f"a door or window of the {type_} is not on its walls")
        return wall, span

    def _own(self, box: Box) -> Box:
        """Return a box of the house in the room's frame."""
        west, north, east, south = box
        match self.side:
            case "north":
                return west - self.x, self.y - south, east - self.x, self.y - north
            case "east":
                return north - self.y, west - self.x, south - self.y, east - self.x
            case "south":
                return self.x - east, north - self.y, self.x - west, south - self.y
            case _:
                return self.y - south, self.x - east, self.y - north, self.x - west

    def facts(self) -> tuple[Symbol, ...]:
        """Return facts for all doors but the entrance, and for distances of drawn windows from corners."""
        doorways = [
            Function("doorway", [Function(wall), Number(number)])
            for wall, spans in self.doors.items()
            for number in range(1, len(spans) + 1)
            if (wall, number) != ("front", 1)
        ]
        return (*doorways, *(self._near_windows() if self._drawn_windows else ()))

    def _near_windows(self) -> Iterator[Symbol]:
        for wall, spans in self.windows.items():
            across = wall in ("front", "back")
            corners = ("left", "right") if across else ("front", "back")
            size = self.width if across else self.depth
            for start, end in spans:
                for corner, gap in zip(corners, (start, size - end), strict=True):
                    near = Number(max(0, floor(1000 * gap)))
                    yield Function("near_window", [Function(wall), Function(corner), near])

    def lengths(self) -> Iterator[tuple[str, float]]:
        """Yield the room's width and depth, and the largest length of each stretch of wall, metres.

        The doors divide the walls into stretches.
        """
        yield "across", self.width
        yield "inwards", self.depth
        for wall, (first, last) in WALLS.items():
            size = self.width if wall in ("front", "back") else self.depth
            earliest, latest = self.earliest[wall], self.latest[wall]
            if not earliest:
                yield wall, size
                continue
            yield first, latest[0][0]
            for number, (one, other) in enumerate(zip(earliest, latest[1:], strict=False), start=1):
                yield f"between({wall},{number})", other[0] - one[1]
            yield last, size - earliest[-1][1]

    @property
    def earliest(self) -> dict[str, list[Span]]:
        """Spans of the doors of each wall, as near to its left or front end as possible."""
        return self.doors

    @property
    def latest(self) -> dict[str, list[Span]]:
        """Spans of the doors of each wall, as far from its left or front end as possible."""
        return self.doors

    def given(self, windows: bool = True) -> tuple[list[Symbol], list[Symbol]]:
        """Return what ``rules/room/doors.lp`` assumes about the room: atoms that hold, and atoms that fail.

        Without ``windows`` the windows may be anywhere, and no atom mentions them.
        """
        holds: dict[bool, list[Symbol]] = {True: [], False: []}
        holds[self._largest].append(LARGEST)
        for what, length in self.lengths():
            short = max(0, int(2**BITS - 1 - length / STEP))
            for bit, atom in enumerate(_bits(what)):
                holds[bool(short >> bit & 1)].append(atom)
        for wall, spans in self.windows.items():
            if windows:
                holds[bool(spans)].append(_at("window", wall))
            holds[self.earliest[wall] != self.latest[wall]].append(_at("loose", wall))
        return holds[True], holds[False]

    def shape(self) -> Term:
        """Return the room's size and doors for ``rules/room/given_rooms.pl``."""
        doors = [
            [Term("-", float(start), float(end - start)) for start, end in spans]
            for spans in self.doors.values()
        ]
        return Term("given", Term("-", float(self.width), float(self.depth)), Term("doors", *doors))

    def term(self, number: int, type_: str, furniture: Sequence[Symbol], seed: int) -> Term:
        """Return the room for ``rules/room/given_rooms.pl``."""
        frame = Term("frame", self.side, float(self.x), float(self.y))
        return Term("room", number, type_, furniture, seed, *self.shape().arguments, frame)


class Furnished(NamedTuple):
    """Origin of a room's furniture: the room, the program of stage 1, and its layout."""

    room: GivenRoom
    program: Program
    layout: RoomLayout


@cache
def _bits(what: str) -> list[Symbol]:
    """Return the atoms for the bits of a shortness."""
    return [Function("short", [parse_term(what), Number(bit)]) for bit in range(BITS)]


@cache
def _at(name: str, wall: str) -> Symbol:
    return Function(name, [Function(wall)])


def furnished(
    rooms: Sequence[GivenRoom],
    programs: Programs,
    placer: Placer,
    rng: np.random.Generator,
    inferences: int,
    request: HouseRequest | None = None,
    how: dict[int, Furnished] | None = None,
) -> list[Pieces]:
    """Furnish the rooms of an unfurnished plan. Return the pieces of each room, in the house's frame.

    The furniture satisfies the ``request`` if there is one. ``how`` receives the origin of each room's
    furniture.

    Raises ``Unfurnishable`` if a room provably cannot have what its type needs, and ``LimitReached`` after
    this number of Prolog inferences.
    """
    frames = [Frame(room) for room in rooms]
    pieces = [room.pieces or () for room in rooms]
    nogoods: list[list[Nogood]] = [[] for _ in rooms]
    waiting = [
        place for place, room in enumerate(rooms) if room.pieces is None and programs.has_furniture(room.type)
    ]
    required = {
        place: programs.required_in(rooms[place].type, request) if request else () for place in waiting
    }
    if programs.first:
        waiting.sort(key=lambda place: rooms[place].type not in programs.first and not required[place])
    kinds = [{piece.type for piece in own} for own in pieces]
    while waiting:
        terms = []
        for number, place in enumerate(waiting):
            room, frame = rooms[place], frames[place]
            holds, fails = frame.given()
            program = programs.given(room.type, frame.facts(), required[place], rng)
            holds += [granted(each) for each in required[place]]
            elsewhere = {kind for other, own in enumerate(kinds) if other != place for kind in own}
            for group, some in programs.groups.items():
                (fails if some.isdisjoint(elsewhere) else holds).append(Function("taken", [group]))
            placer.account.at(FURNITURE, f"the furniture of {room} (clingo)")
            try:
                furniture = program.sample(rng, holds, fails, nogoods[place])
            except TooMany:
                raise Unfurnishable(place, room, decided=False) from None
            if furniture is None:
                raise Unfurnishable(place, room)
            kinds[place] = {each.arguments[0].name for each in furniture if each.name == "on"}
            seed = int(rng.integers(2**63))
            terms.append(frame.term(number, room.type, furniture, seed))
            if how is not None:
                layout = RoomLayout(
                    place, Function(room.type), Function(frame.side), furniture, seed, given=frame.shape()
                )
                how[place] = Furnished(room, program, layout)
        named = ", ".join(str(rooms[place]) for place in waiting[:3]) + (" ..." if waiting[3:] else "")
        placer.account.at(FURNITURE, f"the lengths of the furniture of {named} (CLP(R))")
        again = any(nogoods[place] for place in waiting)
        found, conflicts, taken = placer.furnish(terms, inferences, minimal=again)
        inferences -= taken
        if inferences <= 0:
            raise OutOfInferences
        for number, place in enumerate(waiting):
            if number in conflicts:
                nogoods[place].append(conflicts[number].atoms)
                placer.account.refuted(conflicts[number].clauses, furniture=True)
            else:
                pieces[place] = found[number] or ()
        waiting = [waiting[number] for number in sorted(conflicts)]
    return pieces
