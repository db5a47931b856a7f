"""What is drawn is drawn fairly: gaps on their simplex, sizes in their range, layouts alike; and counted."""

import json
from collections import Counter
from math import comb, factorial
from pathlib import Path

import numpy as np
import pytest
from clingo import Function, parse_term
from scipy.stats import beta, kstest

from logic import count_layouts
from logic.builder import Builder
from logic.grammar import SHIPPED, find
from logic.layout import EVERY, Program
from logic.placement import Layout, RoomLayout

ALPHA = 1e-3
"""The seeds are fixed, so a test passes always or never: this is how rare a draw it may stand on."""


@pytest.fixture(scope="module")
def builder() -> Builder:
    return Builder(find("family"))


def asked(builder: Builder, goal: str) -> list[list[float]]:
    """All answers of a goal with the variable Xs, a list of numbers, for the seeds 1 to 2000."""
    each = f"findall(Xs,(between(1,2000,I),Seed is I*7919,{goal}),All)"
    return builder._placer._json(f"({each},with_output_to(string(Json),json:json_write(current_output,All)))")


@pytest.mark.parametrize("pieces", [1, 2, 3, 5])
def test_gaps_on_a_chain_are_uniform_on_their_simplex(builder: Builder, pieces: int) -> None:
    """With k pieces of a half metre on 10 m there are k + 1 gaps: each is Beta(1, k) of what they share."""
    names = [f"S{i}" for i in range(pieces)]
    blocks = [f"block({name},0.5,[at_least(0.0)-[],at_most(9.5)-[]],[])" for name in names]
    goal = f"call(chain:draw_chain([{','.join(blocks)}],0.0),Seed,_),Xs=[{','.join(names)}]"
    starts = np.array(asked(builder, goal))
    ends = np.hstack([np.zeros((len(starts), 1)), starts + 0.5])
    gaps = np.hstack([starts, np.full((len(starts), 1), 10.0)]) - ends
    shares = gaps / (10 - 0.5 * pieces)
    assert np.allclose(shares.sum(axis=1), 1)
    for gap in shares.T:
        assert kstest(gap, beta(1, pieces).cdf).pvalue > ALPHA


def test_on_a_grid_whole_gaps_come_from_the_whole_range(builder: Builder) -> None:
    """The law rounded down: of one piece of 1 cell on 5, every place is as likely."""
    grid = "draw:(retractall(lattice(_)),assertz(lattice(whole)))"
    real = "draw:(retractall(lattice(_)),assertz(lattice(real)))"
    block = "block(S,1,[at_least(0)-[],at_most(4)-[]],[])"
    goal = f"{grid},call(chain:draw_chain([{block}],0),Seed,_),{real},Xs=[S]"
    counted = Counter(int(start) for (start,) in asked(builder, goal))
    assert sorted(counted) == [0, 1, 2, 3, 4]
    assert min(counted.values()) > 330


def test_a_piece_stands_anywhere_on_its_wall(builder: Builder) -> None:
    """In whole rooms: one toilet, apart from both ends of the back wall."""
    layout = [parse_term(atom) for atom in ("on(toilet,1,back,1)", "busy(back)", "last(back,1)")]
    shares, widths = [], []
    for seed in range(600):
        room = RoomLayout(0, Function("bathroom"), Function("north"), layout, seed * 104729)
        (made,) = builder.place(Layout([room], []), np.random.default_rng(seed), 10**8)["rooms"]
        (toilet,) = made["children"]
        slack = made["width"] - 2 * 0.42 - toilet["width"]
        shares.append((toilet["x"] - made["x"] - 0.42) / slack)
        widths.append((made["width"] - 2.4) / (3.7 - 2.4))
    assert kstest(shares, "uniform").pvalue > ALPHA
    assert kstest(widths, "uniform").pvalue > ALPHA, "a size that nothing binds is uniform in its range"


# Counting.


def test_layouts_are_counted_exactly(tmp_path: Path) -> None:
    """Three coins of which not all show heads: seven layouts, whatever else the model says."""
    file = tmp_path / "coins.lp"
    file.write_text("""
        #program coins.
        option(coin(1..3),(heads;tails),1).
        option(hidden,1..9,1).
        heads(C) :- pick(coin(C),heads).
        :- heads(1), heads(2), heads(3).
        #show heads/1.
    """)
    made = Program([file], {}, [("coins", [])], EVERY)
    assert made.count([], 60) == (7, True)
    assert made.count([], 0) == (1, False)


def test_the_layouts_of_four_rooms_are_as_many_as_combinatorics_says() -> None:
    """Types of 4 rooms with one of each basic type at least; bars; corners: README of the count."""
    (rooms, number, whole), *furniture = count_layouts(4, seconds=0.2)
    assert (rooms, whole) == ("4 rooms", True)
    types = 3 * factorial(4) // 2 + factorial(4)  # a basic type twice, or the hall once
    # At most two rooms a side; two ways for each pair of neighbouring sides that both have rooms.
    divisions = [
        (a, b, c, 4 - a - b - c)
        for a in range(3)
        for b in range(3)
        for c in range(3)
        if 0 <= 4 - a - b - c <= 2
    ]
    corners = sum(2 ** sum(1 for i in range(4) if d[i] and d[(i + 1) % 4]) for d in divisions)
    assert number == types * corners
    assert comb(7, 3) > len(divisions)
    assert {name for name, _, _ in furniture} == {"bathroom", "bedroom", "hall", "kitchen"}


def test_what_cannot_be_counted_in_time_is_stated() -> None:
    counts = {name: (number, whole) for name, number, whole in count_layouts(2, seconds=0.2)}
    assert counts["bedroom"][1] is False
    assert counts["bedroom"][0] > 100


def test_the_published_figures_are_there() -> None:
    figures = json.loads((SHIPPED.parents[1] / "docs" / "sampling.json").read_text())
    assert figures["entropy share of 4 rooms"] >= 0.95
