"""The study of exploration: the area that is seen, paths over known cells, and both agents on small maps."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.exploration.play import AGENTS, FRONTIER, Walk, configuration, walks
from benchmarks.exploration.run import Exploration
from benchmarks.exploration.seen import OPEN, SHUT, UNSEEN, Seen
from tests.maps import random_map
from vitruvius.logic import House, RequestError
from vitruvius.logic.exports import export
from vitruvius.logic.house.occupancy import FREE
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import HEADINGS

pytestmark = pytest.mark.second_part("each study is run in small")

MAP = random_map(5, 0.3)
ROOMS = np.zeros((90, 120), bool)
ROOMS[[0, 44, 45, -1]], ROOMS[:, [0, 59, 60, -1]] = True, True
ROOMS[44:46, 25:35], ROOMS[44:46, 85:95], ROOMS[15:25, 59:61] = False, False, False
FOUR = House.from_grid(ROOMS, 0.1)
"""Four rooms with three doorways of a metre."""


def envs_and_seen(field: float = 2 * math.pi, reach: float = 5.0) -> tuple[HouseVectorEnv, Seen]:
    envs = HouseVectorEnv([MAP], num_envs=2, targets="all", preset=configuration("own", 100))
    assert MAP.occupancy
    beams = round(2500 * field / 2 / math.pi)
    return envs, Seen(MAP.occupancy, envs.world.lattices[0], envs.config.body[0], 2, beams, field, reach)


@pytest.mark.parametrize("field", [2 * math.pi, 2.0])
def test_a_look_shows_what_points_along_its_beams_meet(field: float) -> None:
    envs, seen = envs_and_seen(field)
    envs.reset(seed=3)
    pose = envs.world.describe()[0].astype(float)
    seen.look(pose, np.array([True, False]))
    free = seen.grid.values == FREE
    expected = np.full(free.shape, UNSEEN)
    x, y = seen.cells(pose[:1, :2])[0]
    beams = round(2500 * field / 2 / math.pi)
    for beam in range(beams):
        angle = pose[0, 2] + field * ((beam + 0.5) / beams - 0.5)
        far = np.arange(0, 5.0 / seen.grid.cell, 0.001)
        columns = np.clip((x + far * math.cos(angle)).astype(int), 0, free.shape[1] - 1)
        rows = np.clip((y - far * math.sin(angle)).astype(int), 0, free.shape[0] - 1)  # all edges are closed
        end = int(np.argmin(free[rows, columns])) if not free[rows, columns].all() else len(far)
        expected[rows[:end], columns[:end]] = OPEN
        if end < len(far):
            expected[rows[end], columns[end]] = SHUT
    assert (expected == seen.known[0]).mean() > 0.99
    assert not ((seen.known[0] == OPEN) & ~free).any()
    assert (seen.known[1] == UNSEEN).all()


def test_ways_are_as_short_as_a_plain_search_finds_and_lead_there() -> None:
    envs, seen = envs_and_seen()
    envs.reset(seed=1)
    pose = envs.world.describe()[0].astype(float)
    seen.known[:] = np.where(seen.grid.values == FREE, OPEN, SHUT)
    goals = np.zeros((2, *seen.shape), bool)
    rows, columns = np.argwhere(seen.grid.values == FREE)[[5, -5]].T
    goals[[0, 1], rows, columns] = True
    half = envs.config.body[0] / 2 + 1e-4

    def stands(x: float, y: float) -> bool:
        corners = seen.cells(np.array([(x + a, y + b) for a in (-half, half) for b in (-half, half)]))
        west, north = np.floor(corners.min(axis=0)).astype(int)
        east, south = np.floor(corners.max(axis=0)).astype(int)
        return bool((seen.grid.values[north : south + 1, west : east + 1] == FREE).all())

    def place(e: int, node) -> np.ndarray:
        return pose[e, :2] + seen.pitch * np.array(node)

    def there(e: int, node) -> bool:
        column, row = seen.cells(place(e, node)).astype(int)
        return bool(goals[e, row, column])

    for e, way in enumerate(seen.ways(pose, goals, np.ones(2, bool))):
        reached, edge, steps = {(0, 0)}, [(0, 0)], 0
        while edge and not any(there(e, node) for node in edge):
            beyond = []
            for i, j in edge:
                for dx, dy in HEADINGS:
                    nodes = (i + dx, j), (i, j + dy), (i + dx, j + dy)
                    if nodes[2] not in reached and all(stands(*place(e, node)) for node in nodes):
                        reached.add(nodes[2])
                        beyond.append(nodes[2])
            edge, steps = beyond, steps + 1
        assert len(way) == (steps if edge else 0)
        node = np.sum([HEADINGS[h] for h in way], axis=0) if way else (0, 0)
        assert there(e, node) == bool(edge)


@pytest.mark.parametrize("sensor", ["laser", "own"])
def test_agents_see_most_of_a_small_map_and_walk_no_further_than_they_may(sensor: str) -> None:
    for agent in AGENTS:
        for walk in walks(FOUR, sensor, agent, 2, 0, 80.0, 1500):
            assert (np.diff(walk.metres) >= 0).all()
            assert (np.diff(walk.share) >= 0).all()
            assert walk.metres[-1] <= 80.2
            assert walk.share[-1] > 0.9, agent
            assert walk.share[0] < 0.6


def test_walks_repeat_and_begin_at_the_same_places_for_both_agents() -> None:
    first, again = (walks(FOUR, "laser", FRONTIER, 2, 4, 5.0, 200) for _ in range(2))
    others = walks(FOUR, "laser", AGENTS[0], 2, 4, 5.0, 200)
    for one, same, other in zip(first, again, others, strict=True):
        np.testing.assert_array_equal(one.way, same.way)
        np.testing.assert_array_equal(one.way[0], other.way[0])
        assert one.share[0] == other.share[0]


def test_the_area_is_the_mean_of_what_was_seen_and_lasts_after_a_stop() -> None:
    walk = Walk(np.array([0.0, 5.0]), np.array([0.0, 100.0]), np.array([0.2, 0.8]), np.zeros((2, 2)))
    assert walk.mean_share(10) == pytest.approx(0.5, abs=1e-3)
    assert walk.mean_share(100, "steps") == pytest.approx(0.2, abs=1e-3)
    assert walk.at(np.array([0.0, 4.9, 5.0, 99.0])).tolist() == [0.2, 0.2, 0.8, 0.8]


def test_the_study_writes_a_page_and_pictures_and_walks_once(tmp_path: Path, capsys) -> None:
    (path,) = export([MAP], tmp_path, "ros")
    study = Exploration((path,), coarser=1, sensors=("laser",), starts=2, metres=5, steps=200, out=tmp_path)
    study.run()
    page = (tmp_path / "exploration.md").read_text()
    assert "| house-0 | explorer |" in page
    assert page == capsys.readouterr().out.rstrip("\n") + "\n"
    assert {each.name for each in tmp_path.glob("*.png")} >= {"exploration.png", "exploration-ways.png"}
    kept = {each: each.stat().st_mtime_ns for each in tmp_path.glob("*.npz")}
    assert len(kept) == 2
    study.run()
    assert kept == {each: each.stat().st_mtime_ns for each in tmp_path.glob("*.npz")}


def test_what_is_no_map_is_said_in_a_line(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="name a map of ROS"):
        Exploration(out=tmp_path).run()
    (path,) = export([MAP], tmp_path, "ros")
    with pytest.raises(RequestError, match="no free cell"):
        Exploration((path,), coarser=100, out=tmp_path).run()
    with pytest.raises(RequestError, match=r"1\.0 m wide"):
        Exploration((path,), resolution=-1.0, out=tmp_path).run()
    with pytest.raises(RequestError, match="steps 1 to 8,000"):
        Exploration((path,), steps=9000, out=tmp_path).run()
