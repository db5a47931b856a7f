"""The planner's memory of targets and its beliefs about them, against the true houses and by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.agent.planner.adapter import SIDE, Planner
from tests.agent.planner.brute_force import BEFORE
from tests.agent.planner.conftest import E, Walk, ask
from tests.agent.planner.test_occupancy import in_house
from vitruvius.agent.planner.belief_map import BeliefMap
from vitruvius.agent.planner.core.config import TUNED


def test_a_known_target_lies_where_it_truly_does(walk: Walk) -> None:
    """A target is known as soon as rays hit it.

    If most of it is in sight, its place is known to a few centimetres. Hardly any target is still known after
    its pick-up, and nearly all pick-ups are counted.
    """
    off, kept, last = [], [], {}
    for number, (e, observation, _, _, before, after) in enumerate(walk):
        place = in_house(walk, e, after.target[None].astype(float))[0]
        error = np.abs(place - walk.targets[number // walk.envs.num_envs][e]).max()
        met = observation[:, -1].sum()
        assert after.known >= (met > 0)
        assert (after.kind == "target") == after.known
        if met > 3:
            off.append(error)
        elif after.known and not met:
            kept.append(error)
        if after.time > 1 and after.found > before.found:
            assert before.known
            assert after.since == after.time
        last[e] = after
    assert np.quantile(off, 0.9) < 0.1
    assert max(off) < walk.envs.config.target
    assert len(kept) > 10
    assert np.mean(np.array(kept) < walk.envs.config.target) > 0.9
    found, truly = [last[e].found for e in sorted(last)], np.sum(walk.rewards, axis=0)
    assert np.sum(truly) > 10
    assert np.abs(found - truly).sum() <= 0.1 * truly.sum() + 1


def believed(planner: Planner, memory: SimpleNamespace, **numbers: Any) -> np.ndarray:
    """Return the weights of candidate blocks by a memory, from 20 nodes west and north of the start on."""
    memory.near, memory.solid = np.ones((SIDE, SIDE), bool), np.zeros((SIDE, SIDE), bool)
    ask(planner, [memory] * E, [(120, 120, 0)] * E, **numbers)  # it looks away from the start
    return BeliefMap(planner.tested).read()[54:74, 54:74].astype(int)


@pytest.mark.parametrize(("wall", "count"), [(False, max(TUNED.floor_odds)), (True, 0)])
def test_what_floor_surrounds_may_be_floor_and_what_walls_surround_is_none(planner, wall, count) -> None:
    """Return the memory of a place that was never seen, inside a ring that was."""
    memory = SimpleNamespace(seen_at=np.zeros((SIDE, SIDE), int))
    memory.seen_at[4:13, 4:13], memory.seen_at[6:11, 6:11] = 290, 0
    memory.occupied = (memory.seen_at > 0) & wall
    assert believed(planner, memory)[14, 14] == count


@pytest.mark.parametrize(
    ("here", "found", "shares"),
    [
        (0, 0, (1, 1)),
        (0, 1, (0.25, 1)),  # 0.05 / 0.5 / 0.5 + 1 = 1.2, 0.95 / 0.5 / 0.5 + 1 = 4.8
        (1, 2, (1, 1)),
        (3, 3, (1, 1.002 / 14.718)),
        (1, 6, (1.00004 / 5.952, 1)),  # one was assigned to the wrong room, or targets lie anywhere
    ],
)
def test_pick_ups_tell_by_bayes_rule_if_targets_lie_in_the_start_room(planner, here, found, shares) -> None:
    """In a room of walls five cells west, north and east of the start, and nine south."""
    memory = SimpleNamespace(seen_at=np.full((SIDE, SIDE), BEFORE), occupied=np.zeros((SIDE, SIDE), bool))
    memory.occupied[:, [-6, 5]] = memory.occupied[[-6, 9], :] = True
    counts = believed(planner, memory, found=found, found_here=here)
    inside = np.zeros_like(counts, bool)
    inside[9:14, 9:12] = True  # nodes -2 to 6 south, -2 to 2 east, about which no wall is
    outside = np.zeros_like(inside)
    outside[:6, :6] = outside[16:, 14:] = True
    assert set(counts[inside]) == {int(np.ceil(100 * shares[0] - 1e-3))}
    assert set(counts[outside]) == {int(np.ceil(100 * shares[1] - 1e-3))}
