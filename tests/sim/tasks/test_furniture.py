"""Targets beside furniture of a kind, and targets by a house's habits: all places, and their frequencies."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely import box

from tests import sample_houses
from vitruvius.agent.baselines.coverage import origins_of
from vitruvius.logic import House, Piece
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle
from vitruvius.sim.tasks.furniture import BESIDE, Habit, Object

TWO = sample_houses.drawn("aaaaa..\naaAaa..\naaaa+..\nbbbb+..\nbbbbb..\nbBbbb..")
"""Rooms a and b with a table each. The tables are close to each other, with a wall between them."""


def furnished(house: House, *kinds: str) -> House:
    """Return a star whose first pieces of furniture are of these kinds, room by room."""
    rooms, left = [], iter(kinds)
    for room in house.star.rooms:
        pieces = tuple(
            Piece(each.x, each.y, each.width, each.height, next(left, each.type)) for each in room.children
        )
        rooms.append(type(room)(room.x, room.y, room.width, room.height, room.type, pieces, room.door))
    return sample_houses.changed_star(house, rooms=tuple(rooms))


HOUSE = furnished(TWO, "bed", "stove")


def centres(envs: HouseVectorEnv, house: int = 0) -> np.ndarray:
    """Return the centres (m, 2) of all places of a house's targets, metres."""
    places = envs.world.places[house].targets
    return places * envs.config.step + origins_of(envs.world).reshape(-1, 2)[house]


def beside(house: House, kind: str, points: np.ndarray) -> np.ndarray:
    """Return a mask (n,) bool of the targets (n, 2) beside furniture of a kind, in its room, by shapely."""
    half, found = DEFAULT.target / 2, np.zeros(len(points), bool)
    squares = shapely.box(*(points - half).T, *(points + half).T)
    for room in house.rooms:
        for piece in room.pieces:
            if piece.type == kind:
                around = box(*piece.box).buffer(BESIDE + 2e-6, join_style="mitre")
                around = around.intersection(box(*room.box).buffer(2e-6, join_style="mitre"))
                found |= shapely.covers(around, squares)
    return found


@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_an_object_goal_has_all_free_places_beside_such_a_piece_and_no_other(backend):
    anywhere = centres(HouseVectorEnv([HOUSE], targets="all", backend=backend))
    for kind in ("bed", "stove"):
        task = {"task": "object", "piece": kind}
        found = {*map(tuple, centres(HouseVectorEnv([HOUSE], targets=task, backend=backend)))}
        expected = anywhere[beside(HOUSE, kind, anywhere)]
        assert found == {*map(tuple, expected)}
        assert 3 < len(found) < len(anywhere) / 2


def test_finding_the_piece_ends_the_episode():
    envs = HouseVectorEnv([HOUSE], num_envs=8, targets=Object("stove"))
    envs.reset(seed=0)
    oracle, over = Oracle(envs), np.zeros(8, bool)
    for _ in range(200):
        _, reward, terminated, _, _ = envs.step(oracle.act())
        np.testing.assert_array_equal(terminated, reward == 1)
        over |= terminated
    assert over.all()


@pytest.mark.parametrize(
    ("houses", "kind", "message"),
    [
        ([HOUSE], "bedd", "targets: there is no piece bedd: did you mean bed? There are bed, stove"),
        ([HOUSE, TWO, TWO], "stove", r"house 1 of 3 has no stove: use the 1 houses that have one"),
    ],
)
def test_a_piece_that_a_house_lacks_is_told_in_one_line(houses, kind, message):
    with pytest.raises(ValueError, match=message.replace("?", r"\?")) as error:
        HouseVectorEnv(houses, targets=Object(kind))
    assert "\n" not in str(error.value)


def test_the_kind_of_a_piece_is_a_name():
    with pytest.raises(ValueError, match="piece: give a furniture type, not 3"):
        HouseVectorEnv([HOUSE], targets={"task": "object", "piece": 3})


def probabilities(house: House, task: Habit, points: np.ndarray) -> np.ndarray:
    """Return the probability of each of these places (n, 2) of a house, by the task's definition."""
    half, total = DEFAULT.target / 2 - 1e-5, np.zeros(len(points))
    for rank, (what, name) in enumerate(task.order(house)):
        inside = np.zeros(len(points), bool)
        if what == "piece":
            inside = beside(house, name, points)
        else:
            for room in house.rooms:
                west, north, east, south = room.box
                low, high = np.array([west, north]) + half, np.array([east, south]) - half
                inside |= (room.type == name) & ((low <= points) & (points <= high)).all(axis=1)
        if inside.any():
            total += task.share * (1 - task.share) ** rank * inside / inside.sum()
    return total / total.sum()


@pytest.mark.second_part("many targets")
@pytest.mark.parametrize("backend", ["continuous", "grid"])
@pytest.mark.parametrize("task", [Habit(), Habit(0.3, seed=4), Habit(1.0)], ids=repr)
def test_a_habit_draws_targets_by_the_weights_that_it_states(backend, task):
    anywhere = centres(HouseVectorEnv([HOUSE], targets="all", backend=backend))
    expected = probabilities(HOUSE, task, anywhere)
    many = HouseVectorEnv([HOUSE], num_envs=20000, targets=task, backend=backend)
    here = many.world.places[0]
    at = {tuple(place): k for k, place in enumerate(anywhere)}
    stated, places = np.zeros(len(anywhere)), [at[tuple(place)] for place in centres(many)]
    assert here.counts is not None
    stated[places] = here.counts / here.counts.sum()
    many.reset(seed=1)
    drawn = many.targets(1)[:, 0]
    nearest = np.abs(drawn[:, None] - centres(many)).max(axis=2).argmin(axis=1)
    met = np.zeros(len(anywhere))
    np.add.at(met, np.array(places)[nearest], 1 / len(drawn))
    # Regions have whole numbers of about 4096 entries, and each place has a whole number of them.
    for region in [beside(HOUSE, kind, anywhere) for kind in ("bed", "stove")]:
        assert abs(stated[region].sum() - expected[region].sum()) < 0.02
        assert abs(met[region].sum() - stated[region].sum()) < 0.015
    assert np.abs(stated - met).sum() < 3 * np.sqrt(stated * (1 - stated) / len(drawn)).sum()
    assert abs(sum(region.share for region in here.regions) - 1) < 1e-9


def test_a_habit_belongs_to_the_house_and_the_seed():
    orders = [Habit(seed=seed).order(HOUSE) for seed in range(12)]
    assert len({tuple(order) for order in orders}) > 6
    assert all(Counter(order) == Counter(orders[0]) for order in orders)
    assert Habit(seed=3).order(HOUSE.converted()) == orders[3]
    other = furnished(TWO, "stove", "bed")
    assert [Habit(seed=seed).order(other) for seed in range(12)] != orders
    alone = HouseVectorEnv([HOUSE], targets="habit").world.places[0]
    among = HouseVectorEnv([TWO, HOUSE], targets="habit").world.places[1]
    np.testing.assert_array_equal(alone.listed, among.listed)


def test_a_share_is_above_none_and_at_most_all():
    assert len(Habit(share=1).regions(HOUSE)) == 1
    for share in (0, 1.01):
        with pytest.raises(ValueError, match="share must be above 0 and at most"):
            Habit(share=share)


SEES = replace(DEFAULT, kinds=("stove", "bed"), sees_kind=True)


@pytest.mark.second_part("kernels of many configurations")
@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_rays_tell_the_named_kinds_of_the_pieces_that_they_end_on(backend):
    houses = [HOUSE] if backend == "grid" else [HOUSE, *sample_houses.RANDOM]
    plain, named = (
        HouseVectorEnv(houses, num_envs=300, targets="all", backend=backend, preset=preset)
        for preset in (replace(DEFAULT, sees_kind=True), SEES)
    )
    plain.reset(seed=3, options={"house": np.arange(300) % len(houses)})
    _, info = named.reset(seed=3, options={"house": np.arange(300) % len(houses)})
    boxes = [
        [(piece.type, box(*piece.box)) for room in house.rooms for piece in room.pieces] for house in houses
    ]
    met = Counter()
    for step in range(30):
        actions = np.random.default_rng(step).choice(3, p=[0.2, 0.2, 0.6], size=300)
        without = plain.step(actions)[0]
        seen, _, _, _, info = named.step(actions)
        np.testing.assert_array_equal(seen[..., 2:], without)
        assert not seen[seen[..., 4] == 0][:, :2].any()
        angle = info["pose"][:, 2:] + named.config.ray_angles
        ends = info["pose"][:, None, :2] + (seen[..., 2] * named.config.range)[..., None] * np.stack(
            [np.cos(angle), -np.sin(angle)], axis=-1
        )
        for e, r in np.argwhere(seen[..., 4] == 1):
            around = shapely.Point(ends[e, r])
            near = {kind for kind, shape in boxes[info["house"][e]] if shape.boundary.distance(around) < 1e-3}
            told = {kind for place, kind in enumerate(SEES.kinds) if seen[e, r, place]}
            assert len(told) <= 1
            if len(near) == 1:
                assert told == near & {*SEES.kinds}
                met.update(near)
    assert min(met["bed"], met["stove"]) > 50
    assert backend == "grid" or met["table"] > 50


def test_the_kinds_alone_leave_the_distance_and_the_target_last():
    config = replace(DEFAULT, kinds=("bed",))
    named, plain = (
        HouseVectorEnv([HOUSE], num_envs=20, targets="all", preset=each) for each in (config, DEFAULT)
    )
    seen, _ = named.reset(seed=0)
    np.testing.assert_array_equal(seen[..., 1:], plain.reset(seed=0)[0])
    assert seen.shape == (20, 40, 3)


def test_a_kind_that_no_house_has_is_refused_in_one_line():
    with pytest.raises(
        ValueError, match=r"^kinds: there is no piece bedd: did you mean bed\? There are bed, stove$"
    ):
        HouseVectorEnv([HOUSE], preset=replace(DEFAULT, kinds=("bedd",)))
    with pytest.raises(ValueError, match="kinds are bed, bed: name each once"):
        replace(DEFAULT, kinds=("bed", "bed"))
