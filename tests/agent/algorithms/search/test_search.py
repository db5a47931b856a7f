"""Network that searches: its inputs, the worth of views, its goals, and the arguments that it refuses."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
import torch

from benchmarks.planner.true_views import true_views
from tests.sample_houses import FOUR_ROOMS
from vitruvius.agent.algorithms.build import learner_of, network_of, policy_of
from vitruvius.agent.algorithms.map_completion.windows import Windows
from vitruvius.agent.algorithms.search.chooser import ViewChooser, best
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.algorithms.search.crop import box, by_size, cropped
from vitruvius.agent.algorithms.search.learner import choice_loss, value_loss
from vitruvius.agent.algorithms.search.maps import MapReader
from vitruvius.agent.algorithms.search.network import (
    NODE_STEPS,
    SIZES,
    ViewNetwork,
    cost,
    expected,
    foreseeing,
    foreseen,
    hides,
    in_view,
    stands,
)
from vitruvius.agent.algorithms.search.windows import (
    FAR,
    HEADINGS,
    LEVELS,
    PLACES,
    ViewMaps,
    empty,
    turned,
    views,
)
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import TUNED
from vitruvius.agent.planner.core.frame import AXES
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED, SOLID
from vitruvius.agent.planner.viewpoints.choice import Viewpoints
from vitruvius.agent.policies.policies import Explorer
from vitruvius.agent.runs import checkpoint
from vitruvius.logic import generate
from vitruvius.logic.errors import RequestError
from vitruvius.sim.config import DEFAULT, PAPER
from vitruvius.sim.tasks.survey import survey

HOUSES = FOUR_ROOMS
EVERYONE = np.arange(len(HOUSES))
MIDDLE = PLACES // 2
SMALL = SearchConfig(targets="secondary", channels=(4, 4), num_envs=4, num_steps=16, batch_size=4)


def played(policy, envs, steps, look=lambda: None):
    """Return the targets after some steps, one environment in each house; call ``look`` after each action."""
    policy.begin(envs.num_envs)
    houses = np.arange(envs.num_envs) % len(envs.houses)
    observation = torch.as_tensor(envs.reset(seed=3, options={"house": houses})[0])
    blocked, found = torch.zeros(envs.num_envs, dtype=torch.bool), 0.0
    for _ in range(steps):
        actions = policy(observation, blocked)
        look()
        observation, reward, _, _, info = envs.step_torch(actions)
        blocked, found = info["blocked"], found + float(reward.sum())
    return found


def without_cost(network, inputs, values):
    """Return values of views for which far paths cost nothing."""
    (maps,) = inputs
    return values + cost(maps.ways, network.turns[maps.heading]).log()


def learnt(network):
    """Return the network with random last weights; those of a new network are zero."""
    torch.nn.init.normal_(network.out.weight, std=0.05)
    return network


class Noted(ViewChooser):
    """Chooser that keeps its inputs and choices, and the maps as they were then."""

    def __call__(self, planner):
        self.choices, self.waiting = getattr(self, "choices", []), []
        super().__call__(planner)
        for e, path in self.waiting:
            self.choices[path]["path"] = int(planner.read("path")[e])

    def look(self, environments, maps):
        self.asked = environments
        return super().look(environments, maps)

    def values(self, maps):
        values, reader, lost = super().values(maps), cast(MapReader, self.reader), self.asked
        for n, (e, corner) in enumerate(zip(lost, reader.corners(lost), strict=True)):
            self.waiting.append((e, len(self.choices)))
            names = ("since", "time", "x", "y", "heading")
            self.choices.append(
                {name: int(reader.planner.read(name)[e]) for name in names}
                | {"e": e, "corner": corner, "maps": ViewMaps(*(each[n : n + 1] for each in maps))}
                | {"cells": reader.planner.arrays["cells"].numpy().reshape(-1, 256, 256)[e]}
                | {"pick": int(best(values[n : n + 1], ViewMaps(*(each[n : n + 1] for each in maps))))}
            )
        return values


@pytest.fixture(scope="module")
def choices():
    """Return the choices of a network with random weights in some steps.

    Far views cost this network nothing.
    """
    torch.manual_seed(0)
    envs, network = make_envs(HOUSES, len(HOUSES), "secondary"), learnt(ViewNetwork((4, 4), looks=True))
    network.register_forward_hook(without_cost)
    chooser = Noted(network, envs.config)
    played(Explorer(shield(envs), envs.config, chooser=chooser), envs, 250)
    assert len(chooser.choices) > 20
    return chooser.choices


def test_blocks_hold_the_cells_about_each_place_and_since_when(choices):
    for choice in choices[::8]:
        maps, cells = choice["maps"], choice["cells"]
        for i, j in np.random.default_rng(0).integers(0, 2 * PLACES, size=(200, 2)):
            y, x = choice["corner"] - 2 + 2 * np.array([i, j])
            four = [int(cells[(y + a) % 256, (x + b) % 256]) for a in (0, 1) for b in (0, 1)]
            times = [(cell & OCCUPIED - 1) >> FLAGS for cell in four]
            count = sum(cell >= OCCUPIED for cell in four)
            count += LEVELS * sum(time > 0 for time in times)
            count += LEVELS**2 * sum(time >= max(1, choice["since"]) for time in times)
            assert maps.blocks[0, i, j] == count
            ago = choice["time"] - max(times)
            age = 1 + 16 * np.log2(1 + ago) if max(times) else 0
            assert abs(int(maps.ages[0, i, j]) - age) <= 1
        seen = maps.blocks[0] // LEVELS % LEVELS
        assert (seen > 0).any()


def test_the_known_way_to_a_place_is_that_of_the_path_that_the_body_then_takes(choices):
    away = []
    for choice in choices:
        look, i, j = np.unravel_index(choice["pick"], (HEADINGS, PLACES, PLACES))
        way = int(choice["maps"].ways[0, i, j])
        assert way != FAR
        assert (way == 0) == ((i, j) == (MIDDLE, MIDDLE))
        assert way > 0 or look != choice["heading"]
        away.append((way, choice["path"] / 2))
    ways, paths = np.array([each for each in away if each[1] < 30000]).T
    assert len(ways) > 0.9 * len(away)
    # If no path comes so near, the path ends next to the place, perhaps on this side of a wall.
    assert np.median(np.abs(ways - paths)) < 3
    assert (np.abs(ways - paths) < 8).mean() > 0.8
    assert ways.max() > 12


def test_the_middle_is_the_body_and_the_start_is_where_it_was(choices):
    for choice in choices:
        place = (np.array([choice["y"], choice["x"]]) // 2) // 4
        assert np.array_equal(choice["corner"] // 4 + MIDDLE, place)
        assert np.array_equal(choice["maps"].start[0].numpy(), MIDDLE - place)


def test_no_view_is_the_goal_twice_between_two_pick_ups(choices):
    taken = {}
    for choice in choices:
        look, i, j = np.unravel_index(choice["pick"], (HEADINGS, PLACES, PLACES))
        goals = taken.setdefault((choice["e"], choice["since"]), [])
        goal = (look, *(choice["corner"] // 4 + (i, j)))
        noted = {
            (h, *(choice["corner"] // 4 + (south, east)))
            for south, east in np.argwhere(choice["maps"].taken[0].numpy())
            for h in range(HEADINGS)
            if choice["maps"].taken[0, south, east] >> h & 1
        }
        assert goal not in goals
        assert noted <= set(goals)  # those in the window
        goals.append(goal)
    assert max(map(len, taken.values())) > 3


@pytest.mark.filterwarnings("ignore:.*Calling non-taichi function:SyntaxWarning")
def test_the_rule_that_chooses_views_is_not_called(monkeypatch):
    """The network plays on if the rule raises an error; the explorer does not."""

    def fault(*given):
        raise AssertionError("a rule chose a view")

    monkeypatch.setattr(Viewpoints, "choose", fault)
    monkeypatch.setattr(Viewpoints, "gain", fault)
    envs = make_envs(HOUSES[:1], 1, "secondary")
    other = replace(TUNED, gain_most=TUNED.gain_most + 1)  # so that kernels are compiled with the error
    chooser = ViewChooser(ViewNetwork((4, 4)), envs.config)
    policy = Explorer(shield(envs), envs.config, other, chooser=chooser)
    played(policy, envs, 40)
    assert int(policy.tracker.planner.seen[0]) > 0
    with pytest.raises(Exception, match="a rule chose a view"):
        played(Explorer(shield(envs), envs.config, other), envs, 1)


def test_a_body_without_a_view_to_go_to_turns():
    maps = ViewMaps(*(torch.zeros(1, 1) for _ in ViewMaps._fields))
    maps = maps._replace(taken=torch.zeros(1, PLACES, PLACES, dtype=torch.uint8))
    assert best(torch.full((1, HEADINGS, PLACES, PLACES), -torch.inf), maps) == -1
    envs = make_envs(HOUSES[:1], 1, "secondary")
    chooser = ViewChooser(ViewNetwork((4, 4)), envs.config, lambda envs, maps: torch.tensor([-1]))
    policy, actions = Explorer(shield(envs), envs.config, chooser=chooser), []
    played(policy, envs, 20, lambda: actions.append(int(policy.tracker.actions[0])))
    assert set(actions) <= {0, 1}


@pytest.fixture(scope="module")
def valued():
    """Return bodies on their way, the worth of views for them, and the corners of their windows."""
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = true_views(envs)
    chooser, told = cast(Any, policy.tracker.chooser), []
    picks = chooser.picks

    def noted(environments, maps):
        corners = chooser.reader.corners(environments)
        worth = chooser.truth.read(environments, corners).clone()
        poses = envs.unwrapped.world.describe()[0]
        told.extend(
            zip(environments, maps.ways, maps.blocks, worth, corners, poses[environments], strict=True)
        )
        return picks(environments, maps)

    chooser.picks = noted
    played(policy, envs, 250)
    return envs, chooser.truth, told


def test_what_a_view_is_worth_is_of_its_place_and_heading_in_the_house(valued):
    """Checked in another way: where the body can stand in the lattice, and what rays from there show."""
    envs, truth, told = valued
    world = envs.unwrapped.world
    bank = survey(world.backend, world.bank, list(range(len(HOUSES))), world.lattices)
    place, stands, worth_there = np.stack(np.meshgrid(*[np.arange(PLACES)] * 2, indexing="ij"), -1), 0, 0
    for e, ways, blocks, worth, corner, pose in told[:40]:
        nodes = corner + 4 * place  # south, east of the start
        east, south = AXES[truth.quarter[e]]
        lattice = truth.start[e] + truth.steps * (nodes[..., 1:] * east + nodes[..., :1] * south)
        at = (pose[:2] - world.lattices[e].origin) / world.config.step
        middle = lattice[MIDDLE, MIDDLE]
        assert np.abs(middle - at).max() < 4 * truth.steps  # the body's place
        part = bank[e].part
        inside = ((lattice >= 0) & (lattice < part.shape)).all(-1)
        can = np.zeros(inside.shape, bool)
        can[inside] = part[tuple(lattice[inside].T)] > 0
        near = lattice % truth.pitch
        assert near.max() <= truth.steps - 1  # a known view is at most a fraction of a node aside
        some = worth.amax(0).numpy() > 0
        some[MIDDLE, MIDDLE] = False
        stands += (can & some).sum()
        worth_there += some.sum()
        seen = (blocks.numpy() // LEVELS % LEVELS == 4)[1::2, 1::2]
        assert (worth >= 0).all()
        assert float(worth.max()) < 100 / 5
        assert (seen & (ways.numpy() != FAR)).any()
    assert worth_there > 1000
    assert stands > 0.97 * worth_there


def test_a_path_costs_its_steps():
    envs = make_envs(HOUSES[:1], 1, "secondary")
    planner = Explorer(shield(envs), envs.config).tracker.planner
    assert round(planner.cell / envs.config.step) == NODE_STEPS
    straight = cost(torch.tensor([[[10]]]), torch.zeros(1, HEADINGS, 1, 1))
    assert float(straight[0, 0, 0, 0]) == 4 + 10 * NODE_STEPS


def test_targets_that_were_not_seen_lie_where_the_map_says_that_they_may():
    """Checked in another way: the exact posterior, which removes each place that a ray would have met."""
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = true_views(envs)
    played(policy, envs, 200)
    chooser, world = cast(Any, policy.tracker.chooser), envs.unwrapped.world
    reader, truth, houses = chooser.reader, chooser.truth, world.describe()[2]
    maps, corners = reader.read(EVERYONE), reader.corners(EVERYONE)
    rows, left = truth.views.arrays["rows"].numpy(), truth.views.arrays["left"].numpy()
    spots = truth.views.arrays["spots"].numpy().reshape(-1, 2)
    may, seen = hides(maps).numpy(), (maps.blocks // LEVELS**2 >= 3).numpy()
    kept, struck, loosely = [], [], []
    for e in EVERYONE:
        row, words = rows[houses[e]], left.reshape(len(HOUSES), -1)[e]
        places = spots[row[0] : row[0] + row[1]]
        still = np.unpackbits(words.view(np.uint8), bitorder="little")[: len(places)].astype(bool)
        away = (places - truth.start[e]) @ AXES[truth.quarter[e]].T / truth.steps  # nodes east and south
        blocks = (np.floor(away[:, ::-1] - corners[e] + 2) // 2).astype(int)
        inside = ((blocks >= 0) & (blocks < 2 * PLACES)).all(1)
        at = e, *blocks[inside].T
        kept += list(may[at][still[inside]])
        struck += list(may[at][~still[inside]])
        loosely += list(~seen[at][~still[inside]])
    assert min(len(kept), len(struck)) > 500
    assert np.mean(kept) > 0.8
    assert np.mean(struck) < 0.5 * np.mean(loosely)


def test_a_body_stands_on_seen_ground_and_on_floor_that_is_foreseen():
    maps = random_maps(1)
    blocks, foreseen = torch.zeros_like(maps.blocks), torch.zeros_like(maps.foreseen)
    blocks[0, :2, :2] = 4 * LEVELS
    foreseen[0, 0, 2:4, :2] = 51
    found = stands(maps._replace(blocks=blocks, foreseen=foreseen))[0]
    assert [round(float(found[at]), 6) for at in ((0, 0), (1, 0), (1, 1))] == [1, 0.2, 0]


@pytest.mark.second_part("many episodes")
def test_who_goes_by_true_values_finds_more_than_the_explorer():
    envs = make_envs(list(generate(5, seed=77, count=12)), 12, "secondary")
    assert played(true_views(envs), envs, 300) > 1.1 * played(Explorer(shield(envs), envs.config), envs, 300)


def random_maps(count=3):
    """Return random maps with the body in the middle; the worth is 1 for views that were taken."""
    random = torch.Generator().manual_seed(0)

    def draw(most, *shape, kind=torch.uint8):
        return torch.randint(0, most, (count, *shape), generator=random).to(kind)

    taken = draw(256, PLACES, PLACES)
    ways = draw(200, PLACES, PLACES, kind=torch.int16) - 1
    ways[:, MIDDLE, MIDDLE] = 0
    worth = (taken[:, None].int() >> torch.arange(HEADINGS)[:, None, None] & 1).half()
    blocks = draw(125, 2 * PLACES, 2 * PLACES)
    blocks[:, ::2, ::2] = blocks[:, 1::2, ::2] = blocks[:, ::2, 1::2] = blocks[:, 1::2, 1::2]
    return ViewMaps(
        blocks, blocks, ways, taken, taken, torch.full((count, 2), 3.0), torch.rand(count, 3),
        draw(8, kind=torch.int64), worth, blocks[:, None].expand(-1, 4, -1, -1), worth / 8,
    )  # fmt: skip


def test_turned_maps_are_of_the_same_views():
    maps = random_maps()
    for quarters in range(4):
        for mirrored in (False, True):
            other = turned(maps, quarters, mirrored)
            bits = torch.arange(HEADINGS)[:, None, None]
            assert torch.equal((other.taken[:, None].int() >> bits & 1).half(), other.worth)
            assert torch.equal(other.shown, other.worth / 8)
            assert torch.equal(other.foreseen[:, 3], other.blocks)
            assert (other.ways[:, MIDDLE, MIDDLE] == 0).all()
            assert torch.equal(other.finds, other.taken) or quarters or mirrored
    once = turned(turned(maps, 1, False), 3, False)
    inner = slice(1, None)
    assert torch.equal(once.ways[:, inner, inner], maps.ways[:, inner, inner])
    assert torch.equal(once.worth[:, :, inner, inner], maps.worth[:, :, inner, inner])
    assert torch.equal(once.heading, maps.heading)
    assert torch.equal(once.start, maps.start)
    # A quarter counter-clockwise: what lay to the east lies to the north, and the heading turns with it.
    east = maps._replace(ways=torch.full_like(maps.ways, FAR), heading=torch.zeros(3, dtype=torch.int64))
    east.ways[:, MIDDLE, MIDDLE + 5] = 7
    north = turned(east, 1, False)
    assert (north.ways[:, MIDDLE - 5, MIDDLE] == 7).all()
    assert (north.heading == 2).all()
    west = turned(east, 0, True)
    assert (west.ways[:, MIDDLE, MIDDLE - 5] == 7).all()
    assert (west.heading == 4).all()


def test_a_network_values_the_views_that_a_path_leads_to():
    torch.manual_seed(0)
    network, maps = learnt(ViewNetwork((4, 4), foresight=True, looks=True)), random_maps()
    values = network(maps)
    assert values.shape == (3, HEADINGS, PLACES, PLACES)
    assert torch.equal(torch.isfinite(values), views(maps))
    assert not views(maps)[torch.arange(3), maps.heading, MIDDLE, MIDDLE].any()
    # The same view has less value at first if it is farther away or needs more turns.
    near = maps._replace(ways=torch.full_like(maps.ways, 10))
    far = maps._replace(ways=torch.full_like(maps.ways, 100))
    assert network(near).mean() > network(far).mean() + 1
    for name in ("blocks", "ages", "finds", "taken", "start", "scalars", "heading", "foreseen", "shown"):
        field = getattr(maps, name)
        changed = field + 1 if field.is_floating_point() else (field + 1) % 8
        other = network(maps._replace(**{name: changed}))
        both = torch.isfinite(other) & torch.isfinite(values)
        assert not torch.equal(other[both], values[both]), name


def test_what_a_view_would_show_is_what_rays_over_the_map_meet(choices):
    """Checked in another way: ray by ray, in Python."""
    turns, random, some = (
        np.pi / 4 * (np.arange(8)[:, None] + (np.arange(5) - 2) / 5),
        np.random.default_rng(0),
        0,
    )
    for choice in choices[::8]:
        maps, corner, cells = choice["maps"], choice["corner"], choice["cells"]
        dense, passes = (field[0].numpy() for field in expected(maps))
        there = np.argwhere(maps.ways[0].numpy() > 0)
        for i, j in random.permutation(there)[:12]:
            octant, shown = int(random.integers(8)), 0.0
            for angle in turns[octant]:
                reaches = 1.0
                for k in range(1, 28):
                    y, x = 4 * i - np.rint(2 * k * np.sin(angle)), 4 * j + np.rint(2 * k * np.cos(angle))
                    cell = int(cells[int(corner[0] + y) % 256, int(corner[1] + x) % 256])
                    at = int(y + 2) // 2, int(x + 2) // 2
                    if (
                        cell & (OCCUPIED | SOLID)
                        or not 0 <= min(at) <= max(at) < 2 * PLACES
                        or reaches < 0.02
                    ):
                        break
                    shown += reaches * k * dense[at] * np.pi / 20
                    reaches *= 1 if cell >= 1 << FLAGS else passes[at]
            assert float(maps.shown[0, octant, i, j]) == pytest.approx(
                shown / dense.sum(), rel=0.02, abs=1e-4
            )
            some += shown > 0
        far = maps.ways[0] == FAR
        assert (maps.shown[0, :, far] == 0).all()
    assert some > 20


def test_a_network_that_has_learnt_nothing_goes_by_what_views_show_for_what_they_cost(choices):
    network = ViewNetwork((4, 4), looks=True)
    for choice in choices[::8]:
        maps = choice["maps"]
        shows = in_view(maps.shown.float()) * stands(maps)[:, None]
        expected = 100 * (shows + 1e-3) / cost(maps.ways, network.turns[maps.heading])
        assert torch.allclose(network(maps).exp(), expected * views(maps))


def test_a_part_of_a_window_has_all_that_was_seen_and_some_ground_about_it(choices):
    maps = ViewMaps(*(torch.cat(field) for field in zip(*(each["maps"] for each in choices), strict=True)))
    part = box(maps)
    near = cropped(maps, part)
    assert (part.high % 8, part.wide % 8) == (0, 0)
    assert part.high < PLACES
    for whole, cut in zip(maps, near, strict=True):
        if whole.dim() > 2 and whole.shape[-1] in (PLACES, 2 * PLACES):
            kept = cut if cut.dim() == 4 else cut[:, None]
            again = part.whole(kept, 0)
            assert torch.equal(again.sum((2, 3)), kept.sum((2, 3)))
            assert torch.equal(part.cut(again), kept)
    seen = maps.blocks // LEVELS % LEVELS > 0
    assert torch.equal(seen.sum((1, 2)), (near.blocks // LEVELS % LEVELS > 0).sum((1, 2)))
    assert torch.equal((maps.ways != FAR).sum((1, 2)), (near.ways != FAR).sum((1, 2)))
    sizes = seen.flatten(1).sum(1)[by_size(maps)].float()
    assert sizes[: len(sizes) // 4].mean() < sizes[-len(sizes) // 4 :].mean()


def test_what_is_foreseen_is_of_the_map_as_map_completion_reads_it():
    """The places begin at odd nodes, and their blocks are map completion's."""
    torch.manual_seed(0)
    envs = make_envs(HOUSES, len(HOUSES), "secondary")
    policy = Explorer(shield(envs), envs.config, chooser=ViewChooser(ViewNetwork((4, 4)), envs.config))
    played(policy, envs, 150)
    planner, given, predict = policy.tracker.planner, [], foreseeing()
    reader, windows = MapReader(envs.config, planner), Windows(planner)
    reader.phase[:] = 1
    maps, (theirs, corners) = reader.read(EVERYONE), windows.read(EVERYONE)
    predict.register_forward_hook(lambda _, inputs, made: given.append((inputs, made)))
    planes = foreseen(predict, maps) / SIZES[:, None, None]
    (ours, _, starts), made = given[0]
    for e in EVERYONE:
        south, east = (reader.corners(EVERYONE)[e] - 1) // 2 - corners[e]
        assert max(abs(south), abs(east)) <= 2
        inner = slice(4, -4)
        moved = np.roll(theirs[e] & 63, (-south, -east), (0, 1))
        assert np.array_equal(ours[e].numpy()[inner, inner], moved[inner, inner])
        assert np.abs(starts[e].numpy() + corners[e] + (south, east)).max() <= 1
    assert (planes[:, 0] - made.floor.sigmoid()).abs().max() < 1 / 255
    looked = (maps.blocks // LEVELS**2 >= 3) & (made.target > -9)
    assert looked.any()
    assert (planes[:, 2][looked] == 0).all()


def test_the_loss_of_choices_is_what_is_lost_by_drawing_one():
    """Views are worth 4, 1, 3 and 0. The first was the goal before; the last is no view."""
    values = torch.full((1, HEADINGS, PLACES, PLACES), -torch.inf)
    maps = random_maps(1)._replace(
        worth=torch.zeros(values.shape), taken=torch.zeros(1, PLACES, PLACES).byte()
    )
    maps.worth[0, 0, 0, :3] = torch.tensor([4.0, 1.0, 3.0])
    values[0, 0, 0, :3] = torch.tensor([2.0, 2.0, 4.0]).log()
    assert float(choice_loss(values, maps, 1.0)) == pytest.approx(1 - (0.25 + 0.25 / 4 + 0.5 * 3 / 4))
    assert float(choice_loss(values, maps, 0.5)) == pytest.approx(1 - (4 + 1 + 4 * 3) / 6 / 4)
    maps.taken[0, 0, 0] = 1
    assert float(choice_loss(values, maps, 1.0)) == pytest.approx(1 - (1 / 3 + 2 * 3 / 3) / 3)
    maps.taken[0, 0] = 255  # all were goals: then they count as before
    assert float(choice_loss(values, maps, 1.0)) == pytest.approx(1 - (0.25 + 0.25 / 4 + 0.5 * 3 / 4))
    values.requires_grad_()
    choice_loss(values, maps, 1.0).backward()
    slopes = cast(torch.Tensor, values.grad)[0, 0, 0]
    assert slopes[0] < 0 < slopes[1]
    assert torch.isfinite(cast(torch.Tensor, values.grad)).all()


def test_the_loss_of_values_is_least_at_the_mean_of_what_views_are_worth():
    """Unknowable outcomes are averaged: half of the time 1, half of the time 0."""
    worth = torch.zeros(2, 1, 1, 3)
    worth[0, 0, 0] = torch.tensor([1.0, 0.4, 0.0])
    values = torch.tensor([0.5, 0.2, 1e-4]).log().expand(2, 1, 1, 3).clone()
    values[..., 2] = -torch.inf
    least = value_loss(values, worth)
    for change in (-0.1, 0.1):
        for k in range(2):
            other = values.clone()
            other[..., k] += change
            # The weights may differ; the claim is about the gradient at the mean.
            other.requires_grad_()
            value_loss(other, worth).backward()
            assert float(cast(torch.Tensor, other.grad)[..., k].sum()) * change > 0
    values.requires_grad_()
    value_loss(values, worth).backward()
    assert torch.allclose(cast(torch.Tensor, values.grad)[..., :2].sum(0), torch.zeros(1, 1, 2), atol=1e-6)
    assert torch.isfinite(least)


@pytest.mark.second_part("it learns")
@pytest.mark.parametrize("loss", ["choice", "value"])
def test_a_run_learns_what_views_are_worth(loss):
    envs = make_envs(HOUSES, 4, "secondary")
    config = replace(SMALL, loss=loss, steps=2500, guided=0.5, passes=5.0, learning_rate=1e-2)
    learner = cast(Any, learner_of(config, envs))
    losses = [now.loss for now in learner.train()]
    assert any(losses)
    assert learner.made > 60
    choices = ViewMaps(*(field[:40] for field in learner.buffer))
    with torch.no_grad():  # with the same choices: those of a run's beginning and end differ
        learnt, new = (
            float(learner.loss(network(choices), choices))
            for network in (learner.network, cast(Any, network_of(config)))
        )
    assert learnt < 0.98 * new  # an untrained network is near this: it reads what views show
    assert learner.buffer.worth[: learner.made].float().amax((1, 2, 3)).min() > 0
    # The predictions of unseen ground are unchanged.
    told, released = learner.network.completion.state_dict(), foreseeing().state_dict()
    assert all(torch.equal(told[name], each) for name, each in released.items())


def test_the_state_of_a_run_is_as_large_as_that_of_a_new_one():
    """Otherwise a saved state could not be read: see ``agent.runs.runs``."""
    envs = make_envs(HOUSES, 4, "secondary")
    learner = learner_of(replace(SMALL, buffer_size=8), envs)
    before = {name: field.shape for name, field in learner.state()["buffer"].items()}
    learner.iterate()
    after = learner.state()["buffer"]
    assert after["worth"].any()
    assert {name: (field.shape, field.dtype) for name, field in after.items()} == {
        name: (shape, after[name].dtype) for name, shape in before.items()
    }


@pytest.mark.parametrize(
    ("targets", "preset", "message"),
    [
        ("main", "default", "runs only the task that it was trained on: give --targets secondary"),
        ("secondary", replace(PAPER, body=(0.4, 0.4)), "cannot read those of one 0.400 m wide"),
    ],
)
def test_another_task_or_another_body_is_refused(targets, preset, message):
    envs = make_envs(HOUSES, 1, targets, preset=preset)
    with pytest.raises(RequestError, match=message):
        policy_of(network_of(SMALL), SMALL, envs)


def test_closed_doors_are_refused_in_one_line():
    config = replace(SMALL, sim=("closed_doors=3",))
    envs = make_envs(HOUSES, 4, "secondary", preset=replace(DEFAULT, closed_doors=3))
    with pytest.raises(RequestError, match="leave out --sim closed_doors"):
        learner_of(config, envs)


@pytest.mark.parametrize("changes", [{"body": (0.14, 0.14)}, {"step": 0.1}])
def test_another_body_is_not_learnt_with(changes):
    envs = make_envs(HOUSES, 4, "secondary", preset=replace(DEFAULT, **changes))
    with pytest.raises(RequestError, match="search is trained only on maps of the"):
        learner_of(SMALL, envs)


def test_as_many_levels_as_a_config_can_have_value_any_map():
    network = ViewNetwork(SearchConfig().channels)
    maps = empty(2)
    maps.blocks[0, 40:50, 40:50] = maps.blocks[1, 3:60, 20:30] = LEVELS
    assert network(maps).shape == maps.worth.shape


@pytest.mark.parametrize(
    "changes",
    [
        {"channels": (4,)},
        {"channels": (4,) * 5},
        {"guided": 1.5},
        {"device": "cuda"},
        {"buffer_size": 0},
        {"heat": 0.0},
    ],
)
def test_a_config_that_no_run_can_have_is_refused(changes):
    with pytest.raises(RequestError):
        SearchConfig(**changes)


def test_the_released_network_finds_more_than_the_explorer_in_houses_that_it_did_not_learn_in():
    made = checkpoint.load("search")
    envs = make_envs(list(generate(5, seed=78, count=12)), 12, "secondary")
    policy = policy_of(made.network, made.config, envs)
    assert played(policy, envs, 300) > played(Explorer(shield(envs), envs.config), envs, 300)
