"""Counts of how furniture, doors and windows of homes go together, by plain geometry.

Run ``python -m benchmarks.realism.groups homes.jsonl`` on a file of ``vitruvius generate --grammar home``.
"""

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import tyro
from shapely import Point, box, unary_union
from shapely.geometry.base import BaseGeometry

from vitruvius.logic import House, Room, load
from vitruvius.logic.drawing.door_leaves import Leaf, door_leaves
from vitruvius.logic.exports.solids import HEAD, SILL
from vitruvius.logic.house.boxes import distance
from vitruvius.logic.house.parts import Piece

DOUBLE_M = 1.4
"""Least width of a double bed, metres."""

BESIDE_BED_M = 0.4
"""Least width of the free strip on each long side of a double bed, metres."""

REACH_M = 0.8
"""Greatest distance of a coffee table from a sofa, metres."""

FACING = {"N": "S", "S": "N", "E": "W", "W": "E"}
"""Orientation of a piece that faces another, by the orientation of the other."""

TABLES = {"table", "diningTable"}
"""Piece types at which people dine."""

LARGE_M2, EMPTY_M = 20.0, 3.0
"""Least floor of a large living room, square metres; side of a square in it that stands empty, metres."""


def double(piece: Piece) -> bool:
    """Return True if a piece is a double bed."""
    return piece.type in {"bed", "singleBed"} and min(piece.width, piece.height) >= DOUBLE_M


def free_on_both_sides(bed: Piece, room: Room) -> bool:
    """Return True if a strip is free on both long sides of a bed, apart from its own bedside tables."""
    dx, dy = (0.0, BESIDE_BED_M) if bed.width > bed.height else (BESIDE_BED_M, 0.0)
    west, north, east, south = bed.box
    around = box(west - dx, north - dy, east + dx, south + dy).buffer(-1e-6)
    others = [piece for piece in room.pieces if piece is not bed and piece not in bed.children]
    return around.within(box(*room.box)) and not any(around.intersects(box(*each.box)) for each in others)


def off_axis(screen: Piece, room: Room) -> float:
    """Return how far a television is from the axis of the nearest sofa that faces it, metres."""
    axis, facing = int(screen.orientation in "EW"), FACING[screen.orientation]
    middle = screen.box[axis] + screen.box[axis + 2]
    sofas = [piece for piece in room.pieces if piece.type == "sofa" and piece.orientation == facing]
    return min((abs(sofa.box[axis] + sofa.box[axis + 2] - middle) / 2 for sofa in sofas), default=math.inf)


def sweeps(house: House) -> Iterator[bool]:
    """Yield for each door with a leaf if the leaf sweeps over furniture or the swing of another door."""

    def sector(leaf: Leaf) -> BaseGeometry:
        return Point(leaf.hinge).buffer(math.dist(leaf.hinge, leaf.jamb)).intersection(box(*leaf.swing))

    leaves = door_leaves(house)
    for leaf in leaves:
        others = [box(*piece.box) for piece in house.room(leaf.room).pieces]
        others += [sector(other) for other in leaves if other is not leaf and other.room == leaf.room]
        yield any(sector(leaf).intersection(other).area > 1e-3 for other in others)


def has_empty_square(room: Room) -> bool:
    """Return True if no furniture stands in some square of a room."""
    free = box(*room.box).difference(unary_union([box(*piece.box) for piece in room.pieces]))
    return not free.buffer(-EMPTY_M / 2, join_style="mitre").is_empty


def counted(house: House) -> Iterator[tuple[str, bool]]:
    """Yield each count of a house: its name, and True for a house, piece, door or room that it counts."""
    of = {kind: [room for room in house.rooms if room.type == kind] for kind in ("bedroom", "living")}
    beds = [piece for room in house.rooms for piece in room.pieces if piece.type in {"bed", "singleBed"}]
    yield from (("single beds, of beds", not double(bed)) for bed in beds)
    yield "homes without a double bed", not any(map(double, beds))
    largest = max(of["bedroom"], key=lambda room: room.area, default=None)
    if largest:
        doubles = [bed for bed in largest.pieces if double(bed)]
        free = any(free_on_both_sides(bed, largest) for bed in doubles)
        yield "homes whose largest bedroom has no double bed that is free on both sides", not free
    for room in house.rooms:
        sofas = [piece.box for piece in room.pieces if piece.type == "sofa"]
        for table in (piece for piece in room.pieces if piece.type == "coffeeTable"):
            near = min((distance(table.box, sofa) for sofa in sofas), default=math.inf)
            yield f"coffee tables over {REACH_M} m from any sofa", near > REACH_M
        for screen in (piece for piece in room.pieces if piece.type == "tvBench"):
            yield "televisions over 1 m off the axis of any sofa that faces it", off_axis(screen, room) > 1
    dining = [room for room in house.rooms if TABLES & {piece.type for piece in room.pieces}]
    yield "homes with dining tables in several rooms", len(dining) > 1
    yield "homes without a dining table", not dining
    yield from (("doors that swing over furniture or each other", sweep) for sweep in sweeps(house))
    for room in of["living"]:
        yield "living rooms with a coffee table", any(piece.type == "coffeeTable" for piece in room.pieces)
        if room.area >= LARGE_M2:
            yield f"large living rooms with an empty square of {EMPTY_M} m", has_empty_square(room)
    for room in house.rooms:
        glass = sum((HEAD - SILL) * window.length for window in house.windows if window.room == room.name)
        if glass:
            yield "rooms with windows of less than an eighth of the floor", glass < room.area / 8
            if room.type == "living":
                yield "living rooms with less", glass < room.area / 8


def main(houses: Annotated[Path, tyro.conf.Positional]) -> None:
    """Print how often the furniture of some homes stands as people would not place it.

    Args:
        houses: File or set of houses.

    """
    found, total = Counter[str](), Counter[str]()
    for each in load(houses):
        for name, counts in counted(each):
            found[name] += counts
            total[name] += 1
    for name, number in total.items():
        print(f"{found[name]:4} of {number:4}  {name}")


if __name__ == "__main__":
    tyro.cli(main)
