"""House: rooms, doors and windows, for every topology and file format."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Literal

import msgspec
import numpy as np

from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.occupancy import OccupancyGrid
from vitruvius.logic.house.parts import (
    FORMAT,
    MAIN,
    MAP,
    ORIGINAL,
    OUTSIDE,
    STAR,
    STAR_FORMAT,
    Door,
    FreeWall,
    Provenance,
    Room,
    Window,
)
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.house.records import Record, read
from vitruvius.logic.house.star import Star, star_record
from vitruvius.logic.house.topology_kinds import STARS, Kind, kind_of
from vitruvius.logic.house.walls import Line, doorway, walls_of_rooms, walls_of_star
from vitruvius.logic.plain import plain
from vitruvius.logic.spelling import unknown

PARAPET_M = 0.05
"""Thickness of the parapets around outdoor rooms, metres, in houses whose walls have none."""


class House(msgspec.Struct, frozen=True):
    """Furnished house, of any topology and any file format.

    ``hub`` names the room that the other rooms lie around, if there is one. ``topology`` names the rules for
    the arrangement of rooms. A star has its main room as its hub, last in ``rooms``; the others are named
    ``R0``, ``R1``... by their index.
    """

    rooms: tuple[Room, ...]
    doors: tuple[Door, ...] = ()
    windows: tuple[Window, ...] = ()
    hub: str = ""
    topology: str = ""
    format: Literal["vitruvius-1", "original", "vitruvius-2"] = FORMAT
    provenance: Provenance | None = None
    wall_thickness: Thickness | None = None
    """Thickness of the walls around its rooms, whose rectangles end at the faces of walls. None for lines."""
    free_walls: tuple[FreeWall, ...] = ()
    """Free-standing walls at any angle, in addition to those of its rooms: ``walls`` in its file."""

    occupancy: OccupancyGrid | None = None
    """Cells of a house that is a map."""

    plan: ClassVar[Callable[[House, int], str]]
    """Function that draws the house as SVG of a width in CSS pixels.

    The package sets it, since the module that draws houses imports this one.
    """

    @property
    def kind(self) -> Kind:
        """Kind of its topology, which decides everything in which stars and other houses differ."""
        return kind_of(self.topology)

    @property
    def main_room(self) -> Room | None:
        """Main room of a star, which the other rooms surround; None for other houses."""
        if self.kind not in STARS:
            return None
        return next((room for room in self.rooms if room.name == self.hub), None)

    @property
    def main(self) -> Room:
        """Room that the other rooms lie around. Raises ``ValueError`` if the house names none."""
        return self.room(self.hub)

    @property
    def half_wall(self) -> float:
        """Half of an inner wall's thickness, metres: the distance of doors and windows from their rooms."""
        return self.wall_thickness.inner / 2 if self.wall_thickness else 0.0

    @property
    def tiles(self) -> tuple[Room, ...]:
        """Rooms, each grown by half of an inner wall, so that rooms that share a wall share an edge."""
        return tuple(room.grown(self.half_wall) for room in self.rooms)

    def doorway(self, door: Door) -> Box:
        """Return the box of a door within the wall between two rooms: (west, north, east, south), metres."""
        return doorway(door, self.half_wall)

    @property
    def start(self) -> Room:
        """Room where episodes start: the hub, else the room of the first entrance, else the first room."""
        entered = (name for door in self.doors if door.is_entrance for name in door.between)
        name = self.hub or next((name for name in entered if name != OUTSIDE), self.rooms[0].name)
        return self.room(name)

    @property
    def garden_doors(self) -> tuple[Door, ...]:
        """Doors that lead outside, without the first one, which is the entrance."""
        return tuple(door for door in self.doors if door.is_entrance)[1:]

    @property
    def secondary(self) -> tuple[Room, ...]:
        """All rooms but the hub."""
        return tuple(room for room in self.rooms if room.name != self.hub)

    @property
    def counted(self) -> tuple[Room, ...]:
        """Rooms that a request counts, which exclude a star's main room."""
        main = self.main_room
        return tuple(room for room in self.rooms if room is not main)

    @property
    def outdoor(self) -> tuple[str, ...]:
        """Types of rooms that are outdoors, by the promises of the house."""
        made = self.provenance
        return made.promises.outdoor if made and made.promises else ()

    @property
    def parapet(self) -> float:
        """Thickness of the parapets that stand around outdoor rooms instead of outer walls, metres."""
        return max(PARAPET_M, self.half_wall)

    def is_outdoor(self, *names: str) -> bool:
        """Return True if none of these rooms, or ``outside``, is indoors."""
        return all(name == OUTSIDE or self.room(name).type in self.outdoor for name in names)

    def cut_from(self, room: Room) -> tuple[Room, ...]:
        """Return the rooms that are cut out of a room's rectangle: all others for a star's main room."""
        return self.counted if room is self.main_room else ()

    def room(self, name: str) -> Room:
        """Return the room with this name. Raises ``ValueError`` if there is none."""
        for room in self.rooms:
            if room.name == name:
                return room
        if not name:
            raise ValueError(f"the house names no hub: it has {', '.join(room.name for room in self.rooms)}")
        raise ValueError(unknown("room", name, [room.name for room in self.rooms]))

    def whole(self, room: Room) -> Room:
        """Return the room that a room is a part of, or the room itself."""
        return self.room(room.part_of) if room.part_of else room

    def parts(self, room: Room) -> tuple[Room, ...]:
        """Return a room and its parts, which form one room without walls; nothing for a part."""
        return () if room.part_of else (room, *(each for each in self.rooms if each.part_of == room.name))

    def doors_of(self, name: str) -> tuple[Door, ...]:
        """Return the doors of a room, by its name. The doors of ``outside`` are the entrances."""
        return tuple(door for door in self.doors if name in door.between)

    def only(self, *names: str) -> House:
        """Return the house with only these rooms (``"R0"``) and a star's main room.

        The result is an argument for ``generate(keep=...)``. Raises ``ValueError`` for a name that no room
        has, and for a map.
        """
        if self.occupancy:
            raise ValueError("a map of cells has no rooms to keep")
        for name in names:
            self.room(name)
        rooms = tuple(room for room in self.rooms if room.name in names or room is self.main_room)
        left = {OUTSIDE, *(room.name for room in rooms)}
        doors = tuple(door for door in self.doors if left.issuperset(door.between))
        windows = tuple(window for window in self.windows if window.room in left)
        hub = self.hub if self.hub in left else ""
        return House(
            rooms,
            doors,
            windows,
            hub,
            self.topology,
            self.format,
            wall_thickness=self.wall_thickness,
            free_walls=self.free_walls,
        )

    @property
    def star(self) -> Star:
        """House as a star. Raises ``ValueError`` for another topology."""
        if self.kind not in STARS:
            raise ValueError(f"its topology is {self.topology or 'not named'}: only a star has a main room")
        return Star.of(self.rooms, self.doors, self.hub)

    @property
    def walls(self) -> tuple[list[Line], list[Line]]:
        """Walls that run north to south, as (x, from y, to y), then those that run west to east.

        See ``walls.py``.
        """
        if self.occupancy:
            return self.occupancy.lines()
        if self.kind is Kind.SHARED_WALLS:
            return walls_of_rooms(self.rooms, self.doors, self.half_wall)
        return walls_of_star(self.star.floor, self.star.rooms)

    @property
    def filled(self) -> list[Box]:
        """Solid boxes behind its walls: for a map all cells that are not free, as few boxes."""
        return self.occupancy.blocks() if self.occupancy else []

    def converted(self) -> House:
        """Return the house in the format ``vitruvius-2``, which gives the same simulation, bit for bit."""
        return msgspec.structs.replace(self, format=FORMAT)

    def _repr_svg_(self, width: int = 480) -> str:
        """Return the plan, ``width`` CSS pixels wide, for notebooks."""
        return House.plan(self, width)

    @classmethod
    def from_grid(cls, array: Any, cell: float, corner: tuple[float, float] | None = None) -> House:
        """Return the house of a map: one room, ``map``, with walls around its free cells.

        ``array`` (H, W), row 0 in the north: bool, True if occupied, or whole numbers as in ROS's
        ``OccupancyGrid``, 0 free, 100 occupied, -1 unknown. Occupied and unknown cells are solid. ``cell``:
        side of a cell, metres. ``corner``: (x, y) of the north-west corner, metres; by default the middle of
        the map is (0, 0).

        Raises ``ValueError`` for another shape, type or value, for more than 33,554,432 cells, and if no cell
        is free.
        """
        if corner is None:
            rows, columns = np.shape(array) if np.ndim(array) == 2 else (0, 0)
            corner = -columns * cell / 2, -rows * cell / 2
        return cls.of_map(OccupancyGrid.of(array, cell, corner))

    @classmethod
    def of_map(cls, grid: OccupancyGrid) -> House:
        """Return the house of a map, which has one room."""
        west, north, east, south = grid.box
        room = Room(west, north, east - west, south - north, MAP, MAP)
        return cls((room,), hub=MAP, topology=MAP, occupancy=grid)

    @classmethod
    def of_star(cls, star: Star, topology: str = STAR, provenance: Provenance | None = None) -> House:
        """Return the house of a star, with the topology ``star`` or ``original`` and its file format."""
        format_ = ORIGINAL if topology == ORIGINAL else STAR_FORMAT
        return cls(*star.parts(), (), MAIN, topology, format_, provenance)

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> House:
        """Read a house from its JSON form, of any format. Lengths without ``unit`` are the original's pixels.

        Raises ``ValueError`` (``msgspec.ValidationError``) that names the first wrong field.
        """
        try:
            found, format_ = read(record)
        except msgspec.ValidationError:
            found, format_ = read(plain(record))  # tried second: records of files are plain already
        openings = found.doors, found.windows
        about = found.hub or "", found.topology, format_, found.provenance, found.wall_thickness
        return cls(found.rooms, *openings, *about, found.walls, found.occupancy)

    def to_dict(self) -> dict[str, Any]:
        """Return the house in its JSON form, in metres, from which ``from_dict`` reads the same house.

        Raises ``ValueError`` for a format of stars if the house is no star or has free walls.
        """
        if self.format != FORMAT:
            if self.free_walls:
                raise ValueError(
                    f"the format {self.format} does not support free walls: write the house as {FORMAT}"
                )
            return star_record(self.star, self.format, self.provenance)
        openings = self.doors, self.windows
        about = self.hub or None, self.topology, self.provenance, self.wall_thickness
        record = Record(FORMAT, "m", self.rooms, *openings, *about, self.free_walls, self.occupancy)
        return msgspec.to_builtins(record)
