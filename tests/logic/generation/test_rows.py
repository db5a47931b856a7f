"""Rows of desks in the middle of a room: parallel, a passage apart, refused if they do not fit."""

from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import pytest

from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

PASSAGE = 0.7
EXACT = 1e-6
SCHOOL = """
type(classroom).
may(classroom,desk,{desks}).  stands(desk,middle).  around(desk,chair,1,1).  rows(classroom,3).
may(classroom,board,1,1).     stands(board,back).
#program room.
:- with(desk,_,chair,H), H != outwards.
:- row(inwards).
full(P) :- on(_,_,P,{width}), at(P,middle).
:- on(_,_,middle(2),_), not full(middle).
:- on(_,_,middle(I+1),_), I > 1, not full(middle(I)).
:- on(_,_,P,{width}+1), at(P,middle).
"""
SIZES = """
door_width(0.9).  door_clearance(0.1).  passage(0.7).  room_gap(0.2).
room_size(classroom, W, D) :- {{ W >= 6, W =< 9, D >= {least}, D =< {most} }}.
piece_size(desk, L, D, _)  :- {{ L >= 1.0, L =< 1.4, D = 0.6 }}.
piece_size(chair, L, D, _) :- {{ L = 0.45, D = 0.45 }}.
piece_size(board, L, D, _) :- {{ L >= 1.8, L =< 3, D = 0.1 }}.
"""
# Three desks of 0.6 m with a chair of 0.45 m, a passage before, between and behind them, and the board.
JUST = 3 * (0.6 + 0.45) + 4 * PASSAGE + 0.1


def builder(folder: Path, desks: str = "6,9", width: int = 3, least: float = 6, most: float = 9) -> Builder:
    (folder / "school.lp").write_text(SCHOOL.format(desks=desks, width=width))
    (folder / "sizes.pl").write_text(SIZES.format(least=least, most=most))
    return Builder(find(folder))


def across(orientation: str) -> int:
    """Return the axis of the house along which rows run whose desks face this direction: 0 for x."""
    return 0 if orientation in "NS" else 1


def with_chair(desk: Piece) -> Box:
    boxes = [desk.box, *(chair.box for chair in desk.children)]
    wests, norths, easts, souths = zip(*boxes, strict=True)
    return min(wests), min(norths), max(easts), max(souths)


def rows(house: House) -> list[list[list[Box]]]:
    """Return for each room the desks with their chairs by row: those with their backs in one line."""
    found = []
    for room in house.rooms:
        if room.type != "classroom":
            continue
        by_line = defaultdict[float, list[Box]](list)
        way = next(piece.orientation for piece in room.children if piece.type == "board")
        axis = 1 - across(way)
        for desk in room.children:
            if desk.type == "desk":
                box = with_chair(desk)
                # The chair is outwards, towards the door. Rows start at that edge.
                assert len(desk.children) == 1
                edge = box[axis + 2] if way in "SE" else box[axis]
                by_line[round(edge, 6)].append(box)
        found.append([sorted(boxes, key=lambda box: box[1 - axis]) for _, boxes in sorted(by_line.items())])
    return found


def test_desks_stand_in_parallel_rows_a_passage_apart(tmp_path: Path) -> None:
    of, counts = builder(tmp_path), set[int]()
    for seed in range(8):
        house = of.house(HouseRequest(2), seed, 0)
        assert check(house) == []
        for found in rows(house):
            counts.add(sum(map(len, found)))
            assert sorted(map(len, found))[1:] == [3] * (len(found) - 1), "a row began before one was full"
            full = max(found, key=len)
            axis = 0 if full[1][0] - full[0][0] > PASSAGE else 1
            for row in found:
                for one, other in pairwise(row):
                    assert other[axis] - one[axis + 2] >= PASSAGE - EXACT
            for one, other in pairwise(found):
                nearest = min(box[1 - axis] for box in other) - max(box[3 - axis] for box in one)
                assert nearest >= PASSAGE - EXACT
    assert {6, 9} <= counts <= {6, 7, 8, 9}


def test_rows_that_just_fit_do_and_a_centimetre_less_is_proved(tmp_path: Path) -> None:
    house = builder(tmp_path, "3,3", 1, 4, JUST).house(HouseRequest(1), 0, 0)
    assert check(house) == []
    assert house.rooms[0].width == pytest.approx(JUST) or house.rooms[0].height == pytest.approx(JUST)
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(builder(tmp_path, "3,3", 1, 4, JUST - 0.01), HouseRequest(1), 0, 0)
    reasons = " ".join(reason.text for reason in caught.value.reasons)
    assert all(each in reasons for each in ("piece_size(desk", "passage(0.7)"))
