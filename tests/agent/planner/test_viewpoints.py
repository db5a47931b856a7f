"""The planner's choice of a viewpoint, against an exhaustive search of small maps."""

from typing import Any

import numpy as np

from tests.agent.planner.adapter import UNKNOWN, Planner
from tests.agent.planner.brute_force import ACROSS, BEFORE, SINCE, candidates, levels, small_map, views
from tests.agent.planner.conftest import E, Walk, ask
from tests.agent.planner.test_occupancy import last
from vitruvius.agent.planner.viewpoints.belief import BLOCKED, PATH, WALL
from vitruvius.sim import DEFAULT


def hiding(random: np.random.Generator, places: int) -> tuple[list[Any], list[tuple[int, int, int]]]:
    """Return small maps of blocks with possible places of targets, and a pose in each.

    From the pose some other block can be reached.
    """
    memories, poses = [], []
    while len(memories) < E:
        memory = small_map(random, solid=0.25, unit=2)
        nodes = sorted(memory.nodes)
        for _ in range(places):
            x, y = (2 * (at // 2) for at in nodes[random.integers(len(nodes))])
            memory.seen_at[y - 2 : y + 2, x - 2 : x + 2] = BEFORE
        x, y = (2 * (at // 2) for at in nodes[random.integers(len(nodes))])
        memory.x, memory.y = 2 * x, 2 * y
        if len(levels(memory)) > 20:
            memories.append(memory)
            poses.append((memory.x, memory.y, int(random.integers(8))))
    return memories, poses


def searched(planner: Planner, places: int, random: np.random.Generator, **numbers: Any) -> list[Any]:
    """Return the memories of planners that have found a goal on such maps."""
    memories, poses = hiding(random, places)
    found = ask(planner, memories, poses, **numbers)
    for memory, after in zip(memories, found, strict=True):
        after.nodes = memory.nodes
    return [after for after in found if after.kind == "search" and after.since == SINCE]


def test_where_no_view_shows_enough_the_goal_is_a_nearest_candidate(planner: Planner) -> None:
    """All nine pick-ups were in the start room, so that each candidate elsewhere counts a hundredth."""
    random, far = np.random.default_rng(0), []
    for _ in range(8):
        for memory in searched(planner, 2, random, found=9, found_here=9):
            level = levels(memory)
            places = candidates(memory, level)
            least = min(level[place] for place in places)
            assert memory.look == -1
            assert memory.goal in {(2 * x, 2 * y) for x, y in places if level[x, y] == least}
            far.append(least)
    assert len(far) > 30
    assert max(far) > 5


def worths(memories: list[Any]) -> np.ndarray:
    """Return the values of the chosen viewpoints, as shares of the best value.

    The share is 1, too, if no viewpoint has a value and none was chosen.
    """
    found = []
    for memory in memories:
        worth = views(memory, levels(memory))
        assert (memory.look >= 0) == bool(worth)
        found.append(worth.get((memory.goal, memory.look), 0) / max(worth.values()) if worth else 1)
    return np.array(found)


def test_a_viewpoint_has_the_most_information_gain_for_its_cost(planner: Planner) -> None:
    """But for a few between viewpoints that promised less."""
    random = np.random.default_rng(1)
    found = worths([memory for _ in range(5) for memory in searched(planner, 8, random)])
    assert len(found) > 30
    assert (found > 1 - 1e-5).mean() > 0.9
    assert found.min() > 0.8


def test_by_a_prior_a_viewpoint_shows_most_of_what_is_likely_to_be_seen() -> None:
    """Places have the prior's weights, and sight may end at each block that was never seen."""
    random, planner, found = np.random.default_rng(2), Planner(DEFAULT, E, prior=True), []
    for _ in range(5):
        memories, poses = hiding(random, 8)
        for memory in memories:
            memory.seen_at[:, : min(memory.nodes)[0] + ACROSS] = 0
        wide, count = (random.integers(0, most, (E, 32, 32)).repeat(4, 1).repeat(4, 2) for most in (300, 101))
        wall = np.maximum(wide, 45) - 45  # sight passes some places surely, and others never
        planner.array("prior")[:] = wall << WALL | PATH * (wall < BLOCKED) | count
        after = ask(planner, memories, poses)
        for memory, each in zip(memories, after, strict=True):
            each.nodes = memory.nodes
        found += [each for each in after if each.kind == "search" and each.since == SINCE]
    found = worths(found)
    assert len(found) > 30
    assert (found > 1 - 1e-5).mean() > 0.9
    assert found.min() > 0.7


def poses_in(memories: list[Any], random: np.random.Generator) -> list[tuple[int, int, int]]:
    """Return a pose of each memory's body at a node to which its last path leads."""
    nodes = [2 * random.choice(np.argwhere(memory.distance >= 0)) for memory in memories]
    return [(int(x), int(y), int(random.integers(8))) for y, x in nodes]


def test_kept_gains_change_next_to_no_choice_and_spare_looks(continuous: Walk) -> None:
    """While nothing is new, choices are compared with those of a planner without kept gains."""
    memories, random = last(continuous), np.random.default_rng(1)
    lazy, fresh = continuous.planner, Planner(continuous.envs.config, E)
    kept, forgotten = lazy.array("gains"), fresh.array("gains")
    kept[:] = UNKNOWN
    for planner in (lazy, fresh):
        planner.array("candidates")[:] = 0
    same, again, known, lazily, in_all = [], 0, 0, 0, 0
    for _ in range(24):
        forgotten[:] = UNKNOWN
        kept[kept < UNKNOWN] += 1  # so that a look shows: it writes the true gain
        marked, poses = kept.copy(), poses_in(memories, random)
        pairs = (ask(each, memories, poses, keep=True, since=200) for each in (lazy, fresh))
        same += [(one.goal, one.look) == (other.goal, other.look) for one, other in zip(*pairs, strict=True)]
        looked = kept != marked
        again, known = again + (looked & (marked < UNKNOWN)).sum(), known + (marked < UNKNOWN).sum()
        lazily, in_all = lazily + (looked & (kept < UNKNOWN)).sum(), in_all + (forgotten < UNKNOWN).sum()
    assert np.mean(same) > 0.9
    assert 100 < again < 0.2 * known
    assert lazily < 0.9 * in_all


def test_planners_that_keep_tiles_walk_like_those_that_find_everything_again(walk: Walk) -> None:
    """Seen, closed and cleared cells make the relevant tiles dirty."""
    other, chosen = Planner(walk.envs.config, E), 0
    for inputs in walk.inputs:
        other.forget_tiles()
        other.step(*inputs)
        walk.planner.step(*inputs)
        for name in ("states", "gains", "distance", "advice"):
            assert np.array_equal(walk.planner.array(name), other.array(name))
        chosen += sum(walk.planner.memory(e).plan_age == 0 for e in range(E))
    assert chosen > 20
    odds = walk.planner.array("odds")
    assert (odds < 255).sum() > 100 * E
