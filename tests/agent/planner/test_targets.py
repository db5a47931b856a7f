"""What a planner remembers of targets and believes of them, against the NumPy reference and the true
houses.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.agent.planner import planning, reference
from tests.agent.planner.conftest import Walk
from tests.agent.planner.reference import SIDE
from tests.agent.planner.test_occupancy import in_house


def test_a_target_is_known_where_rays_show_it_until_it_is_gone(walk: Walk) -> None:
    """Its centre by the reference; a pick-up is a target that is gone nearby, or another one elsewhere."""
    body, events = walk.body, {"seen": 0, "kept": 0, "gone": 0, "picked up": 0}
    for _, observation, _, _, before, after in walk:
        if after.time == 1:
            continue
        eye = np.array([after.x, after.y]) / 2
        known = before.target - eye if before.known else None
        centre = reference.target(body, observation, after.heading, known)
        picked_up = False
        if centre is not None:
            np.testing.assert_allclose(after.target - eye, centre, atol=2e-3)
            picked_up, now = known is not None and reference.other(centre, known), True
        else:
            now = known is not None and not reference.gone(body, observation, after.heading, known)
            picked_up = known is not None and not now and np.abs(known).max() < 5
        events["seen"] += centre is not None
        events["kept"] += now and centre is None
        events["gone"] += known is not None and not now
        events["picked up"] += picked_up
        assert after.known == now
        assert (after.kind == "target") == now
        assert after.found == before.found + picked_up
        if picked_up and known is not None:
            assert after.since == after.time
            spot = np.floor(eye + known + 0.5)
            west, east, north, south = reference.start_room(after)
            here = west < spot[0] <= east and north < spot[1] <= south
            assert after.found_here == before.found_here + here
        else:
            assert after.since == before.since or after.seen == before.seen
            assert after.found_here == before.found_here
    assert min(events.values()) > 3


def test_a_known_target_lies_where_it_truly_does(walk: Walk) -> None:
    """Where it is mostly in sight, to a few centimetres; and nearly all pick-ups are counted."""
    off, last = [], {}
    for number, (e, observation, _, _, _, after) in enumerate(walk):
        step = number // walk.envs.num_envs
        if observation[:, -1].sum() > 3:
            place = in_house(walk, e, after.target[None].astype(float))[0]
            off.append(np.abs(place - walk.targets[step][e]).max())
        last[e] = after
    assert np.quantile(off, 0.9) < 0.1
    assert max(off) < walk.envs.config.target
    found, truly = [last[e].found for e in sorted(last)], np.sum(walk.rewards, axis=0)
    assert np.sum(truly) > 10
    assert np.abs(found - truly).sum() <= 0.1 * truly.sum() + 1


@pytest.mark.parametrize(
    ("here", "found", "shares"),
    [
        (0, 0, (1, 1)),
        (0, 1, (0.25, 1)),  # 0.05 / 0.5 / 0.5 + 1 = 1.2, 0.95 / 0.5 / 0.5 + 1 = 4.8
        (1, 2, (1, 1)),
        (3, 3, (1, 1.002 / 14.718)),
        (1, 6, (1.00004 / 5.952, 1)),  # one was taken for the wrong room, or targets lie anywhere
    ],
)
def test_pick_ups_tell_where_targets_lie_by_bayes_rule(here, found, shares) -> None:
    assert reference.shares(here, found) == pytest.approx(shares, rel=1e-3)


def test_what_floor_surrounds_may_be_floor_and_what_walls_surround_is_none() -> None:
    """The reference, by hand: of a place that was never seen, inside a ring that was."""
    memory = SimpleNamespace(seen_at=np.zeros((SIDE, SIDE), int), since=5)
    memory.seen_at[4:13, 4:13], memory.seen_at[6:11, 6:11] = 3, 0
    for wall, likely in ((False, max(planning.ODDS)), (True, 0)):
        memory.occupied = (memory.seen_at > 0) & wall
        assert planning.likelihood(memory)[4, 4] == likely
    assert list(planning.ODDS) == sorted(planning.ODDS)


def test_the_start_room_is_what_was_seen_of_it_up_to_its_walls() -> None:
    """The reference, by hand: walls five cells west and nine south, a door in the south, the rest unseen."""
    memory = SimpleNamespace(occupied=np.zeros((SIDE, SIDE), bool), seen_at=np.zeros((SIDE, SIDE), int))
    rows, columns = np.arange(-6, 12) % SIDE, np.arange(-6, 8) % SIDE
    memory.seen_at[np.ix_(rows, columns)] = 9
    memory.occupied[rows, -6 % SIDE] = memory.occupied[9, columns[:8]] = True
    assert reference.start_room(memory) == (-5, 7, -6, 8)
