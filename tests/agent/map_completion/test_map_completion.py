"""Map completion: what it reads of maps and houses, what it writes, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from agent.build import network_of, policy_of
from agent.map_completion.config import CompletionConfig
from agent.map_completion.foresight import Foresight
from agent.map_completion.learner import completion_loss, turned
from agent.map_completion.network import WINDOW, CompletionNetwork, Prediction
from agent.map_completion.truth import FLOOR, TARGET, UNKNOWN, Truth
from agent.map_completion.windows import PATH, Windows
from agent.planner.belief import OPAQUE
from agent.planner.config import CERTAIN
from agent.planner.occupancy import FLAGS, NEAR, OCCUPIED
from agent.policies import Explorer, Tracker
from agent.world import make_envs, shield
from logic import generate
from logic.errors import RequestError
from sim.config import PAPER

HOUSES = list(generate(4, seed=31, count=4))
EVERYONE = np.arange(len(HOUSES))
STEPS = 60


@pytest.fixture(scope="module")
def explored():
    """Explorers after some steps, one in each house, and the truth of their maps."""
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy, truth = Explorer(shield(envs), envs.config), Truth(envs, ("bedroom", "kitchen"))
    policy.begin(len(HOUSES))
    observation = torch.as_tensor(envs.reset(seed=3, options={"house": EVERYONE})[0])
    blocked = torch.zeros(len(HOUSES), dtype=torch.bool)
    for _ in range(STEPS):
        actions = policy(observation, blocked)
        truth.begin(np.flatnonzero(policy.tracker.planner.read("time").numpy() == 1))
        observation, _, _, _, info = envs.step_torch(actions)
        blocked = info["blocked"]
    # The maps are of a step before: look once more.
    policy(observation, blocked)
    return envs, policy.tracker.planner, truth


def middle(planner, e):
    """The node that the body is on, or next to, in whole blocks: south and east of the start."""
    x, y, _ = planner.pose(e)
    return np.floor((np.array([y, x]) + 1) / 2).astype(int)


def test_windows_hold_the_four_cells_about_each_other_node(explored):
    _, planner, _ = explored
    windows, corners = Windows(planner).read(EVERYONE)
    for e in EVERYONE:
        assert np.array_equal(corners[e], middle(planner, e) - WINDOW // 2)
        cells = planner.arrays["cells"].numpy().reshape(-1, 256, 256)[e]
        for i, j in np.random.default_rng(e).integers(0, WINDOW, size=(400, 2)):
            y, x = 2 * (corners[e] + (i, j))
            four = [int(cells[(y + a) % 256, (x + b) % 256]) for a in (-1, 0) for b in (-1, 0)]
            occupied = sum(cell >= OCCUPIED for cell in four)
            seen = sum((cell & OCCUPIED - 1) >> FLAGS > 0 for cell in four)
            assert windows[e, i, j] == occupied + 8 * seen
        assert (windows[e] >> 3).any()
        assert (windows[e] & 7).any()


def test_the_truth_is_where_targets_may_lie_in_the_house(explored):
    """By another way: each place of the house, turned into the map's frame."""
    envs, planner, truth = explored
    windows, corners = Windows(planner).read(EVERYONE)
    bits, rooms = truth.read(planner, EVERYONE, corners)
    world = envs.unwrapped.world
    for e in EVERYONE:
        x, y, heading = truth.pose[e]
        along = np.exp(-1j * (np.pi / 2) * (round(heading / (np.pi / 4)) // 2))  # y grows south
        places = world.places[e].targets * world.config.step + world.lattices[e].origin
        ways = (places[:, 0] - x + 1j * (places[:, 1] - y)) / along / (2 * planner.cell)
        south, east = ways.imag - corners[e, 0], ways.real - corners[e, 1]
        # Places that lie on a block's node, up to half of the lattice's pitch.
        near = np.abs(south - np.rint(south)) + np.abs(east - np.rint(east)) < 1e-3
        inside = (south > 0) & (south < WINDOW - 1) & (east > 0) & (east < WINDOW - 1) & near
        i, j = np.rint(south[inside]).astype(int), np.rint(east[inside]).astype(int)
        assert len(i) > 20
        assert ((bits[e, i, j] & TARGET) > 0).all()
        assert (bits[e] & TARGET > 0).sum() == len(i)
    assert ((bits & TARGET > 0) <= (bits & FLOOR > 0)).all()
    assert not (bits[(windows & 7) == 4] & FLOOR).any()  # nothing lies in what is occupied
    assert set(np.unique(rooms)) == {0, 1, UNKNOWN}


def test_what_is_written_is_what_places_count_and_where_paths_lead():
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    tracker = Tracker(envs.config, prior=True)
    tracker.begin(len(HOUSES))
    observation, _ = envs.reset(seed=0, options={"house": EVERYONE})
    planner = tracker.look(torch.as_tensor(observation), torch.zeros(len(HOUSES), dtype=torch.bool))
    windows, near = Windows(planner), planner.arrays["cells"].numpy() & NEAR
    given = np.zeros((1, WINDOW, WINDOW), np.uint8)
    given[0, 2, 3], given[0, 3, 5], given[0, 5, 5] = 70 | PATH, 30, OPAQUE
    windows.write(np.array([2]), given)
    counts, open_ = planner.foreseen(2)
    corner = middle(planner, 2) - WINDOW // 2 + len(counts) // 2
    here, there, wall = (tuple(np.add(corner, place)) for place in ((2, 3), (3, 5), (5, 5)))
    assert [counts[here], counts[there], counts[wall]] == [70, 30, 0]
    assert [open_[here], open_[there], open_[wall]] == [True, True, False]
    assert (~open_).sum() == 1
    assert counts.sum() == 100
    assert not planner.foreseen(1)[0].any()
    assert planner.foreseen(1)[1].all()
    added = (planner.arrays["cells"].numpy() & NEAR) & ~near
    assert 0 < added.astype(bool).sum() <= 4  # the four cells of the block that paths lead to


def test_turned_houses_keep_their_starts():
    random = np.random.default_rng(0)
    windows = torch.zeros(3, WINDOW, WINDOW, dtype=torch.uint8)
    starts = torch.tensor([[5.0, 70.0], [40.0, 41.0], [90.0, 3.0]])
    for n, (i, j) in enumerate(starts.int().tolist()):
        windows[n, i, j] = n + 1
    kinds = set()
    for _ in range(40):
        seen, places, bits, rooms = turned(windows, starts, windows + 1, windows + 2, random)
        assert [int(seen[n, int(i), int(j)]) for n, (i, j) in enumerate(places)] == [1, 2, 3]
        assert torch.equal(bits, seen + 1)
        assert torch.equal(rooms, seen + 2)
        kinds.add(tuple(places[0].tolist()))
    assert len(kinds) == 8


def test_the_loss_is_of_what_was_not_seen_and_falls_with_the_truth():
    windows, bits = torch.zeros(2, 1, 32, 32, dtype=torch.uint8)
    windows[0, :, :10], bits[0, 5:20] = 8 * 4, FLOOR | TARGET
    rooms = torch.full_like(bits, UNKNOWN)
    rooms[0, 5:20] = 1
    floor = torch.where(bits > 0, 9.0, -9.0)
    kinds = torch.stack([torch.full_like(floor, -9.0), torch.full_like(floor, 9.0)], 1)
    right = completion_loss(Prediction(floor, floor, kinds), windows, bits, rooms)
    assert right < 0.01
    # Farther than 12 blocks from what was seen it hardly matters.
    far = floor.clone()
    far[0, :, 30:] = 9.0
    wrong = floor.clone()
    wrong[0, :, 12:14] = 9.0
    losses = [
        float(completion_loss(Prediction(each, floor, kinds), windows, bits, rooms)) for each in (far, wrong)
    ]
    assert right < losses[0] < losses[1] / 5
    other = completion_loss(Prediction(floor, floor, -kinds), windows, bits, rooms)
    assert other > right + 1


class Seer(Foresight):
    """Foresight that is told the truth, or that of another house."""

    def __init__(self, envs, shuffled):
        self.truth = Truth(envs, ())
        self.shuffled = shuffled
        super().__init__(envs.config, CompletionNetwork(0, (4, 4)))

    def foresee(self, environments):
        """Write the truth."""
        self.truth.begin(np.flatnonzero(self.planner.read("time").numpy() == 1))
        self.asked = environments
        super().foresee(environments)

    def predict(self, windows, starts):
        """Logits that are sure."""
        bits, _ = self.truth.read(self.planner, self.asked, -starts.astype(int))
        bits = np.roll(bits, 1, axis=0) if self.shuffled else bits
        floor, target = (torch.from_numpy(np.where(bits & bit, 9.0, -9.0)).float() for bit in (FLOOR, TARGET))
        return Prediction(floor, target, torch.zeros(len(bits), 0, WINDOW, WINDOW))


def picked_up(tracker_of, houses, steps=350):
    """Targets in an episode of each house."""
    envs = make_envs(houses, len(houses), "secondary")
    policy = Explorer(shield(envs), envs.config, tracker=tracker_of(envs))
    policy.begin(len(houses))
    observation = torch.as_tensor(envs.reset(seed=0, options={"house": np.arange(len(houses))})[0])
    blocked, found = torch.zeros(len(houses), dtype=torch.bool), 0.0
    for _ in range(steps):
        observation, reward, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked, found = info["blocked"], found + float(reward.sum())
    return found


def test_who_foresees_the_truth_finds_more_and_another_house_less():
    houses = list(generate(5, seed=77, count=24))
    told = picked_up(lambda envs: Seer(envs, shuffled=False), houses)
    misled = picked_up(lambda envs: Seer(envs, shuffled=True), houses)
    explorer = picked_up(lambda envs: None, houses)
    assert told > 1.05 * explorer
    assert misled < 0.95 * explorer


def test_nothing_counts_more_than_certain_and_what_was_seen_stays_open():
    foresight = Foresight(make_envs(HOUSES, 1).config, CompletionNetwork(1, (4, 4)))
    windows = np.zeros((1, WINDOW, WINDOW), np.uint8)
    windows[0, 0, 0] = 8 * 4
    sure = torch.full((1, WINDOW, WINDOW), 30.0)
    given = foresight.given(Prediction(sure, sure, sure[:, None]), windows)
    assert (given == CERTAIN | PATH).all()
    none = foresight.given(Prediction(-sure, -sure, sure[:, None]), windows)
    assert none[0, 0, 0] == PATH  # it was seen: a path may lead there, and a view go on
    assert (none[0, 1:] == OPAQUE).all()


@pytest.mark.parametrize(
    ("targets", "preset", "message"),
    [
        ("main", "default", "does not know those of"),
        ("secondary", replace(PAPER, body=(0.4, 0.4)), "cannot read those of one of 0.400 m"),
    ],
)
def test_another_task_or_another_body_is_refused(targets, preset, message):
    config = CompletionConfig(targets="secondary", rooms=("bedroom",), channels=(4, 4))
    envs = make_envs(HOUSES, 1, targets, preset=preset)
    with pytest.raises(RequestError, match=message):
        policy_of(network_of(config), config, envs)


@pytest.mark.parametrize(
    "changes",
    [{"channels": (4,)}, {"channels": (0, 4)}, {"restarts": 1.5}, {"device": "cuda"}, {"batch_size": 0}],
)
def test_a_config_that_no_run_can_have_is_refused(changes):
    with pytest.raises(RequestError):
        CompletionConfig(**changes)
