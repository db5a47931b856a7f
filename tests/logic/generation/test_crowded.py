"""Rooms of many pieces, in which sampled picks lead to proofs that the pieces do not fit in a few rows."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import clingo
import numpy as np
import pytest

from tests.logic.generation import classrooms
from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.language.linter import all_warnings
from vitruvius.logic.layout import program
from vitruvius.logic.layout.program import Program, TooMany, of_one_house
from vitruvius.logic.layout.programs import MIN_CROWD_PIECES, crowded
from vitruvius.logic.layout.relaxed import Relaxed, Statement
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

DESKS = """
{types}
may(classroom,desk,8,8).   stands(desk,middle).  around(desk,chair,1,1).  rows(classroom,4).
may(classroom,board,1,1).  stands(board,back).
#program room.
:- with(desk,_,chair,H), H != outwards.
:- row(inwards).
% Rows of three desks or more, and so two rows: in three rows one has too few.
desks(P,N) :- on(desk,_,P,_), N = #count{{ K : on(desk,K,P,_) }}.
:- desks(_,N), N < 3.
"""
PLACES = """
option(at(1..{pieces}),1..{places},1).
:- pick(at(P),X), pick(at(Q),X), P < Q.
"""


def builder(folder: Path, star: bool = False) -> Builder:
    return classrooms.builder(folder, DESKS, star)


def rows(house: House) -> list[list[int]]:
    """Return the number of desks in each row of each classroom."""
    found = []
    for room in house.rooms:
        if room.type == "classroom":
            desks = [piece for piece in room.children if piece.type == "desk"]
            way = next(each.orientation for each in room.children if each.type == "board") in "NS"
            found.append(sorted(Counter(round(each.y if way else each.x, 6) for each in desks).values()))
    return found


@pytest.mark.parametrize(("star", "seed"), [(False, 0), (False, 1), (True, 1)])
def test_pieces_in_rows_that_picks_do_not_find_are_found(tmp_path: Path, star: bool, seed: int) -> None:
    house = builder(tmp_path, star).house(HouseRequest(1 if star else 3), seed, 0)
    assert check(house) == []
    assert all(len(desks) == 2 and sum(desks) == 8 and min(desks) >= 3 for desks in rows(house))
    assert len(rows(house)) == (1 if star else 2)


def test_a_house_of_crowded_rooms_depends_on_no_house_before_it(tmp_path: Path) -> None:
    rules, request = builder(tmp_path, star=True), HouseRequest(1)
    alone = rules.house(request, 2, 0)
    other = builder(tmp_path, star=True)
    all_warnings(other.grammar, other.loaded)  # which grounds the programs of all types
    assert other.house(request, 1, 0) != alone
    assert other.house(request, 2, 0) == alone


@pytest.mark.parametrize(
    ("facts", "types"),
    [
        ([("desk", 0, MIN_CROWD_PIECES)], {"hall"}),
        ([("desk", 1, MIN_CROWD_PIECES - 1)], set[str]()),
        ([("desk", 2, 2), ("sofa", MIN_CROWD_PIECES - 2, MIN_CROWD_PIECES - 2)], {"hall"}),
    ],
)
def test_a_type_is_crowded_by_many_pieces_of_a_kind_or_many_that_it_needs(
    facts: list[tuple[str, int, int]], types: set[str]
) -> None:
    assert crowded(clingo.parse_term(f"may(hall,{kind},{a},{b})") for kind, a, b in facts) == types


def test_a_proof_about_furniture_tests_few_statements_where_no_length_has_a_part_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cores, core = list[int](), Relaxed.core

    def counted(self: Relaxed, some: Sequence[Statement]) -> list[Statement]:
        cores.append(len(some))
        return core(self, some)

    monkeypatch.setattr(Relaxed, "core", counted)
    with pytest.raises(Unsatisfiable) as proof:
        house_or_proof(builder(tmp_path, star=True), HouseRequest(1, furniture={"desk": (16, 16)}), 0, 0)
    assert {"may(classroom,desk,8,8).", "--piece desk=16"} <= {each.text for each in proof.value.reasons}
    assert len(cores) < 10


def places(folder: Path, pieces: int, bounded: bool = True) -> Program:
    """Return a program that puts pieces into one place fewer: a pigeonhole problem."""
    file = folder / "places.lp"
    file.write_text(PLACES.format(pieces=pieces, places=pieces - 1))
    return Program([file], {}, [], searching=of_one_house(1, bounded))


def test_a_bounded_program_ends_its_searches_undecided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "BOUNDED_CONFLICTS", (10, 20))
    hard = places(tmp_path, 9)
    with pytest.raises(TooMany):
        hard.sample(np.random.default_rng(0))
    assert places(tmp_path, 4).sample(np.random.default_rng(0)) is None, "an easy one is decided"
