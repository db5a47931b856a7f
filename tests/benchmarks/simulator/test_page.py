"""The page of the simulator's study has its figures, their ratio to C, and those of other simulators."""

import numpy as np
import pytest

from benchmarks.simulator.page import simulator_page
from benchmarks.simulator.peers.house import BOXES, HALF, WALLS
from benchmarks.simulator.peers.ours import peers_house
from tests.benchmarks.reports import simulator_report

pytestmark = pytest.mark.second_part("each study is run in small")


def test_the_simulators_page_has_its_figures_and_the_ratio_to_c() -> None:
    page = simulator_page(simulator_report(), None)
    assert (
        "| 4,096 | 4.00 M [4.00 M, 4.00 M] | 3.00 M [3.00 M, 3.00 M] | 4.00 M [4.00 M, 4.00 M] | 0.75 |"
        in page
    )
    assert "| houses | 2 (2 MiB on the device) | 5.00 M [5.00 M, 5.00 M] |" in page
    for words in (
        "| a launch | 0.020 |",
        "| goal | 1.25 [1.00, 1.50] |",
        "| grid | 1.0 |",
        "| compiled | 0.50 | 1.25 |",
        "clang 1",
        "40 rays against 10 lines",
        "the kernel makes 1.50 of the steps of C",
        "| C on one core | 2.00 M",
        "| quadrants | 2.00 M [1.00 M, 3.00 M] | 4.0 | yes |",
        "| another | 2.00 M [1.00 M, 3.00 M] | 4.0 | no |",
    ):
        assert words in page
    assert "were not measured" in page


def test_of_a_peer_the_page_has_its_best_rate_or_why_it_failed() -> None:
    row = {"peer": "P", "version": "1", "what": "a step", "note": "no rays", "low": 90.0, "high": 110.0}
    rows = [row | {"environments": n, "steps_per_second": rate} for n, rate in ((1, 50.0), (16, 100.0))]
    page = simulator_page(simulator_report(), {"rows": rows, "failures": [{"peer": "Q", "why": "no wheel"}]})
    assert "| P 1 | a step | 16 | 100 [90, 110] | no rays |" in page
    assert "Q could not be measured: no wheel" in page


def test_ours_among_the_peers_is_their_house_and_comes_first() -> None:
    house = peers_house()
    uprights, levels = house.walls
    walls = {*(((x, low), (x, high)) for x, low, high in uprights)}
    walls |= {*(((low, y), (high, y)) for y, low, high in levels)}
    assert walls == {tuple((x + HALF, y + HALF) for x, y in wall) for wall in WALLS}
    pieces = [(room.x + piece.x, room.y + piece.y, piece) for room in house.rooms for piece in room.pieces]
    boxes = {(x + piece.width / 2, y + piece.height / 2, piece.width, piece.height) for x, y, piece in pieces}
    middles = {(x + HALF, y + HALF, *sides) for (x, y), sides in BOXES}
    assert np.allclose(sorted(boxes), sorted(middles))
    row = {"peer": "P", "version": "1", "what": "a step", "note": "no rays", "low": 90.0, "high": 110.0}
    rows = [row | {"environments": 1, "steps_per_second": 100.0}]
    page = simulator_page(simulator_report(), {"rows": rows, "failures": []})
    ours = page.index("| **this one**, backend `free` | four rooms, 58 segments")
    assert ours < page.index("| P 1 |")
    assert "| 4,096 | 3.00 M [3.00 M, 3.00 M] | A round robot" in page
