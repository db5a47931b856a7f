"""The independent check distinguishes correct houses from nearly correct ones."""

import pytest
from msgspec.structs import replace

from tests.logic.house.handmade import Sketch, built, piece, sketches
from tests.plans import flat
from vitruvius.logic import Door, House, Piece, check
from vitruvius.logic.house.parts import Provenance
from vitruvius.logic.house.promises import Promises, Thickness


def with_bedroom(*pieces: Piece) -> House:
    """Return a star with these pieces in a bedroom of 3.6 by 3.8 m, north of the main room."""
    _, *others = sketches()
    first = Sketch("bedroom", 3.6, 3.8, pieces=pieces)
    return built(4.2, 4.2, ((first,), *((sketch,) for sketch in others)))


def flat_with(new: Piece) -> House:
    """Return a flat with this piece in bedroom R1, 3.6 by 3.6 m, with a window from x = 0.9 m to 2.4 m."""
    house = flat()
    return replace(house, rooms=(house.rooms[0], replace(house.rooms[1], children=(new,)), *house.rooms[2:]))


@pytest.mark.parametrize(("x", "hidden"), [(2.4, False), (2.3, True)])
def test_a_piece_beside_a_window_does_not_hide_it(x: float, hidden: bool) -> None:
    house = flat_with(piece("rack", x, 0.2, 0.6, 0.6))
    found = [line for line in check(house, Promises(hides=("rack",))) if "is behind a rack" in line]
    assert bool(found) == hidden


@pytest.mark.parametrize(
    ("side", "words"), [(1.6, []), (1.61, ["R0 (bedroom): has no free square of 1.61 m"])]
)
def test_the_free_square_of_a_room_is_measured_to_the_centimetre(side: float, words: list[str]) -> None:
    """The square is between two racks of 1 m in a bedroom that is 3.6 m wide."""
    house = with_bedroom(piece("rack", 0.0, 0.0, 1.0, 2.9), piece("rack", 2.6, 0.0, 1.0, 2.9))
    assert [line for line in check(house, Promises(turning={"bedroom": side})) if "square" in line] == words


def test_a_piece_with_a_front_may_not_lie_the_other_way() -> None:
    sizes = Promises(piece_size={"rack": (1.0, 1.4, 0.5, 0.6)})
    assert check(flat_with(piece("rack", 0.0, 0.0, 1.2, 0.5)), sizes) == []
    assert check(flat_with(piece("rack", 0.0, 0.0, 0.5, 1.2)), sizes) == []
    assert check(flat_with(piece("rack", 0.0, 0.0, 1.2, 0.5, front="E")), sizes) == [
        "R1 (bedroom): rack is 0.500 m long (1.000 to 1.400)",
        "R1 (bedroom): rack is 1.200 m deep (0.500 to 0.600)",
    ]


@pytest.mark.parametrize(
    ("places", "words"),
    [
        ("NW touching", []),
        ("NW apart", ["R0 (bedroom): desk: those at neighbouring walls do not meet"]),
        ("NWE", []),
        ("WE", ["R0 (bedroom): desk: two stand at opposite walls, and none between them"]),
        ("NN", ["R0 (bedroom): desk 2 shares its wall with another desk"]),
    ],
)
def test_pieces_that_meet_round_corners_touch_at_neighbouring_walls_alone(
    places: str, words: list[str]
) -> None:
    north = piece("desk", 0.0, 0.0, 3.6, 0.6, front="S")
    west, east = (piece("desk", x, 0.6, 0.6, 1.2, front=front) for x, front in ((0.0, "E"), (3.0, "W")))
    desks = {
        "NW touching": (north, west),
        "NW apart": (north, replace(west, y=0.7)),
        "NWE": (north, west, east),
        "WE": (west, east),
        "NN": (replace(north, width=1.2), replace(north, width=1.2, x=2.0)),
    }
    assert check(with_bedroom(*desks[places]), Promises(meet=("desk",))) == words


def without(house: House, *between: str) -> House:
    return replace(house, doors=tuple(door for door in house.doors if door.between != between))


def test_each_unit_has_one_door_to_a_public_room() -> None:
    """The hall has a door outside, too; kitchen and living room have two to the public corridor."""
    public = Promises(public=("corridor",))
    kitchen = "R6 (kitchen): its unit is entered by 2 doors (must be one)"
    assert check(flat(), public) == ["R4 (hall): its unit is entered by 2 doors (must be one)", kitchen]
    apart = without(without(flat(), "R0", "R4"), "R0", "R7")
    found = [line for line in check(apart, public) if "unit" in line]
    assert found == ["R4 (hall): its unit is entered from outside (must be from a public room)"]


def test_walls_are_as_thick_as_is_promised() -> None:
    assert check(flat(), Promises(wall_thickness=Thickness(0.0, 0.0))) == []
    assert check(flat(), Promises(wall_thickness=Thickness(0.1, 0.3))) == [
        "house: its inner walls are 0 m thick (must be 0.1)",
        "house: its outer walls are 0 m thick (must be 0.3)",
    ]


def on_cells(house: House, cell: float) -> list[str]:
    return check(replace(house, provenance=Provenance("", "", {"cell": cell}, 0, 0, {})), Promises())


def test_a_house_on_a_grid_has_all_its_edges_on_it() -> None:
    assert on_cells(flat(), 0.3) == []
    rack = flat_with(piece("rack", 0.65, 1.2, 0.6, 0.6))
    assert on_cells(rack, 0.3) == ["R1 (bedroom): rack stands 0.050 m off the grid of 0.3 m"]


def test_a_main_room_on_a_grid_is_of_whole_cells() -> None:
    found = [line for line in on_cells(with_bedroom(), 0.4) if line.startswith("main room")]
    assert found == [f"main room: is 4.200 m {way}, not whole cells of 0.4 m" for way in ("wide", "deep")]
    assert not [line for line in on_cells(with_bedroom(), 0.3) if line.startswith("main room")]


def with_a_part(width: float) -> House:
    """Return the flat with the kitchen R6 as a part of the living room R7, and 3.6 m of wall between them."""
    house = flat()
    kitchen = replace(house.room("R6"), part_of="R7", children=())
    doors = without(house, "R6", "R7").doors
    rooms = tuple(kitchen if room.name == "R6" else room for room in house.rooms)
    gap = Door(6.6, 4.8, 0.0, width, ("R6", "R7"), opening=True)
    return replace(house, rooms=rooms, doors=(*doors, gap))


def test_all_the_wall_between_a_room_and_its_part_is_open() -> None:
    parts = Promises(parts={"kitchen": ("living",)})
    assert check(with_a_part(3.6), parts) == []
    found = [line for line in check(with_a_part(3.0), parts) if "part" in line]
    assert found == ["R6 (kitchen): is a part of R7, and of 3.600 m of wall 3 are open (must be all)"]


def test_a_room_is_a_part_of_a_room_of_a_type_that_is_promised() -> None:
    said = ["R6 (kitchen): is no part of a room (must be of a hall)"]
    for house in (with_a_part(3.6), flat()):
        found = check(house, Promises(parts={"kitchen": ("hall",)}))
        assert [line for line in found if "is no part" in line] == said


def test_the_area_of_a_room_is_that_with_its_parts_where_that_is_promised() -> None:
    """The kitchen has 9.72 square metres, and the living room 12.96."""
    parts = {"kitchen": ("living",)}
    assert check(with_a_part(3.6), Promises(parts=parts, whole_area={"living": (22.6, 22.7)})) == []
    assert check(with_a_part(3.6), Promises(parts=parts, whole_area={"living": (20.0, 22.6)})) == [
        "R7 (living): is of 22.68 m² with its parts (20 to 22.6)"
    ]
