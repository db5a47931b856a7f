"""A room as seen from its entrance: its lengths, doors that may move, and the assumptions of rules."""

import pytest
from clingo import Function, Number, parse_term

from vitruvius.logic.generation.furnish import Frame, GivenRoom, Unfurnishable
from vitruvius.logic.generation.movable_doors import LooseRoom
from vitruvius.logic.generation.tiling import _apart
from vitruvius.logic.generation.unit import Unit
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.request.house_request import HouseRequest

ROOM = Rect(1, 1, 4, 3)
SOUTH = [Rect(2, 4, 0.9, 0), Rect(1, 2, 0, 0.8), Rect(4, 1, 0.7, 0)]
"""The entrance in the south wall, a door in the west wall and one in the north wall."""


def room(doors: list[Rect] = SOUTH, windows: tuple[Rect, ...] = ()) -> GivenRoom:
    return GivenRoom("den", ROOM, doors, windows)


def test_walls_and_spans_are_seen_from_the_entrance() -> None:
    frame = Frame(room(windows=(Rect(5, 1.5, 0, 1),)))
    assert (frame.side, frame.x, frame.y, frame.width, frame.depth) == ("north", 1, 4, 4, 3)
    assert frame.doors == {
        "front": [(1, 1.9)],
        "left": [pytest.approx((1.2, 2))],
        "back": [pytest.approx((3, 3.7))],
        "right": [],
    }
    assert frame.windows == {"front": [], "left": [], "back": [], "right": [(1.5, 2.5)]}


@pytest.mark.parametrize(
    ("door", "side", "front"),
    [
        (Rect(2, 1, 0.9, 0), "south", (2.1, 3)),
        (Rect(1, 2, 0, 0.8), "east", (1, 1.8)),
        (Rect(5, 2, 0, 0.8), "west", (1.2, 2)),
    ],
)
def test_the_front_wall_is_that_of_the_entrance(door: Rect, side: str, front: tuple[float, float]) -> None:
    frame = Frame(room([door]))
    assert frame.side == side
    assert frame.doors["front"] == [pytest.approx(front)]
    assert (frame.width, frame.depth) == ((4, 3) if side == "south" else (3, 4))


def test_an_entrance_or_a_window_on_no_wall_is_named() -> None:
    with pytest.raises(ValueError, match="the entrance of the den is not on its walls"):
        Frame(room([Rect(2, 2, 0.9, 0)]))
    with pytest.raises(ValueError, match="a door or window of the den is not on its walls"):
        Frame(room(windows=(Rect(2, 2, 0.9, 0),)))


def test_stretches_end_at_the_doors() -> None:
    doors = [*SOUTH, Rect(3.5, 4, 0.8, 0)]
    assert dict(Frame(room(doors)).lengths()) == pytest.approx(
        {
            "across": 4,
            "inwards": 3,
            "front_left": 1,
            "between(front,1)": 0.6,
            "front_right": 0.7,
            "left_front": 1.2,
            "left_back": 1,
            "back_left": 3,
            "back_right": 0.3,
            "right": 3,
        }
    )


def test_the_entrance_is_no_doorway_beside_the_others() -> None:
    doors = [*SOUTH, Rect(3.5, 4, 0.8, 0)]
    assert [*map(str, Frame(room(doors)).facts())] == [
        "doorway(front,2)",
        "doorway(left,1)",
        "doorway(back,1)",
    ]


def test_rules_are_to_assume_windows_lengths_and_loose_walls() -> None:
    loose = LooseRoom(room(windows=(Rect(5, 1.5, 0, 1),)), [None, Rect(1, 1.5, 0, 2), None])
    holds, fails = ([str(atom) for atom in atoms] for atoms in loose.given())
    assert "window(right)" in holds
    assert "window(left)" in fails
    assert "loose(left)" in holds
    assert {"loose(front)", "loose(back)", "loose(right)"} <= {*fails}
    # 511 steps of 16 mm less the 3 m inwards are 323 steps and a part: 256 + 64 + 2 + 1.
    assert [atom for atom in holds if "inwards" in atom] == [f"short(inwards,{bit})" for bit in (0, 1, 6, 8)]
    assert len([atom for atom in fails if "inwards" in atom]) == 5
    without = loose.given(windows=False)
    assert not any(atom.name == "window" for atoms in without for atom in atoms)
    assert [len(atoms) for atoms in without] == [len(holds) - 1, len(fails) - 3]


def test_a_wall_longer_than_can_be_said_is_not_short() -> None:
    frame = Frame(GivenRoom("den", Rect(0, 0, 20, 3), [Rect(2, 3, 0.9, 0)]))
    assert not any("across" in str(atom) for atom in frame.given()[0])


def test_doors_that_may_move_stand_from_one_end_of_their_span_to_the_other() -> None:
    loose = LooseRoom(room(), [None, Rect(1, 1.5, 0, 2), None])
    assert loose.earliest["left"] == [pytest.approx((0.5, 1.3))]
    assert loose.latest["left"] == [pytest.approx((1.7, 2.5))]
    assert loose.earliest["front"] == loose.latest["front"] == loose.doors["front"]
    *_, size, doors, frame = loose.loose_term([Function("end")]).arguments
    assert (size.arguments, frame) == ((4, 3), "none")
    (left,) = doors.arguments[1]
    assert left.arguments[0].name == "span"
    assert [*left.arguments[0].arguments, left.arguments[1]] == pytest.approx([0.5, 2.5, 0.8])
    assert doors.arguments[0][0].arguments == pytest.approx((1, 0.9))


def test_moved_doors_lie_along_their_walls_in_the_house() -> None:
    loose = LooseRoom(room(), [None, None, None])
    # From the front, which is in the south, so that a larger distance is further north.
    front, left, back = loose.moved([[1.5], [0.2], [2.9], []])
    assert (front.x, front.y) == pytest.approx((2.5, 4))
    assert (left.x, left.y) == pytest.approx((1, 3))
    assert (back.x, back.y) == pytest.approx((3.9, 1))
    assert (front.width, left.height) == (0.9, 0.8)


def test_a_unit_is_known_by_its_sides_and_the_steps_of_its_depth() -> None:
    unit = Unit(1, HouseRequest(6), "y", 7.3, 0, "south", frozenset({"south", "east"}))
    known = unit.known([Number(7000), Number(7300), Number(8000)])
    true, false = ({str(atom) for atom in known[holds]} for holds in (True, False))
    assert true == {
        "inner(south)", "inner(east)", "access(south)",
        "atmost(y,7300)", "atmost(y,8000)", "atleast(y,7000)", "atleast(y,7300)",
    }  # fmt: skip
    assert "atmost(y,7000)" in false
    assert "atleast(y,8000)" in false
    assert len(false) == 8 - 3 + 12 - 4
    assert str(unit) == "6 rooms, 7.30 m deep along y, entered from its south side"


def test_a_room_and_its_place_are_told_where_it_cannot_be_furnished() -> None:
    error = Unfurnishable(3, room())
    assert str(error) == "a den of 4.00 by 3.00 m with 3 doors cannot have the furniture that it needs"
    assert error.place == 3


def test_edges_that_bring_rooms_apart_are_neither_the_outline_s_nor_those_of_all_on_a_line() -> None:
    edges = [
        parse_term(text)
        for text in ("edge(0,west,outline(west))", "edge(0,north,a)", "edge(1,north,a)", "edge(1,east,b)")
    ]
    assert [str(edge) for edge in _apart(edges, 2)] == ["edge(1,east,b)"]
    assert [str(edge) for edge in _apart(edges[:2], 1)] == ["edge(0,north,a)"]
