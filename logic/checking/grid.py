"""Houses on a grid of cells: their promises, and a check for edges off the grid."""

import math
from collections.abc import Iterator

import msgspec

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import apart, figure, number
from vitruvius.logic.checking.names import named, named_pieces
from vitruvius.logic.checking.walk import way_through
from vitruvius.logic.house.boxes import TOLERANCE
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises, Thickness


def cell_of(house: House) -> float:
    """Return the side of the cells of a house's grid, metres; 0 for a house without a grid."""
    return house.provenance.request.get("cell", 0.0) if house.provenance else 0.0


def on_grid(promises: Promises, cell: float) -> Promises:
    """Return the promises of a house on a grid, with fixed and least lengths rounded up to whole cells."""

    def up(length: float) -> float:
        return math.ceil(length / cell - TOLERANCE) * cell

    def down(length: float) -> float:
        return math.floor(length / cell + TOLERANCE) * cell

    doors = {
        one: {other: up(width) for other, width in widths.items()}
        for one, widths in promises.door_widths.items()
    }
    door = None if promises.door_width is None else up(promises.door_width)
    gap = None if promises.room_gap is None else up(promises.room_gap)
    rooms, pieces = (
        {
            name: (up(a), max(up(a), down(aa)), up(b), max(up(b), down(bb)))
            for name, (a, aa, b, bb) in sizes.items()
        }
        for sizes in (promises.room_size, promises.piece_size)
    )
    clearance = up(promises.door_clearance)
    thick = promises.wall_thickness and Thickness(*map(up, msgspec.structs.astuple(promises.wall_thickness)))
    # The grid rounds each side separately, so shares of a room's side, areas and relations need not hold.
    rounded = {"room_size": rooms, "piece_size": pieces, "shares": {}, "tops": {}}
    rounded |= {"room_relations": {}, "piece_relations": {}}
    return msgspec.structs.replace(
        promises,
        door_width=door,
        door_widths=doors,
        wall_thickness=thick,
        door_clearance=clearance,
        room_gap=gap,
        **rounded,
    )


def off_grid(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault for each edge off the grid.

    The grid begins at the main room's corner, or at the outline's corner if there is no main room.
    """
    cell = cell_of(house)
    if not cell:
        return
    corners = [room.box[:2] for room in ([house.main_room] if house.main_room else house.rooms)]
    origins = tuple(map(min, zip(*corners, strict=True))) * 2
    for room in house.counted:
        half = house.half_wall
        doors = (("its door", way_through(door, half)) for door in house.doors_of(room.name))
        parts = [("the room", room.box), *doors]
        panes = (window for window in house.windows if window.room == room.name)
        parts += (("its window", way_through(window, half)) for window in panes)
        parts += ((name, piece.box) for piece, name in named_pieces(room))
        for name, box in parts:
            for edge, origin in zip(box, origins, strict=True):
                off = abs((edge - origin) / cell - round((edge - origin) / cell)) * cell
                if off > TOLERANCE:
                    off_it = figure(off, digits=3)
                    text = f"{named(room)}: {name} stands {off_it} m off the grid of {number(cell)} m"
                    yield Fault(text, (room.name,))
                    break


def broken_cells(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault if the main room is not a whole number of cells wide and deep."""
    cell, main = cell_of(house), house.main_room
    for size, name in ((main.width, "wide"), (main.height, "deep")) if cell and main else ():
        if abs(size / cell - round(size / cell)) * cell > TOLERANCE:
            text = apart(
                size, digits=3, holds=lambda read: abs(read / cell - round(read / cell)) * cell > 1e-7
            )[0]
            yield Fault(f"main room: is {text} m {name}, not whole cells of {number(cell)} m")
