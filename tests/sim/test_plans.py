"""Houses that are no stars: rooms with several doors, rooms behind rooms, a closed entrance."""

import numpy as np
import pytest

from tests import sample_houses
from tests.plans import PLANS, flat
from tests.sim.backends.agreement import require_equal_rays
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv, Oracle, shortest_path
from vitruvius.sim.actions import FORWARD

HOUSES = list(PLANS.values())


def room_of(house: House, places: np.ndarray) -> list[str]:
    """Return the type of the room that contains each of the places (n, 2)."""
    boxes = np.array([room.box for room in house.rooms])
    inside = ((boxes[:, :2] < places[:, None]) & (places[:, None] < boxes[:, 2:])).all(axis=2)
    return [house.rooms[k].type for k in inside.argmax(axis=1)]


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_a_converted_star_is_packed_bit_for_bit_as_before(preset: str) -> None:
    stars = [*sample_houses.RANDOM, sample_houses.example()]
    before, after = (
        HouseVectorEnv(bank, targets="main", preset=preset).tables()
        for bank in (stars, [House.from_dict(house.converted().to_dict()) for house in stars])
    )
    assert all(np.array_equal(before[name], after[name]) for name in before)


@pytest.mark.parametrize("backend", ["continuous", "grid"])
@pytest.mark.parametrize(
    ("targets", "rooms"),
    [
        ("main", {"corridor"}),
        ("secondary", {"bedroom", "bathroom", "hall", "kitchen", "living"}),
        ("all", {"corridor", "bedroom", "bathroom", "hall", "kitchen", "living"}),
        ({"rooms": ["bathroom", "study"]}, {"bathroom"}),
        ({"task": "reach", "room": "kitchen"}, {"kitchen"}),
    ],
)
def test_bodies_start_in_the_hub_and_targets_lie_in_the_rooms_asked_for(backend, targets, rooms) -> None:
    envs = HouseVectorEnv([flat()], num_envs=400, backend=backend, targets=targets)
    _, info = envs.reset(seed=0)
    assert set(room_of(flat(), info["pose"][:, :2])) == {"corridor"}
    assert set(room_of(flat(), info["target"])) == rooms


def test_without_a_hub_bodies_start_at_the_entrance_and_the_main_room_is_refused_with_what_else_to_ask() -> (
    None
):
    envs = HouseVectorEnv([PLANS["chain"]], num_envs=100, targets="all")
    assert set(room_of(PLANS["chain"], envs.reset(seed=0)[1]["pose"][:, :2])) == {"hall"}
    with pytest.raises(ValueError, match=r'house 2 of 3: it names no hub.*targets="all" or \{"rooms":'):
        HouseVectorEnv(HOUSES, targets="main")


def test_rooms_are_a_list_of_types() -> None:
    with pytest.raises(ValueError, match="rooms: give a list of room types, not 'bedroom'"):
        HouseVectorEnv(HOUSES, targets={"rooms": "bedroom"})
    with pytest.raises(ValueError, match=r"no room that can hold the targets .*: its rooms are bathroom"):
        HouseVectorEnv(HOUSES, targets={"rooms": ["cellar"]})


def test_a_path_leads_through_every_door_of_a_row_of_rooms() -> None:
    house = PLANS["chain"]
    first, last = house.room("R0"), house.room("R4")
    pose = [first.x + 1.0, first.y + 1.0, 0.0]
    path = shortest_path(house, pose, [last.x + 1.0, last.y + 1.0])
    assert path is not None
    shut = House(house.rooms, house.doors[:3], house.windows)  # without the door between R2 and R3
    assert shortest_path(shut, pose, [last.x + 1.0, last.y + 1.0]) is None


@pytest.mark.parametrize("name", PLANS)
def test_an_entrance_is_shut_to_bodies_and_rays(name: str) -> None:
    house = PLANS[name]
    (door,) = (door for door in house.doors if door.is_entrance)
    (room,) = (room for room in house.rooms if room.name in door.between)
    x, y = door.x + door.width / 2, door.y + door.height / 2
    out = np.sign([x - room.x - room.width / 2, y - room.y - room.height / 2]) * [
        door.height > 0,
        door.width > 0,
    ]
    heading = np.arctan2(-out[1], out[0]) % (2 * np.pi)
    envs = HouseVectorEnv([house], targets="all")
    options = {"house": [0], "pose": [[x - 0.5 * out[0], y - 0.5 * out[1], heading]]}
    seen, _ = envs.reset(seed=0, options=options)
    ahead = seen[0, envs.config.rays // 2, 0] * envs.config.range
    assert ahead == pytest.approx(0.5, abs=0.01)
    blocked = [envs.step(np.array([FORWARD]))[4]["blocked"][0] for _ in range(20)]
    assert blocked[-1]


@pytest.mark.second_part("long episodes")
@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_the_searcher_finds_targets_behind_rooms(backend: str) -> None:
    count = 12
    envs = HouseVectorEnv(HOUSES, num_envs=count, targets="all", backend=backend, max_episode_steps=500)
    options = {"house": np.arange(count) % len(HOUSES)}
    envs.reset(seed=0, options=options)
    oracle = Oracle(envs).play()
    envs.reset(seed=0, options=options)
    searcher, found = Searcher(envs), np.zeros(count)
    for _ in range(500):
        found += envs.step(searcher.act())[1]
    assert (found <= oracle).all()
    assert found.sum() > 0.4 * oracle.sum()


def test_the_paper_s_rule_of_collision_is_refused_where_rooms_have_several_doors() -> None:
    with pytest.raises(ValueError, match="collision 'original' needs rooms with one door"):
        HouseVectorEnv(HOUSES, targets="all", preset="paper")


def test_rays_on_the_grid_equal_those_of_the_continuous_backend_in_plans() -> None:
    require_equal_rays(HOUSES, 1000, "all")
