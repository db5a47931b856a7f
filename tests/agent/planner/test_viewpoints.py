"""Which viewpoint a planner chooses, against all viewpoints by the NumPy reference."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from agent.planner.viewpoints.belief import BLOCKED, PATH, WALL
from tests.agent.planner import planning
from tests.agent.planner.adapter import UNKNOWN, Planner
from tests.agent.planner.conftest import E, Walk, ask
from tests.agent.planner.reference import SIDE
from tests.agent.planner.test_occupancy import last


def share(walk: Walk, memory: Any, choice: planning.Choice) -> float:
    """What a chosen viewpoint is worth, as a share of the best. Where no view shows enough, the goal must
    be a nearest candidate.
    """
    if memory.look >= 0:
        return choice.worth.get((memory.goal, memory.look), 0.0) / max(choice.worth.values(), default=1.0)
    assert memory.goal in choice.nearest
    return float(not choice.worth)


def test_on_a_walk_the_viewpoint_is_mostly_the_best_of_all(walk: Walk) -> None:
    """And never far from it, as long as it keeps no gains; kept ones may mislead it, but not by much.
    Candidates that are in sight, and still were not seen, are tried: they count no more.
    """
    fresh, kept = [], []
    for e, _, _, _, before, after in walk:
        if e % 2 == 0 and after.kind == "search" and after.plan_age == 0:
            begins = after.time == 1 or before.since != after.since
            tried = before.tried & (not begins)
            choice = planning.choice(walk.body, after, tried)
            assert np.array_equal(after.tried, tried | choice.tried)
            (fresh if begins else kept).append(share(walk, after, choice))
    fresh, kept = np.array(fresh), np.array(kept)
    assert len(fresh) > 5
    assert (fresh > 1 - 1e-5).mean() > 0.9
    assert fresh.min() > 0.8
    assert len(kept) > 20
    assert kept.mean() > 0.9
    assert kept.min() > 0.5


def poses_in(memories: list[Any], random: np.random.Generator, odd: int = 0) -> list[tuple[int, int, int]]:
    """A pose that each memory's body can go to: on a node, or up to half a cell from it."""
    poses = []
    for memory in memories:
        y, x = 2 * random.choice(np.argwhere(planning.levels(memory, memory.x, memory.y) >= 0))
        dx, dy = random.integers(-odd, odd + 1, 2)
        poses.append((2 * int(x) + int(dx), 2 * int(y) + int(dy), int(random.integers(8))))
    return poses


def test_the_viewpoint_is_the_best_wherever_targets_may_be(continuous: Walk) -> None:
    """From anywhere, with any number of pick-ups in the start room and outside it: by Bayes's rule."""
    memories, random, shares = last(continuous), np.random.default_rng(0), []
    for found, here in ((0, 0), (1, 0), (1, 1), (4, 1), (4, 4), (7, 5)):
        continuous.planner.array("gains")[:], continuous.planner.array("candidates")[:] = UNKNOWN, 0
        chosen = ask(
            continuous, memories, poses_in(memories, random), found=found, found_here=here, since=100
        )
        for memory in chosen[::2]:
            if memory.kind == "search":
                choice = planning.choice(continuous.body, memory, np.zeros((128, 128), bool))
                shares.append(share(continuous, memory, choice))
    shares = np.array(shares)
    assert len(shares) >= 20
    assert (shares > 1 - 1e-5).mean() > 0.9
    assert shares.min() > 0.8


def fields(random: np.random.Generator) -> np.ndarray:
    """Priors (E, 128, 128) uint16 that change slowly, as those of houses do: rooms that sight mostly passes,
    and bands between them that it does not, some of them certain to end it.
    """
    low = random.random((E, 16, 16)).repeat(8, 1).repeat(8, 2)
    wall = np.where(low < 0.3, 100 * low, 300 * low) + random.normal(0, 20, (E, 128, 128))
    count = random.integers(0, 101, (E, 16, 16)).repeat(8, 1).repeat(8, 2)
    wall = np.rint(wall.clip(0, BLOCKED)).astype(np.uint16)
    return wall << WALL | PATH * (wall < BLOCKED).astype(np.uint16) | count.astype(np.uint16)


def test_by_a_prior_the_viewpoint_is_the_best_of_what_is_likely_to_be_seen(continuous: Walk) -> None:
    """Sight may end at each block that was never seen."""
    memories, random, shares, unsure = last(continuous), np.random.default_rng(4), [], 0
    walk = Walk(continuous.envs, Planner(continuous.envs.config, E, prior=True), continuous.inputs)
    for _ in range(4):
        for each in memories:  # half a map that was never seen
            each.seen_at[:, random.integers(SIDE) :] = 0
        walk.planner.array("prior")[:] = fields(random)
        walk.planner.array("gains")[:], walk.planner.array("candidates")[:] = UNKNOWN, 0
        for memory in ask(walk, memories, poses_in(memories, random), since=100):
            if memory.kind == "search":
                choice = planning.choice(walk.body, memory, np.zeros((128, 128), bool))
                shares.append(share(walk, memory, choice))
                passed = planning.passed(memory, *memory.goal)
                unsure += ((passed > 0.05) & (passed < 0.95)).any()
    shares = np.array(shares)
    assert len(shares) >= 20
    assert unsure > len(shares) / 2
    assert (shares > 1 - 1e-5).mean() > 0.9
    assert shares.min() > 0.8


def test_kept_gains_change_next_to_no_choice_and_spare_looks(continuous: Walk) -> None:
    """As long as nothing is new: against a planner that forgets them. Choices one after the other."""
    memories, random = last(continuous), np.random.default_rng(1)
    lazy, fresh = continuous, Walk(continuous.envs, Planner(continuous.envs.config, E), continuous.inputs)
    kept, forgotten = lazy.planner.array("gains"), fresh.planner.array("gains")
    kept[:] = UNKNOWN
    for planner in (lazy.planner, fresh.planner):
        planner.array("candidates")[:] = 0
    same, again, known, lazily, in_all = [], 0, 0, 0, 0
    for _ in range(24):
        forgotten[:] = UNKNOWN
        kept[kept < UNKNOWN] += 1  # so that a look shows: it writes what there is
        marked, poses = kept.copy(), poses_in(memories, random)
        pairs = (ask(each, memories, poses, since=200) for each in (lazy, fresh))
        same += [(one.goal, one.look) == (other.goal, other.look) for one, other in zip(*pairs, strict=True)]
        looked = kept != marked
        again, known = again + (looked & (marked < UNKNOWN)).sum(), known + (marked < UNKNOWN).sum()
        lazily, in_all = lazily + (looked & (kept < UNKNOWN)).sum(), in_all + (forgotten < UNKNOWN).sum()
    assert np.mean(same) > 0.9
    assert 100 < again < 0.2 * known
    assert lazily < 0.9 * in_all


def test_what_views_showed_is_believed_until_it_is_forgotten(continuous: Walk) -> None:
    """Where all other views are believed to show nothing, a planner turns where it stands, if that shows
    any.
    """
    memories, random, turned = last(continuous), np.random.default_rng(2), 0
    for _ in range(3):
        continuous.planner.array("gains")[:], continuous.planner.array("candidates")[:] = 0, 0
        for memory in ask(continuous, memories, poses_in(memories, random)):
            choice = planning.choice(continuous.body, memory, np.zeros((128, 128), bool))
            here = (memory.x // 2 % SIDE, memory.y // 2 % SIDE)
            if max((worth for (node, _), worth in choice.worth.items() if node == here), default=0) > 50:
                assert memory.goal == here
                turned += max(choice.worth, key=lambda view: choice.worth[view])[0] != here
    assert turned >= 2


def maze(seed: int, thick: int) -> SimpleNamespace:
    """Walls with gaps of any width, across the torus's seams, some of them only unknown; and a few
    candidates, seen before the last pick-up, or never. The start room is closed, and all pick-ups were in
    it: elsewhere no view shows enough, so that the goal is a nearest candidate.
    """
    random = np.random.default_rng(seed)
    memory = SimpleNamespace(seen_at=np.full((SIDE, SIDE), 290), near=np.ones((SIDE, SIDE), bool), x=0, y=0)
    memory.solid, memory.occupied = np.zeros((2, SIDE, SIDE), bool)
    memory.occupied[np.ix_(range(-2, 2), range(-2, 2))] = True
    for _ in range(260):
        high, wide = (thick, random.integers(2, 60))[:: random.choice([1, -1])]
        y, x = random.integers(SIDE, size=2)
        box = np.ix_(np.arange(y, y + high) % SIDE, np.arange(x, x + wide) % SIDE)
        memory.solid[box], memory.near[box] = ((True, True), (True, False), (False, False))[
            random.integers(3)
        ]
    for y, x in 2 * random.integers(SIDE // 2, size=(12, 2)):
        box = np.ix_(np.arange(y - 2, y + 2) % SIDE, np.arange(x - 2, x + 2) % SIDE)
        memory.seen_at[box], memory.near[box] = random.choice([0, 10]), True
    return memory


@pytest.mark.parametrize("thick", [1, 2, 5])
def test_in_mazes_the_goal_is_a_nearest_candidate_and_its_path_shortest(continuous: Walk, thick: int) -> None:
    """From nodes and between them, from solid ones too, over the seams of the torus; by breadth-first
    search.
    """
    memories, random, far = [maze(8 * thick + e, thick) for e in range(E)], np.random.default_rng(thick), []
    for memory in memories:
        memory.y, memory.x = 2 * random.choice(np.argwhere(planning.openings(memory)))
    for odd in (0, 1, 1):
        continuous.planner.array("gains")[:], continuous.planner.array("candidates")[:] = UNKNOWN, 0
        poses = poses_in(memories, random, odd)
        for memory, (x, y, _) in zip(memories[: E * odd // 2], poses, strict=False):
            memory.solid[y // 2 % SIDE, x // 2 % SIDE] = (
                True  # bodies may stand where their maps have no room
            )
        for e, memory in enumerate(ask(continuous, memories, poses, found=9, found_here=9)):
            again, memory.since = memory.since > 280, 280
            nearest = planning.candidates(memory)[2]
            assert again == (not nearest)  # where no candidate is left, all floor is looked at again
            if nearest:
                assert (memory.goal in nearest, memory.look) == (True, -1)
            if e % 4 == odd:
                true = planning.distances(memory, memory.distance == 0, int(memory.distance.max()) + 1)
                found = planning.away(memory.distance, memory.x, memory.y)
                assert found == planning.away(true, memory.x, memory.y)
                far.append(found or 0)
    assert max(far) > 60


def test_where_blocks_lead_a_body_can_go_and_the_path_is_about_as_long() -> None:
    """Distances by blocks of nodes are what viewpoints are compared by: of the reference, so of the
    planner.
    """
    missed, reached = 0, 0
    for seed in range(4):
        memory = maze(seed, 2)
        y, x = np.random.default_rng(seed).choice(np.argwhere(planning.openings(memory)))
        start = np.zeros((SIDE, SIDE), bool)
        start[y, x] = True
        level, way = planning.levels(memory, 2 * x, 2 * y), planning.distances(memory, start, 600)
        by_block = way.reshape(128, 2, 128, 2).swapaxes(1, 2).reshape(128, 128, 4)
        comes, nearest = by_block.max(-1) >= 0, np.where(by_block >= 0, by_block, SIDE**2).min(-1)
        assert comes[level >= 0].all()
        missed, reached = missed + (comes & (level < 0)).sum(), reached + comes.sum()
        ratio = 2 * level[level > 3] / nearest[level > 3]
        assert 0.85 < np.median(ratio) < 1.02
        assert ((ratio > 0.6) & (ratio < 1.3)).all()
    assert missed < 0.02 * reached


def test_planners_that_keep_tiles_walk_like_those_that_find_everything_again(walk: Walk) -> None:
    """Views, goals and paths: whatever is seen, closed or cleared makes tiles dirty where it matters."""
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
