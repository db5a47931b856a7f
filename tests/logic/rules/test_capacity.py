"""``capacity.lp`` is redundant: it refuses no furniture for which CLP(R) finds places."""

import re

import numpy as np
import pytest
from clingo import Function, Number, Symbol

from tests.logic.workers import in_process
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.program import CORE, Program
from vitruvius.logic.placement.layout import Layout, RoomLayout
from vitruvius.logic.placement.placer import Infeasible

WIDE = [Number(mm) for mm in (1, 99999, 1, 99999)]


@pytest.fixture
def builder() -> Builder:
    return in_process.builder("family")


def shown(program: Program) -> list[Symbol]:
    """Return all atoms of the signatures in a room's layout."""
    text = (CORE.parent / "room" / "room.lp").read_text()
    return [
        atom
        for name, arity in re.findall(r"#show (\w+)/(\d)", text)
        for atom in program.atoms(name, int(arity))
    ]


@pytest.mark.parametrize("kind", ["bathroom", "bedroom", "hall", "kitchen"])
def test_furniture_that_the_capacity_rules_refuse_has_no_places(builder: Builder, kind: str) -> None:
    strict = builder.programs.furniture(kind)
    pieces = {
        str(symbol.arguments[1]) for symbol in strict.atoms("may", 4) if str(symbol.arguments[0]) == kind
    }
    companions = [*strict.atoms("beside", 4), *strict.atoms("around", 4)]
    pieces |= {str(atom.arguments[1]) for atom in companions if str(atom.arguments[0]) in pieces}
    lax = Program(
        find("family").asp,
        {"this_room": kind},
        [
            ("room", []),
            ("capacity", []),
            *(
                ("length", [Function(name), Number(0)])
                for name in ("door_width", "door_clearance", "passage")
            ),
            ("reach", [Function(kind), *WIDE]),
            *(("extent", [Function(piece), *WIDE]) for piece in pieces),
        ],
    )
    verdicts = {True: 0, False: 0}
    for seed in range(250):
        rng = np.random.default_rng(seed)
        furniture = lax.sample(rng)
        assert furniture
        others = [atom for atom in shown(strict) if atom not in furniture]
        allowed = set(furniture) <= set(shown(strict)) and strict.possible(furniture, without=others)
        verdicts[allowed] += 1
        if not allowed:
            room = RoomLayout(0, Function(kind), Function("north"), furniture)
            with pytest.raises(Infeasible):
                builder.placer.place(Layout([room], []), rng, 10**8)
    assert verdicts[True]
    assert verdicts[False] or kind == "kitchen", "both; but kitchens are spacious"
