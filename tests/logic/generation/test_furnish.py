"""Rooms of given sizes and doors: furniture keeps every clearance and passage, by independent geometry."""

import shutil
from collections.abc import Iterator, Sequence

import numpy as np
import pytest
import shapely
from clingo import Function, Number, Symbol
from shapely.geometry.base import BaseGeometry

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.furnish import Frame, GivenRoom, Unfurnishable, furnished
from vitruvius.logic.generation.movable_doors import LooseRoom
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.boxes import TOLERANCE
from vitruvius.logic.house.boxes import overlap as overlapping
from vitruvius.logic.house.parts import Piece, Rect, pieces_of
from vitruvius.logic.layout.program import Program
from vitruvius.logic.layout.programs import GIVEN_ROOM_CONSTANTS
from vitruvius.logic.layout.terms import parts as terms_of
from vitruvius.logic.request.house_request import HouseRequest

NEAR = 1e-6
PASSAGE, CLEARANCE, DOOR = 0.42, 0.45, 0.8
FACES = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}


ROOM = Rect(1.0, 2.0, 4.0, 3.5)
SOUTH, NORTH = Rect(2.0, 5.5, DOOR, 0.0), Rect(3.0, 2.0, DOOR, 0.0)
WEST, EAST = Rect(1.0, 3.0, 0.0, DOOR), Rect(5.0, 3.5, 0.0, DOOR)


@pytest.fixture(scope="module")
def builder(tmp_path_factory: pytest.TempPathFactory) -> Builder:
    """Return a builder for ``family`` with tall wardrobes and with halls that may be empty."""
    folder = tmp_path_factory.mktemp("grammars") / "tall"
    shutil.copytree(SHIPPED / "family", folder)
    (folder / "tall.lp").write_text("hides(wardrobe). empty(hall).")
    return Builder(find(folder))


def one(builder: Builder, room: GivenRoom, seed: int = 0) -> tuple[Piece, ...]:
    rng = np.random.default_rng(seed)
    return furnished([room], builder.programs, builder.placer, rng, 10**8)[0]


def rooms(seed: int, type_: str, area: tuple[float, float], doors: int) -> Iterator[GivenRoom]:
    """Yield rooms of this type, of an area in this range (m²), with doors at random places."""
    rng = np.random.default_rng(seed)
    while True:
        size, ratio = rng.uniform(*area), rng.uniform(0.6, 1.6)
        width, depth = float(np.sqrt(size * ratio)), float(np.sqrt(size / ratio))
        x, y = map(float, rng.uniform(-5, 5, 2))
        found: list[Rect] = []
        for _ in range(100):
            wall = int(rng.integers(4))
            start = float(rng.uniform(0, (depth if wall % 2 else width) - DOOR))
            door = [
                Rect(x + start, y, DOOR, 0.0),
                Rect(x + width, y + start, 0.0, DOOR),
                Rect(x + start, y + depth, DOOR, 0.0),
                Rect(x, y + start, 0.0, DOOR),
            ][wall]
            if all(shapely.box(*door.box).distance(shapely.box(*other.box)) > 0.05 for other in found):
                found.append(door)
            if len(found) == doors:
                yield GivenRoom(type_, Rect(x, y, width, depth), found)
                break


def box(rect: Rect, by: float = 0.0) -> BaseGeometry:
    west, north, east, south = rect.box
    return shapely.box(west - by, north - by, east + by, south + by)


def faults(room: GivenRoom, pieces: tuple[Piece, ...], clear_front: frozenset[str]) -> Iterator[str]:
    """Yield the faults of a furnished room."""
    floor = shapely.box(*room.rect.box)
    everything = pieces_of(pieces)
    for number, piece in enumerate(everything):
        if not floor.buffer(NEAR, join_style="mitre").contains(box(piece)):
            yield f"{piece.type} juts out"
        for other in everything[:number]:
            if box(piece, -NEAR).intersects(box(other, -NEAR)):
                yield f"{piece.type} overlaps {other.type}"
        for door in room.doors:
            if box(piece).distance(shapely.box(*door.box)) < CLEARANCE - NEAR:
                yield f"{piece.type} stands before a door"
    # The places of the centre of a square as wide as a passage, within the room.
    half = PASSAGE / 2 - NEAR
    places = floor.buffer(-half, join_style="mitre")
    places = places.difference(shapely.union_all([box(piece, half) for piece in everything]))
    spaces = [space for space in shapely.get_parts(places) if space.area > 1e-4]
    if len(spaces) != 1:
        yield f"the floor falls into {len(spaces)} parts"
    for door in room.doors:
        if not spaces or spaces[0].distance(shapely.box(*door.box)) > half + NEAR:
            yield "a door cannot be reached"
    for top in pieces:
        if top.type in clear_front:
            dx, dy = FACES[top.orientation] if top.orientation else (0, 0)
            before = shapely.affinity.translate(box(top, -NEAR), dx * PASSAGE, dy * PASSAGE)
            if any(before.intersects(box(piece, -2 * NEAR)) for piece in pieces if piece is not top):
                yield f"{top.type} has something before it"


@pytest.mark.second_part("many rooms")
@pytest.mark.parametrize(
    ("type_", "area"), [("bedroom", (9, 16)), ("kitchen", (6, 15)), ("hall", (14, 30)), ("bathroom", (3, 8))]
)
@pytest.mark.parametrize("doors", [1, 2, 3, 5])
def test_furniture_leaves_every_door_free_and_joined_to_all_the_floor(
    builder: Builder, type_: str, area: tuple[float, float], doors: int
) -> None:
    clear = frozenset({"wardrobe", "toilet", "shower", "sink", "sofa", "cupboard"})
    rng = np.random.default_rng(doors)
    done = 0
    for _, room in zip(range(25), rooms(doors, type_, area, doors), strict=False):
        try:
            (pieces,) = furnished([room], builder.programs, builder.placer, rng, 10**8)
        except Unfurnishable:
            continue
        done += 1
        assert pieces or type_ == "hall"
        assert not list(faults(room, pieces, clear)), room
    assert done >= 1


@pytest.mark.parametrize("entrance", [SOUTH, NORTH, WEST, EAST])
def test_a_room_is_furnished_from_whichever_side_it_is_entered(builder: Builder, entrance: Rect) -> None:
    doors = [entrance, *(door for door in (SOUTH, WEST) if door != entrance)]
    room = GivenRoom("bedroom", ROOM, doors)
    assert not list(faults(room, one(builder, room), frozenset({"wardrobe"})))


def test_a_frame_sees_doors_from_the_entrance() -> None:
    frame = Frame(GivenRoom("bedroom", ROOM, [WEST, SOUTH, NORTH], [EAST]))
    assert (frame.width, frame.depth) == (3.5, 4.0)
    assert frame.doors["front"] == [pytest.approx((1.0, 1.8))]
    assert frame.doors["right"] == [pytest.approx((1.0, 1.8))]  # to the south as one enters from the west
    assert frame.doors["left"] == [pytest.approx((2.0, 2.8))]
    assert frame.windows["back"] == [pytest.approx((1.5, 2.3))]


def test_what_is_tall_stands_at_no_wall_with_a_window(builder: Builder) -> None:
    window = Rect(2.0, 2.0, 1.5, 0.0)
    at_window = {
        lit: sum(
            piece.type == "wardrobe" and piece.orientation == "S"
            for seed in range(30)
            for piece in one(builder, GivenRoom("bedroom", ROOM, [SOUTH], [window] if lit else []), seed)
        )
        for lit in (False, True)
    }
    assert at_window[False] > 0
    assert at_window[True] == 0


@pytest.mark.parametrize("as_they_are", [True, False])
def test_windows_in_all_walls_refute_what_is_tall_unless_they_may_be_anywhere(
    builder: Builder, as_they_are: bool
) -> None:
    panes = [Rect(3.5, 2.0, 1.0, 0.0), Rect(3.5, 5.5, 1.0, 0.0), Rect(1.0, 4.0, 0.0, 1.0)]
    room = GivenRoom("bedroom", ROOM, [SOUTH], [*panes, Rect(5.0, 4.0, 0.0, 1.0)])
    wanted, rng = HouseRequest(1, furniture={"wardrobe": (1, 1)}), np.random.default_rng(0)
    loose = LooseRoom(room, [None])
    layout = loose.furniture(builder.programs, builder.placer, rng, wanted, windows=as_they_are)
    assert (layout is None) == as_they_are


def test_a_room_that_may_be_empty_is_never_impossible(builder: Builder) -> None:
    small = Rect(0.0, 0.0, 1.2, 1.2)
    assert (
        one(builder, GivenRoom("hall", small, [Rect(0.2, 0.0, DOOR, 0.0), Rect(0.2, 1.2, DOOR, 0.0)])) == ()
    )


def test_a_room_that_cannot_have_what_it_needs_is_named_with_its_size_and_doors(builder: Builder) -> None:
    small = GivenRoom("bedroom", Rect(0.0, 0.0, 1.8, 1.9), [Rect(0.2, 0.0, DOOR, 0.0)])
    with pytest.raises(Unfurnishable, match=r"a bedroom of 1\.80 by 1\.90 m with 1 door cannot have"):
        one(builder, small)


def test_the_same_random_numbers_furnish_a_room_alike(builder: Builder) -> None:
    room = GivenRoom("kitchen", ROOM, [SOUTH, EAST])
    first = one(builder, room, 5)
    for seed in range(3):
        one(builder, room, seed)
    assert one(builder, room, 5) == first


def test_past_the_limit_of_inferences_a_house_ends_in_it(builder: Builder) -> None:
    room, rng = GivenRoom("bedroom", ROOM, [SOUTH]), np.random.default_rng(0)
    with pytest.raises(LimitReached):
        furnished([room], builder.programs, builder.placer, rng, 100)


def test_a_door_off_the_walls_is_refused() -> None:
    with pytest.raises(ValueError, match="is not on its walls"):
        Frame(GivenRoom("bedroom", ROOM, [SOUTH, Rect(2.0, 3.0, DOOR, 0.0)]))


@pytest.mark.parametrize(("type_", "doors"), [("bedroom", 2), ("kitchen", 3), ("hall", 2), ("bathroom", 2)])
def test_furniture_that_the_capacity_of_a_given_room_refuses_has_no_places(
    builder: Builder, type_: str, doors: int
) -> None:
    refused, programs = 0, {}
    for seed, room in zip(range(60), rooms(7, type_, (4, 12), doors), strict=False):
        frame = Frame(room)
        doorways = frame.facts()
        strict = builder.programs.given(type_, doorways, (), np.random.default_rng(seed))
        lax = programs[doorways] = programs.get(doorways) or without_capacity(builder, type_, doorways)
        holds, fails = frame.given()
        furniture = lax.sample(np.random.default_rng(seed), holds, fails)
        assert furniture
        if not strict.possible([*furniture, *holds], [*fails, *others(strict, furniture)]):
            refused += 1
            (_,), conflicts, _ = builder.placer.furnish([frame.term(0, type_, furniture, seed)], 10**8)
            assert conflicts, (room, furniture)
    assert refused > 5


def without_capacity(builder: Builder, type_: str, doorways: Sequence[Symbol]) -> Program:
    """Return the program of a given room in which all pieces are thin and no length is needed."""
    wide = [Number(mm) for mm in (1, 99999, 1, 99999)]
    facts = [
        Function(
            fact.name, [fact.arguments[0], *wide] if fact.name == "extent" else [fact.arguments[0], Number(0)]
        )
        for fact, _ in builder.loaded.lengths[type_]
        if fact.name != "reach"
    ]
    parts = [("room", []), ("plan", []), *terms_of([*facts, *doorways])]
    return Program(builder.grammar.asp, {"this_room": type_, **GIVEN_ROOM_CONSTANTS}, parts)


def others(program: Program, furniture: Sequence[Symbol]) -> list[Symbol]:
    """Return all other atoms of a layout of this program."""
    shown = {(atom.name, len(atom.arguments)) for atom in furniture}
    shown |= {("on", 4), ("joined", 2), ("last", 2), ("end", 1), ("busy", 1), ("row", 1), ("corner", 3)}
    shown |= {("turned", 3), ("faces", 3), ("with", 4), ("open", 2)}
    return [atom for name, arity in shown for atom in program.atoms(name, arity) if atom not in furniture]


def test_what_is_tall_stands_in_no_corner_that_a_drawn_window_is_too_near_to() -> None:
    """A grammar's margin keeps its own windows away from corners; drawn windows may be nearer."""
    builder = Builder(find("home"))
    window, hidden = Rect(1.2, 2.0, 1.5, 0.0), Rect(1.2, 2.0, 1.5, 0.3).box
    hides = {
        drawn: sum(
            piece.type == "wardrobe" and overlapping(piece.box, hidden) > TOLERANCE
            for seed in range(60)
            for piece in one(builder, GivenRoom("bedroom", ROOM, [SOUTH], [window], None, drawn), seed)
        )
        for drawn in (False, True)
    }
    assert hides[False] > 0
    assert hides[True] == 0
