"""Results of stage 2: unfurnished plans whose rooms share walls, and stars. Metres; rooms by number."""

from collections.abc import Mapping, Sequence

import msgspec
from msgspec import UNSET

from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Door, Piece, Rect, Room, Window
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.house.star import StarRoom

Pieces = tuple[Piece, ...]


class PlanRoom(Rect, frozen=True):
    """Room of a plan. Its ``number`` is stage 1's; doors and windows refer to its index in the plan."""

    number: int
    type: str
    name: str = ""
    """Own name; by default its index gives the name: ``R0``, ``R1``..."""
    pieces: Pieces | None = None
    """Furniture of a room that is furnished already and keeps it."""
    part_of: int | None = None
    """Index of the room that it is a part of."""


class PlanDoor(Rect, frozen=True):
    """Door between two rooms by their indices, or a room and ``outside``.

    It is the second room's entrance.
    """

    between: tuple[int | str, int | str]
    opening: bool = False


class PlanWindow(Rect, frozen=True):
    """Window of a room, by the room's index."""

    room: int


class Plan(msgspec.Struct):
    """Rooms that share walls, with their doors and windows."""

    rooms: list[PlanRoom]
    doors: list[PlanDoor]
    windows: list[PlanWindow]
    inferences: int = 0
    """Number of Prolog inferences that the plan took."""
    hub: str = ""
    wall_thickness: Thickness | None = None
    drawn_windows: bool = False
    """True if a user drew the windows, which may be nearer to corners than the grammar's margin."""

    @property
    def half_wall(self) -> float:
        """Half of an inner wall's thickness, metres: so far from a room are its doors and windows."""
        return self.wall_thickness.inner / 2 if self.wall_thickness else 0.0

    def join(self, parts: Mapping[int, int]) -> None:
        """Set the rooms of which other rooms are parts, by their numbers."""
        places = {room.number: place for place, room in enumerate(self.rooms)}
        for place, room in enumerate(self.rooms):
            if room.number in parts:
                self.rooms[place] = msgspec.structs.replace(room, part_of=places[parts[room.number]])

    def name(self, place: int) -> str:
        """Return the name of a room."""
        return self.rooms[place].name or f"R{place}"

    def between(self, door: PlanDoor) -> tuple[str, str]:
        """Return the names of the rooms that a door joins."""
        one, other = (each if isinstance(each, str) else self.name(each) for each in door.between)
        return one, other

    def doors_of(self, place: int) -> list[PlanDoor]:
        """Return the doors of a room, its entrance first."""
        doors = [door for door in self.doors if place in door.between]
        return sorted(doors, key=lambda door: door.between[0] != place)

    def windows_of(self, place: int) -> list[PlanWindow]:
        """Return the windows of a room."""
        return [window for window in self.windows if window.room == place]

    def house(self, pieces: Sequence[Pieces], topology: str) -> House:
        """Return the house of this plan and the furniture of its rooms."""
        rooms = [
            Room(
                *sides(room),
                self.name(place),
                room.type,
                within,
                part_of=UNSET if room.part_of is None else self.name(room.part_of),
            )
            for place, (room, within) in enumerate(zip(self.rooms, pieces, strict=True))
        ]
        doors = [Door(*sides(door), self.between(door), door.opening) for door in self.doors]
        windows = [Window(*sides(window), self.name(window.room)) for window in self.windows]
        return House(
            tuple(rooms),
            tuple(doors),
            tuple(windows),
            hub=self.hub,
            topology=topology,
            wall_thickness=self.wall_thickness,
        )


class UnitRange(msgspec.Struct):
    """Least and greatest length of a unit, metres, and the number of inferences that they took."""

    range: tuple[float, float]
    inferences: int


class StarPlan(msgspec.Struct):
    """Places of a star. ``rooms`` has None for fixed rooms, and ``corner`` is the main room's corner."""

    floor: Rect
    rooms: list[StarRoom | None]
    inferences: int
    corner: tuple[float, float] = (0.0, 0.0)
    sizes: list[tuple[int, float, float]] = []
    """Number, width and depth of rooms whose sizes follow from the area of the house."""


def sides(rect: Rect) -> tuple[float, float, float, float]:
    """Return x, y, width and height of a rectangle."""
    return rect.x, rect.y, rect.width, rect.height
