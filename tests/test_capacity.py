"""``capacity.lp`` is redundant: it refuses no furniture for which CLP(R) finds places."""

import shutil

import numpy as np
import pytest
from clingo import Function, Number

from logic.builder import FURNISHING, Builder
from logic.grammar import SHIPPED, find
from logic.layout import Program
from logic.placement import Layout, Refuted, RoomLayout

WIDE = [Number(mm) for mm in (1, 99999, 1, 99999)]


@pytest.fixture(scope="module")
def builder(tmp_path_factory: pytest.TempPathFactory) -> Builder:
    """The family with desks of 70 to 100 % of their wall: extremes that differ from room to room."""
    folder = tmp_path_factory.mktemp("grammar") / "desks"
    shutil.copytree(SHIPPED / "family", folder)
    sizes = (folder / "sizes.pl").read_text()
    old = "piece_size(desk,      L, D, _) :- { L >= 1.2,  L =< 2.8,"
    assert old in sizes
    new = "piece_size(desk, L, D, Wall) :- { L >= 0.7*Wall, L =< Wall,"
    (folder / "sizes.pl").write_text(sizes.replace(old, new))
    return Builder(find(folder))


@pytest.mark.parametrize("kind", ["bathroom", "bedroom", "hall", "kitchen"])
def test_what_capacity_refuses_has_no_places(builder: Builder, kind: str) -> None:
    strict = builder._furnishing[kind]
    pieces = {
        str(symbol.arguments[1]) for symbol in strict.atoms("may", 4) if str(symbol.arguments[0]) == kind
    }
    lax = Program(
        find("family").asp,
        {"this_room": kind},
        [
            ("room", []),
            *(
                ("length", [Function(name), Number(0)])
                for name in ("door_width", "door_clearance", "passage")
            ),
            ("reach", [Function(kind), *WIDE]),
            *(("extent", [Function(piece), *WIDE]) for piece in pieces),
        ],
        FURNISHING,
    )
    verdicts = {True: 0, False: 0}
    for seed in range(250):
        rng = np.random.default_rng(seed)
        furniture = lax.draw(rng)
        assert furniture
        others = [
            atom for signature in FURNISHING for atom in strict.atoms(*signature) if atom not in furniture
        ]
        allowed = strict.possible(furniture, without=others)
        verdicts[allowed] += 1
        if not allowed:
            room = RoomLayout(0, Function(kind), Function("north"), furniture)
            with pytest.raises(Refuted):
                builder.place(Layout([room], []), rng, 10**8)
    assert all(verdicts.values()), "a sample that says something has both"
