"""Sampling is fair: gaps on their simplex, sizes in their range, all layouts; and layouts are counted."""

import json
import re
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import combinations_with_replacement, permutations, product
from pathlib import Path

import numpy as np
import pytest

from benchmarks.generator.laws import CHAINS, along_sides, held, on_a_chain, on_a_wall
from benchmarks.generator.layouts import by_rejection, entropy, every_layout
from vitruvius.cli import main
from vitruvius.logic import RequestError, count_layouts
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.program import ALL_LAYOUTS, Program
from vitruvius.logic.placement import prolog

pytestmark = pytest.mark.second_part("each study is run in small")

ALPHA = 1e-3
"""Significance level of the tests. The seeds are fixed, so a test passes always or never."""

COINS = """
#program coins.
option(coin(1..3),(heads;tails),1).
option(hidden,1..9,1).
heads(C) :- pick(coin(C),heads).
:- heads(1), heads(2), heads(3).
#show heads/1.
"""

# A grammar that is small enough to count by hand: crates along the back walls of cells.
CELLS = """
type(cell).    may(cell,crate,1,2).    stands(crate,back).
"""
SIZES = """
door_width(0.8).    door_clearance(0.4).    passage(0.5).    room_gap(0.5).
room_size(cell, W, D)  :- { W >= 4.0, W =< 5.0, D >= 4.0, D =< 5.0 }.
piece_size(crate, L, D, _) :- { L >= 0.5, L =< 0.6, D = L }.
"""


@pytest.fixture(scope="module")
def builder() -> Builder:
    return Builder(find("family"))


# Lengths.


@pytest.mark.parametrize("pieces", [1, 2, 3, 5])
def test_gaps_on_a_chain_are_uniform_on_their_simplex(pieces: int) -> None:
    """With k pieces of half a metre on 10 m there are k + 1 gaps: each is Beta(1, k) of their total."""
    gaps = on_a_chain(pieces, 2000)
    assert gaps.shape == (2000, pieces + 1)
    assert np.allclose(gaps.sum(axis=1), 1)
    assert held("", gaps).p > ALPHA


def test_a_sampler_with_another_law_is_found_out() -> None:
    """The obvious law, with each start uniform in the remaining length, is not this one."""
    rng = np.random.default_rng(0)
    starts = rng.random(2000)
    later = starts + (1 - starts) * rng.random(2000)
    assert held("", np.stack([starts, later - starts, 1 - later], axis=1)).p < 1e-9


@pytest.mark.parametrize("pieces", [["toilet"], ["toilet", "sink"]], ids=len)
def test_pieces_stand_anywhere_on_their_wall(builder: Builder, pieces: list[str]) -> None:
    """Pieces stand anywhere between both ends of the wall, and a size without bounds is uniform."""
    shares, widths = on_a_wall(builder, pieces, 500)
    assert held("", shares).p > ALPHA
    if len(pieces) == 1:
        shares = (widths - 2.4) / (3.7 - 2.4)
        assert held("", np.stack([shares, 1 - shares], axis=1)).p > ALPHA


def test_rooms_stand_anywhere_along_their_side(builder: Builder) -> None:
    """Whole houses: rooms stand anywhere between the ends that their doors and the corners allow."""
    sides = along_sides(builder, 6, 50)
    assert set(sides) == {1, 2, 3}
    for shares in sides.values():
        assert shares.min() > -1e-6, "the law begins where rooms end"
        assert held("", shares).p > ALPHA


def test_on_a_grid_whole_gaps_come_from_the_whole_range() -> None:
    """The law is rounded down: for one piece of 1 cell on 5, all places are equally probable."""
    seeds = np.random.default_rng(0).integers(2**63, size=2000).tolist()
    prolog.load(CHAINS)
    prolog.run("set_cell", 1.0, module="grid")
    starts = prolog.ask("starts", 1, 1, 5, seeds, module="chains")
    prolog.run("set_cell", 0.0, module="grid")
    counted = Counter(int(start) for (start,) in starts)
    assert sorted(counted) == [0, 1, 2, 3, 4]
    assert min(counted.values()) > 330


# Layouts.


def coins(folder: Path, arguments: Iterable[str] = ()) -> Program:
    file = folder / "coins.lp"
    file.write_text(COINS)
    return Program([file], {}, [("coins", [])], arguments)


def test_a_sample_s_entropy_is_that_of_its_law() -> None:
    """The entropy is corrected for the sample's size.

    With four samples per value of a uniform law, it is short by at most 1 %.
    """
    even = np.bincount(np.random.default_rng(0).integers(1000, size=4000))
    assert entropy(even) == pytest.approx(np.log(1000), rel=0.01)
    assert entropy([5, 0, 0]) == 0


def test_rejection_sampling_gives_every_layout_that_the_rules_accept_equally_often(tmp_path: Path) -> None:
    found = by_rejection(coins(tmp_path), np.random.default_rng(0), 4000)
    assert set(found) == set(every_layout(coins(tmp_path, ALL_LAYOUTS), 60) or ())
    assert found.total() == pytest.approx(4000 * 7 / 8, rel=0.03)
    assert max(found.values()) < 1.25 * min(found.values())


@pytest.mark.parametrize(("piece", "most"), [("bedroom", 2), ("hall", 2)])
def test_a_room_has_as_often_few_pieces_as_many(builder: Builder, piece: str, most: int) -> None:
    """There are far more layouts with many pieces, but sampling is uniform for each choice."""
    program = builder.programs.furniture(piece)
    layouts = [program.sample(np.random.default_rng([3, index])) or [] for index in range(300)]
    for name in {str(atom.arguments[0]) for layout in layouts for atom in layout if atom.name == "on"}:
        counts = [sum(a.name == "on" and str(a.arguments[0]) == name for a in layout) for layout in layouts]
        values, seen = np.unique(counts, return_counts=True)
        assert seen.min() > 0.4 * 300 / len(values), f"{name}: {dict(zip(values, seen, strict=True))}"
        assert max(values) <= most


# Counting.


def test_layouts_are_counted_exactly(tmp_path: Path) -> None:
    """Three coins of which not all show heads have seven layouts, whatever else the model has.

    With no time, at most one layout is counted.
    """
    made = coins(tmp_path, ALL_LAYOUTS)
    assert list(made.count([], 60)) == [(7, True)]
    assert list(made.count([], 0)) in ([(0, False)], [(1, False)])


def test_a_count_says_once_a_second_how_far_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock advances by 0.4 s with each layout."""
    monkeypatch.setattr("vitruvius.logic.layout.program.time.monotonic", iter(np.arange(0, 9, 0.4)).__next__)
    assert list(coins(tmp_path, ALL_LAYOUTS).count([], 60)) == [(3, None), (6, None), (7, True)]


def test_a_count_of_layouts_knows_the_types_and_shows_how_far_it_is(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(RequestError, match="bedrom: did you mean bedroom"):
        list(count_layouts(4, types={"bedrom": 1}))

    def counted(_: object, report: Callable[[str, int], None]) -> Iterator[tuple[str, int, bool]]:
        report("hall", 1234)
        time.sleep(0.2)  # the count is shown ten times per second
        yield "hall", 5678, True

    monkeypatch.setattr("vitruvius.logic.workers.count.counted", counted)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with pytest.raises(SystemExit, match="0"):
        main(["generate", "--rooms", "2", "--count-layouts"])
    shown = capsys.readouterr()
    assert shown.out == "hall: 5,678\n"
    assert re.search(r"hall: 1,234 layouts after \d+ s", shown.err)


def test_counts_are_those_of_brute_force(tmp_path: Path) -> None:
    """Count all ways to have rooms on four sides, and one or two crates at a wall that they cannot fill."""
    (tmp_path / "cells.lp").write_text(CELLS)
    (tmp_path / "sizes.pl").write_text(SIZES)
    houses = 0
    for sides in combinations_with_replacement(range(4), 3):
        houses += 2 ** sum({side, (side + 1) % 4} <= set(sides) for side in range(4))
    rooms = 0
    for crates in (1, 2):
        for _ in permutations(range(crates)):
            for touching in product([False, True], repeat=crates + 1):  # gaps before each crate, and the end
                rooms += not all(touching)
    assert list(count_layouts(3, grammar=tmp_path)) == [("3 rooms", houses, True), ("cell", rooms, True)]


def test_the_layouts_of_four_rooms_are_as_many_as_combinatorics_says() -> None:
    """At least one room of each basic type, at most two rooms per side, and an owner of each corner."""
    types = sum(
        {"bedroom", "bathroom", "kitchen"} <= set(row)
        for row in product(["bedroom", "bathroom", "kitchen", "hall"], repeat=4)
    )
    corners = 0
    for sides in combinations_with_replacement(range(4), 4):
        if max(Counter(sides).values()) <= 2:
            corners += 2 ** sum({side, (side + 1) % 4} <= set(sides) for side in range(4))
    assert next(count_layouts(4)) == ("4 rooms", types * corners, True)
    names = [name for name, _, _ in count_layouts(4, seconds=0.5)]
    assert names == ["4 rooms", "bathroom", "bedroom", "hall", "kitchen"]


def test_a_count_that_runs_out_of_time_says_that_there_are_more(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="4"):
        main(["generate", "--rooms", "2", "--count-layouts", "--seconds", "0.2"])
    assert ": in 0.2 s, more than " in capsys.readouterr().out


@pytest.mark.parametrize("subject", ["4 rooms", "5 rooms"])
def test_the_published_layouts_were_sampled_often_and_evenly(subject: str) -> None:
    published = json.loads((Path(__file__).parents[3] / "docs/sampling.json").read_text())["layouts"][subject]
    assert published["samples"] >= 50 * published["layouts"]
    assert published["share"] >= 0.95
