"""Relations of furniture in rules agree with the geometry of plans, relation by relation."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest
from clingo import Function, Number, Symbol

from tests.logic.rules.plan_geometry import TOLERANCE
from tests.logic.workers.in_process import builder
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.furnish import Furnished
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.house.boxes import BACK, Box
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.request.house_request import HouseRequest

WALLS = ("front", "left", "back", "right")
"""Walls as seen from the entrance, clockwise."""


class Seen:
    """Furnished room: its atoms, and its pieces by the atoms that stand for them."""

    def __init__(self, made: Builder, how: Furnished, room: Room, atoms: list[Symbol]) -> None:
        self.how, self.room, self._atoms = how, room, atoms
        named = made.placer.pieces(how.layout)
        assert [type_ for type_, _ in named] == [piece.type for piece in room.pieces]
        self.pieces = {str(atom): piece for (_, atom), piece in zip(named, room.pieces, strict=True)}
        (self._entrance,) = [k for k in range(4) if lies_on(how.room.doors[0].box, room.box, k)]
        self.walls = {(k - self._entrance) % 4: k for k in range(4)}

    def said(self, name: str, arity: int) -> Iterator[tuple[Any, ...]]:
        for atom in self._atoms:
            if atom.match(name, arity):
                yield tuple(a.number if a.type.name == "Number" else str(a) for a in atom.arguments)

    def wall(self, name: str) -> int:
        """Return the index in a box of the wall with this name."""
        return self.walls[WALLS.index(name)]

    def piece(self, type_: str, number: int) -> Piece:
        (found,) = [piece for atom, piece in self.pieces.items() if atom.startswith(f"on({type_},{number},")]
        return found

    def touches(self, piece: Piece, wall: str) -> bool:
        k = self.wall(wall)
        return abs(piece.box[k] - self.room.box[k]) <= 1e-5

    def at(self, stretch: str) -> str:
        """Return the wall of a stretch."""
        return next(wall for each, wall in self.said("at", 2) if each == stretch)


def lies_on(segment: Box, box: Box, k: int) -> bool:
    return abs(segment[k] - box[k]) + abs(segment[(k + 2) % 4] - box[k]) <= 2 * TOLERANCE


def touch(one: Box, other: Box) -> bool:
    gaps = [max(one[k], other[k]) - min(one[k + 2], other[k + 2]) for k in (0, 1)]
    return max(gaps) <= 1e-5


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Builder:
    """Return a builder for ``home`` with wardrobes that may stand with their side to the wall."""
    folder = shutil.copytree(SHIPPED / "home", tmp_path_factory.mktemp("grammars") / "turns")
    (folder / "turns.lp").write_text("turns(wardrobe,(front;left;back;right)).\n")
    return builder(folder)


@pytest.fixture(scope="module")
def rooms(made: Builder) -> list[Seen]:
    found = []
    for index in range(3):
        house = made.house(HouseRequest(7), 2, index)
        assert made.origin is not None
        for program in {each.program for each in made.origin.furniture.values()}:
            program.models = []
        assert made.house(HouseRequest(7), 2, index).rooms == house.rooms
        for number, how in made.origin.furniture.items():
            models = [all_ for layout, all_ in how.program.models or () if layout == how.layout.furniture]
            found.append(Seen(made, how, house.rooms[number], models[-1]))
    assert len(found) > 10
    return found


@pytest.mark.parametrize("piece", ["singleBed", "wardrobe"])
@pytest.mark.parametrize(("back", "front"), [("near", "far"), ("far", "near")])
def test_a_turned_piece_has_its_back_to_something_and_nothing_at_its_foot_or_front(
    made: Builder, piece: str, back: str, front: str
) -> None:
    """Beds turn by home's own rules, wardrobes because they are used from their front."""

    def stated(name: str, end: str) -> Symbol:
        return Function(name, [Function(piece), Number(1), Function(end)])

    program, turned = made.programs.furniture("bedroom"), stated("turned", back)
    assert program.possible([turned, stated("touched", back)])
    assert not program.possible([turned, stated("touched", front)])


def test_windows_and_doors_are_in_the_walls_that_rules_say(rooms: list[Seen]) -> None:
    for seen in rooms:
        for name, said, segments in (
            ("window", {wall for (wall,) in seen.said("window", 1)}, seen.how.room.windows),
            ("doorway", {wall for wall, _ in seen.said("doorway", 2)}, seen.how.room.doors),
        ):
            true = {
                wall
                for wall in WALLS
                for segment in segments
                if lies_on(segment.box, seen.room.box, seen.wall(wall))
            }
            assert said == true, name
        assert len(list(seen.said("doorway", 2))) == len(seen.how.room.doors)


def test_pieces_stand_at_the_walls_that_rules_say_in_their_order(rooms: list[Seen]) -> None:
    count = 0
    for seen in rooms:
        placed: dict[str, list[tuple[int, Piece]]] = {}
        for type_, number, place, order in seen.said("on", 4):
            piece = seen.piece(type_, number)
            if place == "middle":
                assert not any(seen.touches(piece, wall) for wall in WALLS)
                continue
            assert seen.touches(piece, seen.at(place))
            placed.setdefault(place, []).append((order, piece))
            count += 1
        for place, some in placed.items():
            wall = seen.at(place)
            k = 1 - seen.wall(wall) % 2
            # From the corner beside a door; otherwise from the front on the left and right wall, or from the
            # left.
            _, parted, corner = place.partition("_")
            near = seen.wall(corner if parted else "front" if wall in ("left", "right") else "left")
            starts = [piece.box[k] for _, piece in sorted(some, key=lambda each: each[0])]
            assert starts == sorted(starts, reverse=near >= 2)
    assert count > 25


def test_pieces_touch_what_rules_say_that_they_touch(rooms: list[Seen]) -> None:
    corners, both = 0, set()
    for seen in rooms:
        for _, one, other, type_, number in seen.said("reaches", 5):
            piece = seen.piece(type_, number)
            corners += 1
            if not any(owner not in (one, other) for *_, owner in seen.said("corner", 3)):
                assert seen.touches(piece, seen.at(one)) or seen.touches(piece, seen.at(other))
        order = {(place, n): (t, k) for t, k, place, n in seen.said("on", 4) if place != "middle"}
        joined = {(t, k) for t, k in seen.said("joined", 2)}
        for (place, n), one in order.items():
            if n > 1 and (place, n - 1) in order:
                before = order[place, n - 1]
                whole = [seen.piece(*before), *seen.piece(*before).children]
                here = [seen.piece(*one), *seen.piece(*one).children]
                meets = any(touch(a.box, b.box) for a in whole for b in here)
                assert meets == (one in joined), (seen.room.type, place, n)
                both.add(meets)
    assert corners > 10
    assert both == {True, False}


def test_pieces_face_and_are_turned_as_rules_say(rooms: list[Seen]) -> None:
    ways = {"inwards": "front", "outwards": "back", "left": "right", "right": "left"}
    for seen in rooms:
        for type_, number, way in seen.said("faces", 3):
            piece = seen.piece(type_, number)
            if piece.orientation:
                assert BACK[piece.orientation] == seen.wall(ways[way])
        turned = {(type_, number) for type_, number, _ in seen.said("turned", 3)}
        for type_, number, place, _ in seen.said("on", 4):
            piece = seen.piece(type_, number)
            if place != "middle" and piece.orientation:
                across = BACK[piece.orientation] != seen.wall(seen.at(place))
                assert across == ((type_, number) in turned)
