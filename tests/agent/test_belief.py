# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What a map believes of places it has not looked at: against NumPy, by hand, and against the true houses."""

import numpy as np
import pytest
import torch

from agent.planner.belief import ABOUT, ODDS, SURE, Belief
from agent.planner.cells import FLAGS, NEAR, OCCUPIED, SOLID, Cells, Floats, Grid, Wholes
from agent.planner.counts import FOUND, HERE
from agent.policies import Explorer
from agent.world import make_worlds, shield
from sim.runtime import Array, Launch, start, ti
from tests.worlds import random_house

BITS = 5
SIDE = 1 << BITS


def asked(cells: np.ndarray, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The kernel's odds of nodes (n, 2) of one grid (SIDE, SIDE), whether each is at home, and the home."""
    start()
    belief = Belief(Grid(BITS))

    @ti.kernel
    def ask(grid: Cells, places: Wholes, odds: Wholes, within: Wholes, home: Wholes):
        for _ in range(1):
            box = belief.home(grid, 0)
            for k in ti.static(range(4)):
                home[k] = box[k]
            for k in range(odds.shape[0]):
                odds[k] = belief.odds(grid, 0, places[2 * k], places[2 * k + 1])
                within[k] = belief.within(box, places[2 * k], places[2 * k + 1])

    arrays = {
        "grid": Array.of(cells.astype(np.uint16).ravel()),
        "places": Array.of(nodes.astype(np.int32).ravel()),
        "odds": Array(ti.i32, len(nodes)),
        "within": Array(ti.i32, len(nodes)),
        "home": Array(ti.i32, 4),
    }
    Launch(ask, arrays)()
    return arrays["odds"].numpy(), arrays["within"].numpy(), arrays["home"].numpy()


def odds_of(cells: np.ndarray, x: int, y: int) -> int:
    """The same in NumPy: walls and floor first met in the eight directions from the corner of four cells."""
    if cells[y, x] >> FLAGS:
        return SURE
    met = 0
    for dx, dy in [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]:
        along = [
            cells[(y + t * dy - (dy < 0)) % SIDE, (x + t * dx - (dx < 0)) % SIDE] for t in range(1, ABOUT + 1)
        ]
        known = next((cell for cell in along if cell >> FLAGS), 0)
        met += 0 if not known >> FLAGS else -1 if known & OCCUPIED else 1
    return ODDS[met + 8]


def test_odds_are_those_of_an_independent_count():
    chance = np.random.default_rng(0)
    for floor in (0.02, 0.1, 0.3):
        cells = np.where(chance.random((SIDE, SIDE)) < floor, 5 << FLAGS, 0)
        cells[chance.random((SIDE, SIDE)) < 0.05] = OCCUPIED | 7 << FLAGS
        # What a cell tells of the node in its corner is neither floor nor wall.
        cells |= chance.choice([0, SOLID, NEAR, SOLID | NEAR], (SIDE, SIDE))
        nodes = chance.integers(0, SIDE, (200, 2))
        assert asked(cells, nodes)[0].tolist() == [odds_of(cells, x, y) for x, y in nodes]


def test_what_floor_surrounds_may_be_floor_and_what_walls_surround_is_none():
    ring = np.zeros((SIDE, SIDE), int)
    ring[4:13, 4:13] = 3 << FLAGS
    ring[6:11, 6:11] = 0
    walled = np.where(ring, ring | OCCUPIED, 0)
    middle = np.array([[8, 8]])
    assert asked(ring, middle)[0] == [ODDS[16]]
    assert asked(walled, middle)[0] == [0]
    assert list(ODDS) == sorted(ODDS)
    assert max(ODDS) <= SURE


def test_home_is_the_room_of_the_start_as_far_as_it_was_seen():
    """Walls five cells west and nine south of the start, an open door in the south, the rest not seen."""
    cells = np.zeros((SIDE, SIDE), int)
    for y in range(-6, 12):
        for x in range(-6, 8):
            cells[y % SIDE, x % SIDE] = 9 << FLAGS
    cells[:, -6] |= OCCUPIED * (cells[:, -6] > 0)
    cells[9, [x % SIDE for x in range(-6, 2)]] |= OCCUPIED
    nodes = np.array([[0, 0], [-5, 0], [-6, 0], [7, 8], [7, 9], [7, 10], [8, 0]])
    _, within, home = asked(cells, nodes % SIDE)
    assert home.tolist() == [-5, 7, -6, 8]
    assert within.tolist() == [1, 0, 0, 1, 0, 0, 0]


@pytest.mark.parametrize(
    ("here", "found", "shares"),
    [
        (0, 0, (1, 1)),
        (0, 1, (0.25, 1)),  # 0.05 / 0.5 / 0.5 + 1 = 1.2, 0.95 / 0.5 / 0.5 + 1 = 4.8
        (1, 2, (1, 1)),
        (3, 3, (1, 1.002 / 14.718)),
        (1, 6, (1.00004 / 5.952, 1)),  # one in another space than it seemed, or else five by chance
    ],
)
def test_pick_ups_tell_where_targets_lie_by_bayes(here, found, shares):
    start()
    belief = Belief(Grid(BITS))

    @ti.kernel
    def ask(counts: Wholes, answer: Floats):
        for _ in range(1):
            both = belief.shares(counts[0], counts[1])
            answer[0], answer[1] = both[0], both[1]

    arrays = {"counts": Array.of(np.array([here, found], np.int32)), "answer": Array(ti.f32, 2)}
    Launch(ask, arrays)()
    assert arrays["answer"].numpy().tolist() == pytest.approx(shares, rel=1e-3)


def test_a_map_knows_which_pick_ups_were_in_the_room_of_the_start():
    torch.set_num_threads(1)
    houses = [random_house(seed) for seed in range(6)]
    worlds = make_worlds(houses, 6, "mixed")
    explorer = Explorer(shield(worlds), worlds.config)
    observation, info = worlds.reset(seed=0, options={"house": np.arange(6)})
    explorer.begin(6)
    boxes = np.array([house.floor.box for house in houses])
    seen, blocked, target = torch.as_tensor(observation), torch.zeros(6).bool(), info["target"]
    here = np.zeros(6, int)
    for _ in range(1499):
        observation, reward, _, _, info = worlds.step(explorer(seen, blocked).numpy())
        inside = ((target > boxes[:, :2]) & (target < boxes[:, 2:])).all(-1)
        here += (reward > 0) & inside
        seen, blocked, target = torch.as_tensor(observation), torch.as_tensor(info["blocked"]), info["target"]
    counts = explorer.tracker.planner._counts.numpy()
    assert here.sum() > 10
    assert (counts[:, FOUND] - here).sum() > 10
    assert np.abs(counts[:, HERE] - here).sum() <= 0.1 * here.sum()
