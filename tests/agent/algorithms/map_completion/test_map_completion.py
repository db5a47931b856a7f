"""Map completion: its inputs from maps and houses, its outputs, and the arguments that it refuses."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from benchmarks.planner.contenders import with_shuffled_predictions
from benchmarks.planner.truth import truth
from tests.sample_houses import FOUR_ROOMS
from vitruvius.agent.algorithms.build import network_of, policy_of
from vitruvius.agent.algorithms.map_completion.config import CompletionConfig
from vitruvius.agent.algorithms.map_completion.foresight import (
    MAX_STEPS_BETWEEN,
    MIN_NEW_CELLS,
    MIN_STEPS_BETWEEN,
    STEP_INTERVAL,
    Foresight,
)
from vitruvius.agent.algorithms.map_completion.learner import TARGETS, WindowBatch, completion_loss, turned
from vitruvius.agent.algorithms.map_completion.marks import Marks
from vitruvius.agent.algorithms.map_completion.network import WINDOW, CompletionNetwork, Prediction
from vitruvius.agent.algorithms.map_completion.sight import RANGE, RAYS, cast_rays
from vitruvius.agent.algorithms.map_completion.truth import GROUND, UNKNOWN, Truth
from vitruvius.agent.algorithms.map_completion.windows import LOOKED, SEEN, Windows
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.planner.core.state import AT, NONE, SIZE, TARGET
from vitruvius.agent.planner.mapping.occupancy import FLAGS, NEAR, OCCUPIED
from vitruvius.agent.planner.viewpoints.belief import BLOCKED, COUNT, PATH, WALL
from vitruvius.agent.policies.policies import Explorer, Tracker
from vitruvius.logic import generate
from vitruvius.logic.errors import RequestError
from vitruvius.sim.config import DEFAULT, PAPER

HOUSES = FOUR_ROOMS
EVERYONE = np.arange(len(HOUSES))
STEPS = 400
KINDS = "bed", "chair"


@pytest.fixture(scope="module")
def explored():
    """Return explorers after some steps, one in each house, with the truth of their maps and their marks."""
    config = replace(DEFAULT, kinds=KINDS)
    envs = make_envs(HOUSES, len(HOUSES), "secondary", preset=config)
    policy = Explorer(shield(envs), envs.config)
    policy.begin(len(HOUSES))
    planner = policy.tracker.planner
    truth, marks = Truth(envs, ("bedroom", "kitchen", "bed"), planner.cell), Marks(envs.config, planner)
    observation = torch.as_tensor(envs.reset(seed=3, options={"house": EVERYONE})[0])
    blocked = torch.zeros(len(HOUSES), dtype=torch.bool)
    for _ in range(STEPS):
        actions = policy(observation, blocked)
        marks.note(observation)
        truth.begin(np.flatnonzero(planner.read("time").numpy() == 1))
        observation, _, _, _, info = envs.step_torch(actions)
        blocked = info["blocked"]
    # The maps are of a step before: look once more.
    policy(observation, blocked)
    marks.note(observation)
    return envs, planner, truth, marks


def middle(planner, e):
    """Return the block of the body's node, or next to it: blocks south and east of the start."""
    x, y, _ = planner.pose(e)
    return np.floor((np.array([y, x]) + 1) / 2).astype(int)


@pytest.mark.second_part("large maps")
def test_windows_hold_the_four_cells_about_each_other_node(explored):
    _, planner, _, _ = explored
    windows, corners = Windows(planner).read(EVERYONE)
    for e in EVERYONE:
        assert np.array_equal(corners[e], middle(planner, e) - WINDOW // 2)
        cells = planner.arrays["cells"].numpy().reshape(-1, 256, 256)[e]
        for i, j in np.random.default_rng(e).integers(0, WINDOW, size=(400, 2)):
            y, x = 2 * (corners[e] + (i, j))
            four = [int(cells[(y + a) % 256, (x + b) % 256]) for a in (-1, 0) for b in (-1, 0)]
            occupied = sum(cell >= OCCUPIED for cell in four)
            times = [(cell & OCCUPIED - 1) >> FLAGS for cell in four]
            seen = sum(time > 0 for time in times)
            looked = sum(time >= max(1, int(planner.read("since")[e])) for time in times) >= SEEN
            assert windows[e, i, j] == occupied + 8 * seen + LOOKED * looked
        assert (windows[e] >> 3 & 7).any()
        assert (windows[e] & LOOKED).any()
        assert (windows[e] & 7).any()


def on_map(truth, e, metres, planner, corner):
    """Return points of a house (n, 2) as blocks of a window, south and east, by complex numbers."""
    x, y, heading = truth.pose[e]
    along = np.exp(-1j * (np.pi / 2) * (round(heading / (np.pi / 4)) // 2))  # y grows south
    ways = (metres[:, 0] - x + 1j * (metres[:, 1] - y)) / along / (2 * planner.cell)
    return np.stack([ways.imag - corner[0], ways.real - corner[1]])


def test_the_truth_is_where_targets_may_lie_in_the_house(explored):
    """Checked in another way: each place of the house is turned into the map's frame."""
    envs, planner, truth, _ = explored
    windows, corners = Windows(planner).read(EVERYONE)
    floor, solid, target, kinds = truth.read(EVERYONE, corners)
    world = envs.unwrapped.world
    for e in EVERYONE:
        places = world.places[e].targets * world.config.step + world.lattices[e].origin
        south, east = on_map(truth, e, places, planner, corners[e])
        inside = (south > 0) & (south < WINDOW - 1) & (east > 0) & (east < WINDOW - 1)
        # Places that lie on a block's node, up to half of the lattice's pitch.
        near = inside & (np.abs(south - np.rint(south)) + np.abs(east - np.rint(east)) < 1e-3)
        i, j = np.rint(south[near]).astype(int), np.rint(east[near]).astype(int)
        assert len(i) > 20
        assert floor[e, i, j].all()
        # Each place counts for its block; on an edge, half for both; all count alike.
        counts, edges = np.zeros((WINDOW, WINDOW)), np.arange(WINDOW + 1) - 0.5
        for a in (-1e-3, 1e-3):
            for b in (-1e-3, 1e-3):
                counts += np.histogram2d(south + a, east + b, (edges, edges))[0] / 4 / len(places)
        assert np.allclose(target[e], counts, atol=1e-6)
        assert target[e].sum() <= 1 + 1e-6
    assert not floor[(windows & 7) == 4].any()  # nothing lies in an occupied block
    assert not (floor & solid).any()
    assert set(np.unique(kinds)) == {*range(len(GROUND) + 3), UNKNOWN}


def test_the_kinds_of_ground_are_those_of_the_house(explored):
    envs, planner, truth, _ = explored
    _, corners = Windows(planner).read(EVERYONE)
    kinds = truth.read(EVERYONE, corners).kinds
    names = [*GROUND, "bedroom", "kitchen", "bed"]
    checked = set()
    for e in EVERYONE:
        house = envs.houses[e]
        for room in house.rooms:
            for part in (room, *room.pieces):
                middle = np.reshape(part.box, (2, 2)).mean(axis=0)[None]
                covered = any(
                    piece.box[0] < middle[0, 0] < piece.box[2] and piece.box[1] < middle[0, 1] < piece.box[3]
                    for piece in room.pieces
                )
                i, j = np.rint(on_map(truth, e, middle, planner, corners[e])[:, 0]).astype(int)
                small = min(part.box[2] - part.box[0], part.box[3] - part.box[1]) < 0.6
                shown = not small and 0 <= i < WINDOW and 0 <= j < WINDOW
                if part.type in names and shown and (part is not room or not covered):
                    assert kinds[e, i, j] == names.index(part.type)
                    checked.add(part.type)
        for door in house.doors:
            middle = np.reshape(door.box, (2, 2)).mean(axis=0)[None]
            i, j = np.rint(on_map(truth, e, middle, planner, corners[e])[:, 0]).astype(int)
            if 1 <= i < WINDOW - 1 and 1 <= j < WINDOW - 1:
                assert (kinds[e, i - 1 : i + 2, j - 1 : j + 2] == names.index("door")).any()
                checked.add("door")
    assert checked == {"bedroom", "kitchen", "bed", "door"}


def test_solid_is_where_walls_run_and_furniture_stands(explored):
    """Checked in another way: points of blocks are turned into the house's frame by complex numbers."""
    envs, planner, truth, _ = explored
    _, corners = Windows(planner).read(EVERYONE)
    solid, half = truth.read(EVERYONE, corners).solid, planner.cell
    for e in EVERYONE:
        x, y, heading = truth.pose[e]
        along = np.exp(-1j * (np.pi / 2) * (round(heading / (np.pi / 4)) // 2))
        south, east = (np.arange(WINDOW) + corners[e][:, None]) * 2 * planner.cell
        middles = x + 1j * y + along * (east + 1j * south[:, None])
        boxes = envs.unwrapped.world.bank.geometries[e].solids

        def covered(points, margin, boxes=boxes):
            inside = np.zeros(points.shape, bool)
            for x, y, wide, high in boxes:
                across, down = np.abs(points.real - x) - wide, np.abs(points.imag - y) - high
                inside |= np.maximum(across, down) <= margin
            return inside

        # A block stands for the lattice's nearest place.
        margin = envs.unwrapped.config.step / 2 + 1e-6
        assert solid[e][covered(middles, -margin)].all()
        aside = np.linspace(-half, half, 5)
        points = middles[..., None, None] + aside[:, None] + 1j * aside
        assert np.any(covered(points, margin), axis=(2, 3))[solid[e] == 1].all()
        # A thin wall still ends sight along all of it, to half a block from its ends.
        for west, north, wide, high in boxes:
            if min(wide, high) < half / 2 and max(wide, high) > 2 * half:
                ends = np.array([[west - wide, north - high], [west + wide, north + high]])
                way = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0])) * (half + 3 * margin)
                wall = np.linspace(ends[0] + way, ends[1] - way, 24)
                found = np.zeros(len(wall), bool)
                for aside in (-2 * margin, 2 * margin):
                    i, j = np.rint(on_map(truth, e, wall + aside, planner, corners[e])).astype(int)
                    inside = (i >= 0) & (i < WINDOW) & (j >= 0) & (j < WINDOW)
                    found |= ~inside | (solid[e, i % WINDOW, j % WINDOW] == 1)
                assert found.all()
        assert (solid[e] == 1).sum() > 100


def test_marks_are_where_targets_were_picked_up_and_where_rays_met_pieces(explored):
    envs, planner, truth, marks = explored
    _, corners = Windows(planner).read(EVERYONE)
    read = marks.read(EVERYONE, corners)
    assert read.shape == (len(HOUSES), 2, WINDOW, WINDOW)
    found = planner.read("found").numpy()
    assert found.sum() > 4
    assert read[:, 0].sum((1, 2)).tolist() == found.tolist()
    target = truth.read(EVERYONE, corners).target
    for e, i, j in np.argwhere(read[:, 0] > 0):
        assert target[e, i - 2 : i + 3, j - 2 : j + 3].any()
    for k, kind in enumerate(KINDS):
        met = 0
        for e in EVERYONE:
            boxes = [p.box for room in envs.houses[e].rooms for p in room.pieces if p.type == kind]
            corner_blocks = [on_map(truth, e, np.reshape(b, (2, 2)), planner, corners[e]) for b in boxes]
            for i, j in np.argwhere(read[e, 1] == k + 1):
                met += 1
                assert any(
                    b[0].min() - 0.6 < i < b[0].max() + 0.6 and b[1].min() - 0.6 < j < b[1].max() + 0.6
                    for b in corner_blocks
                )
        assert met > 5


def test_marks_of_an_episode_are_forgotten_in_the_next(explored):
    _, planner, _, marks = explored
    state = planner.state
    before = marks.blocks.copy()
    fresh = torch.tensor([True, *[False] * (len(HOUSES) - 1)])
    observation = torch.ones(len(HOUSES), planner.world.rays, planner.world.channels)
    observation[..., : len(KINDS)] = 0.0
    planner.step(observation, torch.zeros(len(HOUSES), dtype=torch.bool), planner.advice, fresh)
    marks.note(observation)
    assert before[0].any()
    assert not marks.blocks[0].any()
    assert marks.blocks[1:].sum() >= before[1:].sum()
    planner.state = state
    marks.blocks[:], marks.found[:] = before, planner.read("found").numpy()


def test_what_is_written_is_what_places_count_and_where_paths_lead():
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    tracker = Tracker(envs.config, prior=True)
    tracker.begin(len(HOUSES))
    observation, _ = envs.reset(seed=0, options={"house": EVERYONE})
    planner = tracker.look(torch.as_tensor(observation), torch.zeros(len(HOUSES), dtype=torch.bool))
    windows, near = Windows(planner), planner.arrays["cells"].numpy() & NEAR
    given = np.zeros((1, WINDOW, WINDOW), np.uint16)
    given[0, 2, 3], given[0, 3, 5], given[0, 5, 5] = 70 | PATH, 200 << WALL | 30, BLOCKED << WALL | 40
    windows.write(np.array([2]), given)
    counts = planner.foreseen(2)
    corner = middle(planner, 2) - WINDOW // 2 + len(counts) // 2
    here, there, wall = (tuple(np.add(corner, place)) for place in ((2, 3), (3, 5), (5, 5)))
    assert [counts[here], counts[there], counts[wall]] == [70, 30, 40]
    assert counts.sum() == 140
    assert not planner.foreseen(1).any()
    added = (planner.arrays["cells"].numpy() & NEAR) & ~near
    assert 0 < added.astype(bool).sum() <= 4  # the four cells of the block that paths lead to


def corridor():
    """Return a window of 48 by 48 that is seen in its first four columns, with two walls.

    Half of the rows of the wall at column 10 have a gap; the wall at column 20 has none.
    """
    windows, solid = np.zeros((2, 2, 48, 48), np.uint8)
    windows[:, :, :4] = 8 * 4
    solid[:, ::2, 10] = solid[:, :, 20] = 1
    return windows, solid


def test_rays_go_from_seen_ground_as_far_as_the_first_wall():
    windows, solid = corridor()
    sight = cast_rays(windows, solid, np.random.default_rng(0))
    assert sight.rays.shape == sight.passed.shape == windows.shape
    assert not sight.rays[:, :, :4].any()  # seen ground needs no prediction
    assert not sight.rays[:, :, 21:].any()  # no ray gets there
    came = sight.rays > 0
    assert came[:, 10:40, 4:10].mean() > 0.95
    assert set(np.unique(sight.passed[came & (solid == 1)])) == {0.0}
    assert set(np.unique(sight.passed[came & (solid == 0)])) == {1.0}
    assert 0 < sight.rays[:, :, 11:20].sum() < sight.rays[:, :, 4:10].sum() / 2


def test_the_product_of_what_passes_is_about_how_far_rays_come():
    """Over many houses whose wall is anywhere within ten columns; rays at an angle take more steps."""
    random, wide = np.random.default_rng(1), 48
    windows, solid = np.zeros((2, 400, wide, wide), np.uint8)
    windows[:, :, :3] = 8 * 4
    at = random.integers(10, 20, 400)
    solid[np.arange(400), :, at] = 1
    rays, passed = cast_rays(windows, solid, random)
    shares = (rays * passed).sum((0, 1)) / rays.sum((0, 1)).clip(1)
    survives = np.cumprod(shares[3:21])
    true = [(at > column).mean() for column in range(3, 21)]
    assert np.allclose(survives, true, atol=0.08)
    assert survives[-1] == 0  # no view reaches beyond the last wall, although no wall stands there
    assert (rays.sum((1, 2)) > 0).all()
    assert rays.sum() <= 400 * RAYS * RANGE


def test_no_ray_is_cast_where_nothing_was_seen_or_all_of_it_is_occupied():
    windows, solid = corridor()
    windows[0] = 0
    windows[1, :, :4] |= 4
    assert not any(each.any() for each in cast_rays(windows, solid, np.random.default_rng(0)))
    windows[1] = 8 * 4
    assert not any(each.any() for each in cast_rays(windows, solid, np.random.default_rng(0)))


def batch_of(windows, floor, kinds, starts=None):
    """Return a batch whose targets lie on all floor with equal probability."""
    target = floor.float() / floor.float().sum((1, 2), keepdim=True)
    starts = torch.zeros(len(windows), 2) if starts is None else starts
    rays = (windows == 0).float()
    return WindowBatch(
        windows, windows[:, None].repeat(1, 2, 1, 1), starts, floor, target, kinds, rays, floor.float()
    )


def test_turned_houses_keep_their_starts():
    random = np.random.default_rng(0)
    windows = torch.zeros(3, WINDOW, WINDOW, dtype=torch.uint8)
    starts = torch.tensor([[5.0, 70.0], [40.0, 41.0], [90.0, 3.0]])
    for n, (i, j) in enumerate(starts.int().tolist()):
        windows[n, i, j] = n + 1
    batch, places = batch_of(windows, windows + 1, windows + 2, starts), set()
    for _ in range(40):
        seen = turned(batch, random)
        assert [int(seen.windows[n, int(i), int(j)]) for n, (i, j) in enumerate(seen.starts)] == [1, 2, 3]
        assert torch.equal(seen.marks[:, 0], seen.windows)
        assert torch.equal(seen.floor, seen.windows + 1)
        assert torch.equal(seen.kinds, seen.windows + 2)
        again = batch_of(seen.windows, seen.floor, seen.kinds)
        assert torch.allclose(seen.target, again.target)
        assert torch.equal(seen.rays, again.rays)
        assert torch.equal(seen.passed, again.passed)
        places.add(tuple(seen.starts[0].tolist()))
    assert len(places) == 8


def test_the_loss_is_of_what_was_not_seen_and_falls_with_the_truth():
    windows, bits = torch.zeros(2, 1, 32, 32, dtype=torch.uint8)
    windows[0, :, :8], bits[0, 4:20] = 8 * 4, 1
    kinds = torch.full_like(bits, UNKNOWN)
    kinds[0, 4:20] = 1
    batch = batch_of(windows, bits, kinds)
    floor = torch.where(bits > 0, 9.0, -9.0)
    target = floor.flatten(1).log_softmax(1).view_as(floor)
    ground = torch.stack([torch.full((1, 16, 16), -9.0), torch.full((1, 16, 16), 9.0)], 1)
    right = completion_loss(Prediction(floor, floor, target, ground), batch)
    least = TARGETS * np.log(16 * 32)
    assert float(right) == pytest.approx(least, abs=0.01)
    # Beyond 12 blocks from seen ground the weight is small.
    far = floor.clone()
    far[0, :, 30:] = 9.0
    wrong = floor.clone()
    wrong[0, :, 12:14] = 9.0
    losses = [float(completion_loss(Prediction(each, floor, target, ground), batch)) for each in (far, wrong)]
    assert right < losses[0] < least + (losses[1] - least) / 5
    assert completion_loss(Prediction(floor, floor, target, -ground), batch) > right + 1
    nowhere = torch.full_like(floor, -np.log(32 * 32.0))
    assert completion_loss(Prediction(floor, floor, nowhere, ground), batch) > right + 0.1
    # Sight is judged only where rays came.
    came = batch.rays > 0
    for where, least in ((came, 1.0), (~came, 0.0)):
        loss = completion_loss(Prediction(floor, torch.where(where, -floor, floor), target, ground), batch)
        assert loss >= right + least
    assert float(loss) == pytest.approx(float(right), abs=1e-6)


def test_a_network_tells_how_likely_a_target_is_in_its_window():
    torch.manual_seed(0)
    network = CompletionNetwork(2, 2, (4, 4))
    windows = torch.randint(0, 40, (3, WINDOW, WINDOW), dtype=torch.uint8)
    marks = torch.zeros(3, 2, WINDOW, WINDOW, dtype=torch.uint8)
    floor, sight, target, kinds = network(windows, marks, torch.full((3, 2), 48.0))
    assert floor.shape == sight.shape == target.shape == (3, WINDOW, WINDOW)
    assert kinds.shape == (3, 2, WINDOW // 2, WINDOW // 2)
    assert (target.exp().sum((1, 2)) < 1).all()
    for plane, mark in ((0, 1), (1, 1), (1, 2)):
        noted = marks.clone()
        noted[1, plane, 50, 50] = mark
        other = network(windows, noted, torch.full((3, 2), 48.0)).target
        assert torch.allclose(other[[0, 2]], target[[0, 2]], atol=1e-5)
        assert not torch.allclose(other[1], target[1], atol=1e-5)


def picked_up(policy_of, houses, steps=350):
    """Return the targets picked up in an episode of each house."""
    envs = make_envs(houses, len(houses), "secondary")
    policy = policy_of(envs)
    policy.begin(len(houses))
    observation = torch.as_tensor(envs.reset(seed=0, options={"house": np.arange(len(houses))})[0])
    blocked, found = torch.zeros(len(houses), dtype=torch.bool), 0.0
    for _ in range(steps):
        observation, reward, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked, found = info["blocked"], found + float(reward.sum())
    return found


@pytest.mark.second_part("many episodes")
def test_who_foresees_the_truth_finds_more_and_another_house_less():
    houses = list(generate(5, seed=77, count=24))
    told = picked_up(truth, houses)
    misled = picked_up(lambda envs: with_shuffled_predictions(truth(envs), "truth"), houses)
    explorer = picked_up(lambda envs: Explorer(shield(envs), envs.config), houses)
    assert told > 1.05 * explorer
    assert misled < 0.95 * explorer


def test_nothing_counts_more_than_certain_and_what_was_seen_stays_open():
    foresight = Foresight(make_envs(HOUSES, 1).config, CompletionNetwork(1, 0, (4, 4)))
    windows = np.zeros((1, WINDOW, WINDOW), np.uint8)
    windows[0, 0, 0] = 8 * 4
    sure, likely = torch.full((2, 1, WINDOW, WINDOW), 30.0)
    likely = (likely * 0).flatten(1).log_softmax(1).view_as(sure)
    given = foresight.given(Prediction(sure, sure, likely, sure[:, None]), windows)
    assert (given == CERTAIN | PATH).all()
    some = likely.clone()
    some[0, 40:42, 40:42] += 8.0  # some blocks are far likelier: they are certain, and no more
    given = foresight.given(Prediction(sure, sure, some, sure[:, None]), windows)
    assert (given[0, 40:42, 40:42] == CERTAIN | PATH).all()
    # The weights of the others are below 1, but no floor has less. Between whole numbers, the right fraction
    # of them is rounded up.
    others = (given & COUNT).astype(float)[0, 48:]
    assert (others == 1).all()
    fewer = likely.clone()
    fewer[0, 40:42, 40:42] += 3.5
    others = (foresight.given(Prediction(sure, sure, fewer, sure[:, None]), windows) & COUNT)[0, 48:]
    dense = np.exp(3.5 * np.array([2, 1])) * 4 + WINDOW**2 - 4
    mean = CERTAIN * dense[1] / dense[0]
    assert set(np.unique(others)) == {int(mean), int(mean) + 1}
    assert others.mean() == pytest.approx(mean, abs=1 / 16)
    # If these were looked at since the last pick-up, only the others are left.
    windows[0, 40:42, 40:42] |= LOOKED
    assert (foresight.given(Prediction(sure, sure, some, sure[:, None]), windows) & COUNT == CERTAIN).all()
    none = foresight.given(Prediction(-sure, -sure, likely - 50, sure[:, None]), windows)
    assert none[0, 0, 0] == PATH | 1  # seen: a path may lead there, a view may go on, a target may lie there
    assert (none[0, 1:] == BLOCKED << WALL).all()
    half = foresight.given(Prediction(sure, 0 * sure, likely, sure[:, None]), windows)
    assert half[0, 0, 0] == CERTAIN | PATH
    assert (half[0, 1:] >> WALL == BLOCKED // 2 + 1).all()
    door = foresight.given(Prediction(-sure, sure, likely, sure[:, None]), windows)
    assert (door[0, 1:] == 0).all()  # sight passes, but neither a target nor a body can be there


def test_where_nothing_is_likely_it_still_looks_at_all_before_it_looks_again():
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = Explorer(shield(envs), envs.config, tracker=Tracker(envs.config, prior=True))
    policy.begin(len(HOUSES))
    observation = torch.as_tensor(envs.reset(seed=0, options={"house": EVERYONE})[0])
    blocked, seen = torch.zeros(len(HOUSES), dtype=torch.bool), []
    planner = policy.tracker.planner
    planner.arrays["prior"].view()[:] = PATH | 1  # the least weight of floor
    for step in range(STEPS):
        observation, _, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked = info["blocked"]
        searching = (planner.read("found") == 0).numpy()
        assert (planner.read("since").numpy()[searching] == 1).all()
        if step % 100 == 99:
            seen.append(planner.seen.numpy().copy())
    assert (seen[-1] > 1.1 * seen[0]).all()


def test_what_is_foreseen_is_the_ground_of_the_next_choice():
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    foresight = Foresight(envs.config, CompletionNetwork(1, 0, (4, 4)))
    foresight.begin(len(HOUSES))
    look, planner = torch.as_tensor(envs.reset(seed=0, options={"house": EVERYONE})[0]), foresight.planner
    stands = torch.zeros(len(HOUSES), dtype=torch.bool)
    for _ in range(12):  # it turns on the spot; its own last prediction was three steps ago
        foresight.look(look, stands)
        look, _, _, _, _ = envs.step_torch(foresight.actions)
    ages = planner.read("plan_age").numpy().copy()
    foresight.foresee(EVERYONE[:2])
    Tracker.look(foresight, look, stands)
    again = planner.read("plan_age").numpy()
    assert (again[:2] == 0).all()
    assert (again[2:] == ages[2:] + 1).all()


def test_it_predicts_where_something_is_new_or_was_found_or_after_a_while(monkeypatch):
    foresight, asked = Foresight(make_envs(HOUSES, 1).config, CompletionNetwork(1, 0, (4, 4))), []
    foresight.begin(3)
    monkeypatch.setattr(foresight, "foresee", lambda environments: asked.append(environments.tolist()))
    planner, states = foresight.planner, foresight.planner.arrays["states"].view()
    monkeypatch.setattr(planner, "step", lambda *given: None)
    at = [AT[name] + SIZE * np.arange(3) for name in ("time", "seen", "found", "kind")]
    nothing = torch.ones(3, planner.world.rays, planner.world.channels), torch.zeros(3, dtype=torch.bool)
    now = 12 * STEP_INTERVAL + 1
    for where, values in zip(at, ([now - 1] * 3, [0, MIN_NEW_CELLS, 0], [0, 0, 1], [NONE] * 3), strict=True):
        states[where] = values
    foresight.age[:] = MIN_STEPS_BETWEEN
    foresight.look(*nothing)
    assert not asked  # not every step
    states[at[0]] = now
    foresight.look(*nothing)
    states[at[3]] = TARGET  # a target that is known need not be sought
    foresight.look(*nothing)
    states[at[3]], foresight.age[:] = NONE, [MAX_STEPS_BETWEEN, 0, 0]
    foresight.look(*nothing)
    assert asked == [[1, 2], [], [0, 2]]


@pytest.mark.parametrize(
    ("targets", "preset", "message"),
    [
        ("main", "default", "runs only the task that it was trained on: give --targets secondary"),
        ("secondary", replace(PAPER, body=(0.4, 0.4)), "cannot read those of one 0.400 m wide"),
    ],
)
def test_another_task_or_another_body_is_refused(targets, preset, message):
    config = CompletionConfig(targets="secondary", kinds=("bedroom",), channels=(4, 4))
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
