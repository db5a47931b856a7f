"""Even rows: as many pieces in each, in line from row to row, at equal distances both ways."""

from itertools import pairwise
from pathlib import Path

import msgspec
import pytest

from tests.logic.generation import classrooms
from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

SCHOOL = """
{types}
may(classroom,desk,6,9).   stands(desk,middle).  around(desk,chair,1,1).  rows(classroom,4).
may(classroom,board,1,1).  stands(board,back).
even_rows(classroom).
#program room.
:- with(desk,_,chair,H), H != outwards.
:- this_room = classroom, row(inwards).
:- on(desk,_,P,5), at(P,middle).
"""


def builder(folder: Path, star: bool = True, cell: float = 0.0) -> Builder:
    return classrooms.builder(folder, SCHOOL, star, cell)


def classroom(house: House) -> Room:
    return next(room for room in house.rooms if room.type == "classroom")


@pytest.mark.parametrize(("star", "seed", "cell"), [(True, 0, 0.0), (True, 1, 0.3), (False, 0, 0.0)])
def test_desks_stand_in_a_grid(tmp_path: Path, star: bool, seed: int, cell: float) -> None:
    request = HouseRequest(1 if star else 2, cell=cell)
    house = builder(tmp_path, star, cell).house(request, seed, 0)
    assert check(house) == []
    desks = [piece for piece in classroom(house).children if piece.type == "desk"]
    xs, ys = (
        {round(place, 5) for place in places} for places in ([d.x for d in desks], [d.y for d in desks])
    )
    assert len(xs) * len(ys) == len(desks)
    for places in (sorted(xs), sorted(ys)):
        assert [after - before for before, after in pairwise(places)] == pytest.approx(
            [places[-1] - places[-2]] * (len(places) - 1), abs=1e-4
        )


def test_check_finds_a_desk_out_of_line_by_geometry(tmp_path: Path) -> None:
    house = builder(tmp_path, star=False).house(HouseRequest(2), 0, 0)
    room = classroom(house)
    moved = [
        msgspec.structs.replace(each, x=each.x + 0.01, children=()) if each.type == "desk" and not n else each
        for n, each in enumerate(sorted(room.children, key=lambda each: each.type != "desk"))
    ]
    changed = msgspec.structs.replace(room, children=tuple(moved))
    rooms = tuple(changed if each is room else each for each in house.rooms)
    assert any("uneven rows" in line for line in check(msgspec.structs.replace(house, rooms=rooms)))


@pytest.mark.second_part("a long proof")
def test_a_proof_names_that_rows_are_even(tmp_path: Path) -> None:
    """Seven desks are no grid, and no row of at most four."""
    with pytest.raises(Unsatisfiable) as proof:
        house_or_proof(builder(tmp_path), HouseRequest(1, furniture={"desk": (7, 7)}), 0, 0)
    assert any(reason.text == "even_rows(classroom)." for reason in proof.value.reasons)
