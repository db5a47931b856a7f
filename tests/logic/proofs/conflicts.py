"""Requests without a house: edits of family's files, the request, and the whole conflict."""

from typing import Any

BASIC = "rooms.lp: basic(bedroom; bathroom; kitchen)."
EACH = "rooms.lp: :- rooms >= 3, basic(T), not room(_,T)."
TWO = "rooms.lp: :- rooms >= 2, { room(R,T) : basic(T) } < 2."
BED = "furniture.lp: may(bedroom,bed,1,2)."
ALONE = "#program house.\n:- room(_,bedroom), room(_,kitchen)."
TOILET = "furniture.lp: may(bathroom,toilet,1,1)."
DOOR = "sizes.pl: door_width(0.762)."
BATHROOM = "sizes.pl: room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7 }."

ANYWHERE = "stands(toilet,   (front; left; back; right))."

FILLED = """#program room.
:- busy(S), not end(S), this_room = bedroom.
:- on(bed,K,_,_), not joined(bed,K).
:- on(wardrobe,_,_,_)."""

Edits = dict[str, tuple[str, str]]
"""For a file, a text in it and its replacement."""

CASES: dict[str, tuple[Edits, dict[str, Any], list[str]]] = {
    "too many of a type": (
        {},
        {"rooms": 3, "types": {"bathroom": 9, "kitchen": 1}},
        ["--rooms 3", "--type bathroom=9"],
    ),
    "a basic type is missing": (
        {},
        {"rooms": 3, "types": {"kitchen": 0}},
        ["--rooms 3", BASIC, EACH, "--type kitchen=0"],
    ),
    "no basic types in two rooms": (
        {},
        {"rooms": 2, "types": {"hall": (1, None)}},
        ["--rooms 2", TWO, "--type hall=1.."],
    ),
    "minima add up to too much": (
        {},
        {"rooms": 2, "types": {"bedroom": (2, None), "bathroom": (1, 3)}},
        ["--rooms 2", "--type bathroom=1..3", "--type bedroom=2.."],
    ),
    "all types have maxima": (
        {},
        {"rooms": 9, "types": dict.fromkeys(("bedroom", "bathroom", "kitchen", "hall"), (0, 2))},
        [
            "--rooms 9",
            "--type bathroom=0..2",
            "--type bedroom=0..2",
            "--type hall=0..2",
            "--type kitchen=0..2",
        ],
    ),
    "more beds than a room may have": (
        {},
        {"rooms": 3, "furniture": {"bedroom.bed": (3, None)}},
        ["--rooms 3", BASIC, EACH, BED, "--piece bedroom.bed=3.."],
    ),
    "more chairs than a table has": (
        {},
        {"rooms": 1, "types": {"kitchen": 1}, "furniture": {"chair": 5}},
        ["--type kitchen=1", "furniture.lp: may(kitchen,table,0,1).", "--piece chair=5"],
    ),
    "no bed in a bedroom": (
        {},
        {"rooms": 3, "furniture": {"bed": 0}},
        ["--rooms 3", BASIC, EACH, BED, "--piece bed=0"],
    ),
    "two rules contradict each other": (
        {"rooms.lp": (":- rooms >= 2,", ":- room(_,bedroom).\n:- not room(_,bedroom).\n:- rooms >= 2,")},
        {"rooms": 2},
        ["rooms.lp: :- room(_,bedroom).", "rooms.lp: :- not room(_,bedroom)."],
    ),
    "a rule against the paper's": (
        {"rooms.lp": ("#program house.", ALONE)},
        {"rooms": 3},
        ["--rooms 3", BASIC, ALONE.replace("#program house.\n", "rooms.lp: "), EACH],
    ),
    "a rule of the rooms' furniture": (
        {"arrangement.lp": ("#program room.", "#program room.\n:- on(toilet,_,_,_).")},
        {"rooms": 4},
        [
            "--rooms 4",
            BASIC,
            EACH,
            "arrangement.lp: :- on(toilet,_,_,_).",
            TOILET,
        ],
    ),
    "a table with no way round it": (
        {
            "sizes.pl": (
                "piece_size(hallTable, L, D, _) :- { L >= 1.0,  L =< 2.0,",
                "piece_size(hallTable, L, D, _) :- { L >= 5.5,  L =< 6.0,",
            ),
            "furniture.lp": ("may(hall,hallTable,0,1)", "may(hall,hallTable,1,1)"),
        },
        {"rooms": 1, "types": {"hall": 1}},
        [
            "--type hall=1",
            "furniture.lp: may(hall,hallTable,1,1).",
            "sizes.pl: passage(0.42).",
            "sizes.pl: room_size(hall, W, D) :- { W >= 4.2, W =< 6.1, D >= 4.2, D =< 6.1 }.",
            "sizes.pl: piece_size(hallTable, L, D, _) :- { L >= 5.5, L =< 6.0, D >= 0.8, D =< 1.2 }.",
        ],
    ),
    "a side for all rooms": (
        {"rooms.lp": ("#program house.", "#program house.\n:- side(_,S), S != north.")},
        {"rooms": 4},
        [
            "--rooms 4",
            "rooms.lp: :- side(_,S), S != north.",
            "rooms.lp: :- rooms >= 4, side(_,S), #count{ R : side(R,S) } > rooms/3 + 1.",
        ],
    ),
    "two counts of one piece": (
        {},
        {"rooms": 3, "furniture": {"bed": (2, None), "bedroom.bed": (0, 1)}},
        ["--rooms 3", BASIC, EACH, "--piece bed=2..", "--piece bedroom.bed=0..1"],
    ),
    "chairs without a table": (
        {},
        {"rooms": 3, "furniture": {"chair": (2, None), "table": 0}},
        ["--rooms 3", BASIC, EACH, "--piece chair=2..", "--piece table=0"],
    ),
    "companions that a rule forbids": (
        {
            "furniture.lp": ("may(kitchen,table,0,1)", "may(kitchen,table,1,1)"),
            "arrangement.lp": ("#program room.", "#program room.\n:- with(table,_,chair,_)."),
        },
        {"rooms": 3},
        [
            "--rooms 3",
            BASIC,
            EACH,
            "arrangement.lp: :- with(table,_,chair,_).",
            "furniture.lp: may(kitchen,table,1,1).",
            "furniture.lp: around(table,chair,1,4).",
        ],
    ),
    "a rule against the only place": (
        {
            "furniture.lp": (ANYWHERE, "stands(toilet, left)."),
            "arrangement.lp": ("#program room.", "#program room.\n:- on(toilet,_,left,_)."),
        },
        {"rooms": 1, "types": {"bathroom": 1}},
        ["--type bathroom=1", "arrangement.lp: :- on(toilet,_,left,_).", TOILET],
    ),
    "a room too small for its furniture": (
        {
            "sizes.pl": (
                "room_size(bedroom,  W, D) :- { W >= 3.2, W =< 5.2, D >= 3.2, D =< 5.2 }",
                "room_size(bedroom,  W, D) :- { W >= 1.2, W =< 1.95, D >= 1.2, D =< 1.95 }",
            )
        },
        {"rooms": 1, "types": {"bedroom": 1}},
        [
            "--type bedroom=1",
            BED,
            "arrangement.lp: :- turned(bed,K,near), touched(bed,K,far).",
            "arrangement.lp: :- turned(bed,K,far), touched(bed,K,near).",
            "sizes.pl: passage(0.42).",
            "sizes.pl: room_size(bedroom, W, D) :- { W >= 1.2, W =< 1.95, D >= 1.2, D =< 1.95 }.",
            "sizes.pl: piece_size(bed, L, D, _) :- { L >= 0.9, L =< 1.6, D >= 1.9, D =< 2.1 }.",
        ],
    ),
    "no room beside the door": (
        {
            "furniture.lp": (ANYWHERE, "stands(toilet, front)."),
            "sizes.pl": (
                "bathroom, W, D) :- { W >= 2.4, W =< 3.7,",
                "bathroom, W, D) :- { W >= 1.2, W =< 1.5,",
            ),
        },
        {"rooms": 1, "types": {"bathroom": 1}},
        [
            "--type bathroom=1",
            TOILET,
            DOOR,
            "sizes.pl: door_clearance(0.45).",
            "sizes.pl: room_size(bathroom, W, D) :- { W >= 1.2, W =< 1.5, D >= 2.4, D =< 3.7 }.",
            "sizes.pl: piece_size(toilet, L, D, _) :- { L >= 0.36, L =< 0.4, D = L + 0.3 }.",
        ],
    ),
    "a clearance too large": (
        {
            "furniture.lp": (ANYWHERE, "stands(toilet, front)."),
            "sizes.pl": ("door_clearance(0.45)", "door_clearance(3.0)"),
        },
        {"rooms": 1, "types": {"bathroom": 1}},
        ["--type bathroom=1", TOILET, DOOR, "sizes.pl: door_clearance(3.0).", BATHROOM],
    ),
    "a passage wider than a room": (
        {"sizes.pl": ("passage(0.42)", "passage(4.0)")},
        {"rooms": 1, "types": {"bathroom": 1}},
        ["--type bathroom=1", "sizes.pl: passage(4.0).", BATHROOM],
    ),
    "far too many of a type": (
        {},
        {"rooms": 3, "types": {"bathroom": 40}},
        ["--rooms 3", "--type bathroom=40"],
    ),
    "a count beside one that binds elsewhere": (
        {},
        {"rooms": 3, "furniture": {"bed": 1, "toilet": 0}},
        ["--rooms 3", BASIC, EACH, TOILET, "--piece toilet=0"],
    ),
    "walls that the pieces are too small to fill": (
        {
            "sizes.pl": ("W >= 3.2, W =< 5.2, D >= 3.2, D =< 5.2", "W = 8, D = 8"),
            "arrangement.lp": ("#program room.", FILLED),
        },
        {"rooms": 1, "types": {"bedroom": 1}},
        [
            "--type bedroom=1",
            "arrangement.lp: :- busy(S), not end(S), this_room = bedroom.",
            "arrangement.lp: :- on(bed,K,_,_), not joined(bed,K).",
            "arrangement.lp: :- on(wardrobe,_,_,_).",
            "sizes.pl: room_size(bedroom, W, D) :- { W = 8, D = 8 }.",
            "sizes.pl: piece_size(bed, L, D, _) :- { L >= 0.9, L =< 1.6, D >= 1.9, D =< 2.1 }.",
            "sizes.pl: piece_size(bedside, L, D, _) :- { L >= 0.4, L =< 0.6, D = L }.",
        ],
    ),
}
