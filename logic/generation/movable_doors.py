"""Rooms of a user's plan whose doors may move within their walls, and proofs that they have no furniture.

A room has finitely many layouts. Each layout that CLP(Q) refutes for all places of the doors becomes a nogood
with its reasons. If no layout is left, the room is refuted.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from clingo import Symbol
from msgspec import structs

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.furnish import Frame, GivenRoom, Span
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.layout.program import Nogood, TooMany
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.layout.terms import granted
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import article

MOST_LAYOUTS = 500
"""Number of refuted layouts of one room after which the room stays undecided."""

ALONG = {"north": (1, -1), "east": (1, 1), "south": (-1, 1), "west": (-1, -1)}
"""Directions in which x and y of the house run along the walls, for each side of a frame."""


class LooseRoom(Frame):
    """Room of given size with its doors and windows; doors with a span may stand anywhere within the span."""

    def __init__(self, room: GivenRoom, spans: Sequence[Rect | None]) -> None:
        """Set for each door the part of a wall in which it may stand, or None if it may not move."""
        super().__init__(room)
        self.room = room
        self._places = [self.place(door) for door in room.doors]
        self._spans = [self.place(span)[1] if span else None for span in spans]

    @property
    def earliest(self) -> dict[str, list[Span]]:
        """Spans of the doors of each wall, with each door at the near end of its range."""
        return self._doors([span and span[0] for span in self._spans])

    @property
    def latest(self) -> dict[str, list[Span]]:
        """Spans of the doors of each wall, with each door at the far end of its range."""
        widths = [end - start for _, (start, end) in self._places]
        return self._doors(
            [span and span[1] - width for span, width in zip(self._spans, widths, strict=True)]
        )

    def _doors(self, starts: Sequence[float | None]) -> dict[str, list[Span]]:
        doors: dict[str, list[Span]] = {wall: [] for wall in self.doors}
        for (wall, (start, end)), at in zip(self._places, starts, strict=True):
            doors[wall].append((start, end) if at is None else (at, at + end - start))
        return {wall: sorted(spans) for wall, spans in doors.items()}

    def loose_term(self, furniture: Iterable[Symbol]) -> Term:
        """Return the room for ``rules/room/given_rooms.pl``."""
        doors: dict[str, list[Term]] = {wall: [] for wall in self.doors}
        for place in sorted(range(len(self._places)), key=lambda place: self._places[place][1]):
            (wall, (start, end)), span = self._places[place], self._spans[place]
            at = Term("span", float(span[0]), float(span[1])) if span else float(start)
            doors[wall].append(Term("-", at, float(end - start)))
        size = Term("-", float(self.width), float(self.depth))
        return Term("room", 0, self.room.type, [*furniture], 0, size, Term("doors", *doors.values()), "none")

    def moved(self, starts: Sequence[Sequence[float]]) -> list[Rect]:
        """Return the doors with these starts on each wall, metres, as seen in the room's frame."""
        by_wall = dict(zip(self.doors, starts, strict=True))
        doors = []
        for door, (wall, span) in zip(self.room.doors, self._places, strict=True):
            by = by_wall[wall][self.doors[wall].index(span)] - span[0]
            x, y = ALONG[self.side]
            place = {"x": door.x + x * by} if door.width > door.height else {"y": door.y + y * by}
            doors.append(structs.replace(door, **place))
        return doors

    def furniture(
        self,
        programs: Programs,
        placer: Placer,
        rng: np.random.Generator,
        request: HouseRequest,
        windows: bool,
    ) -> list[Symbol] | None:
        """Return a layout that fits for some places of the doors, or None if provably none does.

        ``windows`` keeps the windows where they are; otherwise they may be anywhere. Raises ``LimitReached``
        after ``MOST_LAYOUTS``.
        """
        required = programs.required_in(self.room.type, request)
        program = programs.given(self.room.type, self.facts(), required, rng)
        holds, fails = self.given(windows)
        nogoods: list[Nogood] = []
        while len(nogoods) < MOST_LAYOUTS:
            try:
                layout = program.sample(rng, [*holds, *map(granted, required)], fails, nogoods)
            except TooMany:
                break
            if layout is None:
                return None
            conflict = placer.loose_conflict(self.loose_term(layout))
            if conflict is None:
                return layout
            nogoods.append(conflict.atoms)
        raise LimitReached(f"{len(nogoods)} layouts of {self.room} have no places, and there may be more")


class OneDoor(LooseRoom):
    """Room of given size with one door, anywhere in the walls along an axis, and with any windows.

    More doors leave less of its walls. If this room cannot be furnished, no room of its type and size can be
    in any plan.
    """

    def __init__(self, room: GivenRoom, axis: str) -> None:
        """Take the type and size of a room."""
        west, north, east, south = room.rect.box
        wall = Rect(west, south, east - west, 0.0) if axis == "x" else Rect(east, north, 0.0, south - north)
        super().__init__(GivenRoom(room.type, room.rect, [wall]), [None])

    @property
    def earliest(self) -> dict[str, list[Span]]:
        """Span of the door at the near end of its wall, without width."""
        return self.doors | {"front": [(0.0, 0.0)]}

    @property
    def latest(self) -> dict[str, list[Span]]:
        """Span of the door at the far end of its wall, without width."""
        return self.doors | {"front": [(self.width, self.width)]}

    def loose_term(self, furniture: Iterable[Symbol]) -> Term:
        """Return the room for ``rules/room/given_rooms.pl``."""
        size = Term("-", float(self.width), float(self.depth))
        return Term("room", 0, self.room.type, [*furniture], 0, size, "any", "none")


@dataclass(frozen=True)
class Refuted:
    """Proof that a room of a plan cannot have its furniture as this type with these doors."""

    name: str
    room: LooseRoom
    windows: bool
    """True if the windows are part of the proof."""
    atoms: Nogood
    """Atoms of stage 1: the type, the doors, and the windows if they are part of the proof."""
    grants: tuple[Symbol, ...]
    """Parts of the plan in the proof: the room's place, and the rooms and doors that it depends on."""

    def __str__(self) -> str:
        """Return the proof as a statement."""
        return f"{self.name} cannot have the furniture that {article(self.room.room.type)} needs"
