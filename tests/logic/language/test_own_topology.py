"""Wrong topologies of users: none generates a house that the check refuses."""

import re
from pathlib import Path

import pytest

from tests.logic.rules.plan_geometry import shared
from tests.logic.workers.in_process import builder
from vitruvius.logic import GrammarError, Unsatisfiable, check
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

RULES = """topology(mine).
type(a;b;c).  empty(a;b;c).  lit(b).  degree(b,1,3).
opens(outside,(a;b;c)).  opens((a;b;c),(a;b;c)).
"""
SIZES = """door_width(0.8).  door_margin(0.1).  window_margin(0.2).
door_clearance(0.3).  passage(0.42).  room_gap(0.0).
room_size(_, W, D) :- { W >= 2.0, W =< 8.0, D >= 2.0, D =< 8.0 }.
window_size(_, L, Wall) :- { L >= 0.6, L =< 0.6*Wall, L =< 2.4 }.
"""
ROWS = """#program house.
option(north,1..rooms-2,1).
side(R,north) :- pick(north,N), R = 1..N.
side(R,south) :- pick(north,N), R = N+1..rooms-1.
next(R,R+1)   :- side(R,S), side(R+1,S).
hub(0).
edge(0,S,outline(S))  :- S = (west;east).
edge(0,S,wall(S))     :- S = (north;south).
edge(R,S,outline(S))  :- side(R,S).
edge(R,T,wall(S))     :- side(R,S), opposite(S,T).
edge(R,east,joint(R)) :- next(R,_).
edge(R,east,outline(east)) :- side(R,_), not next(R,_).
edge(R,west,joint(Q)) :- next(Q,R).
edge(R,west,outline(west)) :- side(R,_), not next(_,R).
face(R,0) :- side(R,_).
face(0,R) :- side(R,_).
face(R,Q) :- next(R,Q).
face(Q,R) :- next(R,Q).
"""
COURTYARD = """#program house.
% A row in the north, and a room at each of its ends southwards: between these is a courtyard.
row(R,north) :- R = 0..rooms-3.  row(rooms-2,west).  row(rooms-1,east).
next(R,R+1) :- row(R,north), row(R+1,north).
edge(R,north,outline(north)) :- row(R,north).
edge(R,south,yard(north)) :- row(R,north).
edge(R,west,outline(west)) :- row(R,north), not next(_,R).
edge(R,east,joint(R)) :- next(R,_).
edge(R,west,joint(Q)) :- next(Q,R).
edge(R,east,outline(east)) :- row(R,north), not next(R,_).
edge(R,north,yard(north)) :- row(R,(west;east)).
edge(R,south,outline(south)) :- row(R,(west;east)).
edge(R,S,outline(S)) :- row(R,S), S != north.
edge(R,T,yard(S)) :- row(R,S), S != north, opposite(S,T).
outer(R,T) :- row(R,D), opposite(D,T).
face(R,Q) :- next(R,Q).
face(Q,R) :- next(R,Q).
face(R,Q) :- row(R,north), row(Q,(west;east)).
face(Q,R) :- row(R,north), row(Q,(west;east)).
"""
LEG = """#program house.
% An L: rooms in a row along the north, and rooms that go south from the first of them, along the west.
option(k,2..rooms-2,1).
arm(R,north) :- pick(k,K), R = 0..K-1.
arm(R,west) :- pick(k,K), R = K..rooms-1.
nx(R,R+1) :- arm(R,A), arm(R+1,A).
edge(R,north,outline(north)) :- arm(R,north).
edge(R,south,under) :- arm(R,north).
edge(R,west,outline(west)) :- arm(R,north), not nx(_,R).
edge(R,east,j(R)) :- nx(R,_), arm(R,north).
edge(Q,west,j(R)) :- nx(R,Q), arm(R,north).
edge(R,east,outline(east)) :- arm(R,north), not nx(R,_).
edge(R,west,outline(west)) :- arm(R,west).
edge(R,east,leg) :- arm(R,west).
edge(R,north,under) :- arm(R,west), not nx(_,R).
edge(R,south,j(R)) :- nx(R,_), arm(R,west).
edge(Q,north,j(R)) :- nx(R,Q), arm(R,west).
edge(R,south,outline(south)) :- arm(R,west), not nx(R,_).
outer(R,south) :- arm(R,north).
outer(R,east) :- arm(R,west).
face(R,Q) :- nx(R,Q). face(Q,R) :- nx(R,Q).
face(R,Q) :- arm(R,north), pick(k,Q). face(Q,R) :- arm(R,north), pick(k,Q).
"""
PINWHEEL = """#program house.
% Four rooms around what is no room.
:- rooms != 4.
edge(R,S,outline(S)) :- (R,S) = ((0,north);(0,west);(1,north);(1,east);(2,south);(2,east);(3,south);(3,west)).
edge(0,south,yard(north)).  edge(3,north,yard(north)).
edge(0,east,yard(east)).    edge(1,west,yard(east)).
edge(1,south,yard(south)).  edge(2,north,yard(south)).
edge(2,west,yard(west)).    edge(3,east,yard(west)).
outer(0,south).  outer(1,west).  outer(2,north).  outer(3,east).
face(R,(R+1)\\4) :- R = 0..3.
face((R+1)\\4,R) :- R = 0..3.
"""
COURTS = "court(yard(west),yard(east)).\n"
PATIO = COURTS + "court(yard(north),yard(south)).\n"
HOUSES = "houses"
NO_PLAN = r"mine.lp:\d+:\d+: a house of \d rooms by this topology is not a valid plan: .*"


def at(line: int, says: str) -> str:
    """Return an error in this line of the topology."""
    return says.replace(r"\d+", str(line), 1)


def without(text: str, part: str) -> str:
    """Return a topology without the lines that begin with ``part``."""
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith(part))


TOPOLOGIES: dict[str, tuple[str, int, str]] = {
    "two rows": (ROWS, 5, HOUSES),
    "a courtyard": (COURTYARD + COURTS, 6, HOUSES),
    "a courtyard without an order of its walls": (COURTYARD, 5, NO_PLAN + "overlaps"),
    "a courtyard that rooms enclose": (
        PINWHEEL + PATIO,
        4,
        at(5, NO_PLAN + r"are no room's.* \(lines 6, 7, 8 too\)$"),
    ),
    "outer walls everywhere": (ROWS + "outer(R,S) :- R = 0..rooms-1, opposite(S,_).\n", 5, HOUSES),
    "outer walls of no room": (ROWS + "outer(99,north).\nouter(0,wall(north)).\n", 5, "mine.lp"),
    "a room behind an outer wall, on a side of the windows": (
        COURTYARD + COURTS + "beyond(R,south,Q,after) :- row(R,north), row(Q,west).\n",
        5,
        HOUSES,
    ),
    "a room behind an outer wall, on no side": (
        COURTYARD + COURTS + "beyond(R,south,Q,west) :- row(R,north), row(Q,west).\n",
        5,
        r"mine.lp:21:1: beyond",
    ),
    "a room behind a wall that it is not at": (ROWS + "beyond(0,north,99,before).\n", 5, r"mine.lp:19:1"),
    "a hub of a type that no rule says": (ROWS + "centred.\n", 5, r"rooms.lp:1:1: .*by central/1"),
    "outer walls between two rooms": (ROWS + "outer(0,(north;south)).\n", 5, HOUSES),
    "a court that lies on a line of one side alone": (
        LEG,
        5,
        HOUSES,
    ),
    "a misspelt outline": (
        ROWS.replace("edge(R,S,outline(S))", "edge(R,S,outlin(S))"),
        5,
        r"mine.lp:9:1: outlin is a line that occurs nowhere else: did you mean outline",
    ),
    "a misspelt choice": (
        ROWS.replace("option(north", "option(nroth"),
        5,
        r"mine.lp:3:18: pick\(north,N\): no option/3 has this name: did you mean nroth",
    ),
    "rooms that face nothing": (without(ROWS, "face"), 5, "mine.lp"),
    "rooms that face one way": (without(without(ROWS, "face(0"), "face(Q"), 5, HOUSES),
    "rooms that face all others": (ROWS + "face(R,Q) :- R = 0..rooms-1, Q = 0..rooms-1.\n", 5, HOUSES),
    "rooms that face what is none": (ROWS + "face(R,77) :- R = 0..rooms-1.\nface(77,0).\n", 5, "mine.lp"),
    "doors anywhere": (ROWS + "may_open(R,Q) :- R = 0..rooms-1, Q = 0..rooms-1.\n", 5, HOUSES),
    "doors nowhere": (ROWS + "selective.\n", 5, "mine.lp"),
    "a hub that is no room": (ROWS.replace("hub(0)", "hub(99)"), 5, r"mine.lp:6:1: hub\(99\)\."),
    "no walls": (without(ROWS, "edge"), 5, "mine.lp"),
    "a wall too few": (without(ROWS, "edge(R,T,wall"), 5, "mine.lp"),
    "a wall too many": (ROWS + "edge(0,north,wall(south)).\n", 5, r"mine.lp:19:1"),
    "walls of no room": (ROWS + "edge(99,S,outline(S)) :- opposite(S,_).\n", 5, r"mine.lp:19:1"),
    "walls on no side": (ROWS + "edge(R,wall(north),R) :- R = 0..rooms-1.\n", 5, r"mine.lp:19:1"),
    "a wall that runs both ways": (
        ROWS.replace("joint(Q)", "wall(S)").replace("next(Q,R)", "next(Q,R), side(Q,S)"),
        5,
        "mine.lp",
    ),
    "walls with no order": (
        ROWS.replace("joint(R)", "joint(R,R)").replace("joint(Q)", "joint(R)"),
        5,
        at(11, NO_PLAN + r"overlaps .* \(lines 13 too\)$"),
    ),
    "an outline that lacks a side": (
        ROWS.replace("outline(east)", "wall(east)").replace("(west;east)", "west")
        + "edge(0,east,wall(east)).\n",
        5,
        "mine.lp",
    ),
    "an outline turned round": (
        ROWS.replace("edge(R,S,outline(S))", "edge(R,S,outline(T))").replace(
            ":- side(R,S).\nedge(R,T", ":- side(R,S), opposite(S,T).\nedge(R,T"
        ),
        5,
        "mine.lp",
    ),
    "walls in a circle": (ROWS + "court(wall(south),wall(north)).\n", 5, r"mine.lp:19:1"),
    "inner walls alone": (ROWS + "inner(S) :- opposite(S,_).\n", 5, "mine.lp"),
    "too few rooms": (
        ROWS + "most_rooms(none).\n",
        5,
        r"mine.lp:19:1: most_rooms\(none\): the number of rooms",
    ),
    "turns that are no number": (
        ROWS + "turn(north,late).\n",
        5,
        r"mine.lp:19:1: turn\(north,late\): the turn must",
    ),
}


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_a_topology_makes_houses_that_the_check_accepts_or_an_answer_that_names_its_line(
    name: str, tmp_path: Path
) -> None:
    text, rooms, says = TOPOLOGIES[name]
    for file, content in (("rooms.lp", RULES), ("sizes.pl", SIZES), ("mine.lp", text)):
        (tmp_path / file).write_text(content)
    answer = HOUSES
    try:
        made = builder(tmp_path)
        for index in range(2):
            assert check(house_or_proof(made, HouseRequest(rooms), 1, index)) == []
    except (GrammarError, Unsatisfiable) as error:
        answer = str(error)
    assert re.search(says, answer), answer


def test_a_window_at_a_courtyard_is_where_no_other_room_is_behind_the_wall(tmp_path: Path) -> None:
    for file, content in (("rooms.lp", RULES), ("sizes.pl", SIZES), ("mine.lp", COURTYARD + COURTS)):
        (tmp_path / file).write_text(content)
    made = builder(tmp_path)
    partly = 0
    for index in range(8):
        house = made.house(HouseRequest(5), 2, index)
        yard = max(room.y for room in house.rooms)
        for window in house.windows:
            room = house.room(window.room)
            if window.y == pytest.approx(yard) and room.y < 1e-6:
                partly += any(shared(room.box, other.box) > 0 for other in house.rooms if other.y > 1e-6)
    assert partly


@pytest.mark.parametrize(
    ("file", "topology", "says"),
    [
        ("more.lp", "mine", r"more.lp:2:1: the topology states outer/2: move this to mine.lp"),
        (
            "more.lp",
            "ring",
            r"more.lp:2:1: the topology states outer/2, here ring: one of your own is a file",
        ),
    ],
)
def test_what_a_topology_states_stands_in_its_file_alone(
    tmp_path: Path, file: str, topology: str, says: str
) -> None:
    for name, content in (
        ("rooms.lp", RULES.replace("mine", topology)),
        ("sizes.pl", SIZES),
        ("mine.lp", ROWS if topology == "mine" else "% None.\n"),
        (file, "#program house.\nouter(R,S) :- edge(R,S,_).\n"),
    ):
        (tmp_path / name).write_text(content)
    with pytest.raises(GrammarError, match=says):
        builder(tmp_path)
