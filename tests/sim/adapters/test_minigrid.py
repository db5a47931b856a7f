"""Houses on a grid in MiniGrid: its paths equal ours, and its checks and wrappers accept them."""

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from minigrid.core.constants import DIR_TO_VEC
from minigrid.wrappers import FlatObsWrapper, FullyObsWrapper, ImgObsWrapper

from tests.sim.backends import test_grid
from tests.sim.backends.test_fit import made_for
from tests.sim.backends.test_grid import CELL
from tests.thick import thickened
from vitruvius.logic import Door, House, Piece, Room, Window
from vitruvius.sim import HouseEnv
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.adapters.minigrid import MiniGridHouseEnv, Tile, tile
from vitruvius.sim.backends.grid.cells import Cells

LEFT, RIGHT, FORWARD, PICK_UP, TOGGLE = 0, 1, 2, 3, 5
"""Actions of MiniGrid, with the numbers of its documentation."""


def cells(x: float, y: float, width: float, height: float) -> tuple[float, float, float, float]:
    """Return a rectangle, given in cells, in metres."""
    return x * CELL, y * CELL, width * CELL, height * CELL


HOME = House(
    rooms=(
        Room(*cells(0, 0, 9, 3), name="R0", type="hall"),
        Room(
            *cells(0, 3, 5, 6), name="R1", type="living", children=(Piece(*cells(0, 6, 2, 3), type="sofa"),)
        ),
        Room(
            *cells(5, 3, 4, 6), name="R2", type="bedroom", children=(Piece(*cells(7, 5, 2, 2), type="bed"),)
        ),
    ),
    doors=(
        Door(*cells(4, 0, 2, 0), between=("R0", "outside")),
        Door(*cells(1, 3, 2, 0), between=("R0", "R1")),
        Door(*cells(5, 6, 0, 2), between=("R1", "R2")),
    ),
    windows=(Window(*cells(0, 4, 0, 2), room="R1"),),
    hub="R0",
    topology="ring",
)
THICK = thickened(HOME, CELL, 2 * CELL)
HOUSES = [made_for(CELL, house) for house in (*test_grid.HOUSES, HOME, THICK)]
EACH_HOUSE = pytest.mark.parametrize("number", range(len(HOUSES)))


def made(**arguments: Any) -> MiniGridHouseEnv:
    """Return the environment without the wrappers of ``gymnasium.make``."""
    env = gymnasium.make("Vitruvius/MiniGrid-v0", houses=HOUSES, targets="all", **arguments).unwrapped
    assert isinstance(env, MiniGridHouseEnv)
    return env


@pytest.fixture(scope="module")
def env() -> MiniGridHouseEnv:
    return made()


def open_to(env: MiniGridHouseEnv, place: Tile) -> bool:
    """Return True if MiniGrid's agent can be on a tile."""
    found = env.grid.get(*place)
    return found is None or found.can_overlap()


def front(env: MiniGridHouseEnv) -> Tile:
    """Return the tile in front of MiniGrid's agent."""
    x, y = env.front_pos
    return int(x), int(y)


def kind(env: MiniGridHouseEnv, place: Tile) -> str:
    """Return the type of MiniGrid's object on a tile, or an empty text."""
    found = env.grid.get(*place)
    return found.type if found else ""


def shortest_actions(env: MiniGridHouseEnv, turns_anywhere: bool = True) -> list[int]:
    """Return the fewest actions to the goal, by breadth-first search in MiniGrid's grid only.

    Without ``turns_anywhere``, paths turn only in tiles of cells.
    """

    def following(state: tuple[int, int, int]) -> Iterator[tuple[int, tuple[int, int, int]]]:
        x, y, way = state
        if turns_anywhere or (x % 2 and y % 2):
            yield from ((LEFT, (x, y, (way - 1) % 4)), (RIGHT, (x, y, (way + 1) % 4)))
        dx, dy = DIR_TO_VEC[way].tolist()
        if open_to(env, (x + dx, y + dy)):
            yield FORWARD, (x + dx, y + dy, way)

    x, y = env.agent_pos
    begin = int(x), int(y), int(env.agent_dir)
    paths: dict[tuple[int, int, int], list[int]] = {begin: []}
    queue = deque([begin])
    while queue:
        state = queue.popleft()
        if kind(env, state[:2]) == "goal":
            return paths[state]
        for action, other in following(state):
            if other not in paths:
                paths[other] = [*paths[state], action]
                queue.append(other)
    return []


def steps_from(start: Tile, neighbours: Callable[[int, int], Iterable[Tile]]) -> dict[Tile, int]:
    """Return the fewest steps from a place to each reachable place."""
    steps, queue = {start: 0}, deque([start])
    while queue:
        place = queue.popleft()
        for other in neighbours(*place):
            if other not in steps:
                steps[other] = steps[place] + 1
                queue.append(other)
    return steps


@EACH_HOUSE
def test_every_cell_is_twice_as_many_tiles_away_as_steps_of_our_grid(
    env: MiniGridHouseEnv, number: int
) -> None:
    """Distances along the axes in MiniGrid equal twice the steps that the simulator's table allows."""
    _, info = env.reset(seed=number, options={"house": number})
    house = Cells(env.envs.geometries[number], CELL)

    def ours(i: int, j: int) -> Iterator[Tile]:
        for heading in (0, 2, 4, 6):
            if house.moves[i, j] >> heading & 1:
                yield i + HEADINGS[heading][0], j + HEADINGS[heading][1]

    def theirs(x: int, y: int) -> Iterator[Tile]:
        yield from ((x + dx, y + dy) for dx, dy in np.array(DIR_TO_VEC) if open_to(env, (x + dx, y + dy)))

    x, y = start = tile(house, info["pose"][:2])
    assert start == env.agent_pos
    in_steps = {(2 * i + 1, 2 * j + 1): 2 * n for (i, j), n in steps_from((x // 2, y // 2), ours).items()}
    in_tiles = {place: n for place, n in steps_from(start, theirs).items() if place[0] % 2 and place[1] % 2}
    assert in_tiles == in_steps
    assert len(in_tiles) == house.stands.sum() > 20


@EACH_HOUSE
def test_a_shortest_path_found_in_minigrid_leads_to_its_goal_and_to_our_target(
    env: MiniGridHouseEnv, number: int
) -> None:
    """A quarter turn is two turns here, and two steps are one."""
    ours = HouseEnv(HOUSES, backend="grid", targets="all")
    for seed in range(4):
        _, there = env.reset(seed=seed, options={"house": number})
        _, here = ours.reset(seed=seed, options={"house": number})
        np.testing.assert_array_equal(there["pose"], here["pose"])
        np.testing.assert_array_equal(there["target"], here["target"])
        actions = shortest_actions(env, turns_anywhere=False)
        assert len(actions) == len(shortest_actions(env))
        ends = [env.step(action)[1:3] for action in actions]
        assert [ended for _, ended in ends] == [False] * (len(actions) - 1) + [True]
        assert ends[-1][0] == pytest.approx(1 - 0.9 * len(actions) / env.max_steps)
        between_axes = round(here["pose"][2] / (np.pi / 4)) % 2
        driven = [RIGHT] * between_axes
        driven += [each for action in actions for each in ([action] if action == FORWARD else [action] * 2)]
        forwards = iter(range(len(driven)))
        steps = [ours.step(each) for each in driven if each != FORWARD or next(forwards) % 2 == 0]
        assert not any(info["blocked"] for *_, info in steps)
        assert sum(reward for _, reward, *_ in steps) >= 1


def test_doors_are_minigrids_and_furniture_stays_where_it_is() -> None:
    """Doors between rooms are shut here and opened by ``toggle``; the entrance is locked, without a key."""
    env = made(doors_open=False)
    options = {"house": 2, "pose": [*cells(1.5, 2.5, 0, 0)[:2], 0.0], "target": cells(2.5, 4.5, 0, 0)[:2]}
    env.reset(seed=0, options=options)
    kinds = Counter((each.type, each.color) for each in env.grid.grid if each)
    assert kinds["door", "yellow"] == 9  # two cells each, and the corner between them
    assert shortest_actions(env) == []
    assert [kind(env, (x, 0)) for x in range(8, 13)] == ["wall", "door", "door", "door", "wall"]
    for action in (RIGHT, TOGGLE):
        env.step(action)
    assert len(shortest_actions(env)) == 7
    env.reset(seed=0, options=options | {"pose": [*cells(4.5, 0.5, 0, 0)[:2], np.pi / 2]})
    env.step(TOGGLE)
    assert not open_to(env, front(env))
    env.reset(seed=0, options=options | {"pose": [*cells(1.5, 5.5, 0, 0)[:2], -np.pi / 2]})
    before = env.grid.encode()
    for action in (FORWARD, PICK_UP, TOGGLE):
        env.step(action)
    env.step(FORWARD)
    assert kind(env, front(env)) == "box"
    np.testing.assert_array_equal(env.grid.encode(), before)


@pytest.mark.filterwarnings("ignore:The system font")
def test_gymnasiums_checker_and_minigrids_wrappers_take_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = made(render_mode="rgb_array")
    check_env(env)
    env.reset(seed=0)
    assert np.asarray(env.render()).shape == (env.height * 32, env.width * 32, 3)
    for wrapper, shape in (
        (ImgObsWrapper, (7, 7, 3)),
        (FlatObsWrapper, (2835,)),
        (lambda each: ImgObsWrapper(FullyObsWrapper(each)), (env.width, env.height, 3)),
    ):
        wrapped = wrapper(env)
        observation, _ = wrapped.reset(seed=1)
        assert observation.shape == shape
        assert wrapped.observation_space.contains(observation)


def test_houses_off_the_grid_and_targets_in_no_cell_are_refused() -> None:
    with pytest.raises(ValueError, match="no grid with cells as wide as the robot,"):
        gymnasium.make("Vitruvius/MiniGrid-v0", houses="paper-house")
    with pytest.raises(ValueError, match=r"house 2: the target at \(0.225, 3.825\) m is not in a free cell"):
        made().reset(seed=0, options={"house": 2, "target": cells(0.5, 8.5, 0, 0)[:2]})
