"""The map: odometry, what it holds against the true house, its ways, what it may depend on, its mirror."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from agent.actions import FORWARD, LEFT, RIGHT
from agent.avoidance import subsume
from agent.build import network_of
from agent.checkpoint import Checkpoint, load, save
from agent.config import PRESETS, PQNConfig
from agent.evaluation.episodes import play
from agent.planner import FEATURES, FREE, TAKEN, Planner, mirrored_features
from agent.planner.cells import FLAGS, SOLID, WAYS
from agent.planner.counts import KIND, NONE, STALE, THINK
from agent.planner.features import SCALARS, SIDES
from agent.planner.flood import UNASKED
from agent.planner.ways import FAR
from agent.policies import Explore, Explorer, QPolicy, Stack, Tracker, deferring
from agent.pqn import PQN
from agent.world import make_worlds, shield
from logic import Door, House, Piece, Rect, Room, generate
from logic.errors import RequestError
from sim import DEFAULT, HouseVectorEnv
from sim.grid.pack import STANDS, middle, pack
from sim.oracle import Oracle
from tests.agent.test_world import mirror
from tests.worlds import random_house

E = 6
STEPS = 200


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    """Seven furnished houses and the mirror image of the first."""
    torch.set_num_threads(1)
    houses = [random_house(seed) for seed in range(E - 1)]
    return make_worlds([*houses, mirror(houses[0])], E, "mixed")


def walked(
    envs: HouseVectorEnv, maps: Planner, steps: int, options: dict[str, Any] | None = None, seed: int = 0
) -> list[dict[str, np.ndarray]]:
    """Infos of a walk: the maps' advice, and at random for a fifth of the time, under the shield."""
    number, layer = envs.num_envs, shield(envs)
    observation, info = envs.reset(seed=0, options=options or {"house": np.arange(number)})
    chance = torch.Generator().manual_seed(seed)
    seen, blocked = torch.as_tensor(observation), torch.zeros(number, dtype=torch.bool)
    action, fresh, infos = torch.zeros(number, dtype=torch.int64), torch.ones(number).bool(), [info]
    for _ in range(steps):
        maps.step(seen, blocked, action, fresh)
        fresh = torch.zeros(number).bool()
        # Chance is drawn for one environment, so that a walk does not depend on their number.
        preference = torch.nn.functional.one_hot(maps.advice, 3).float()
        if torch.rand((), generator=chance) < 0.2:
            preference += 2 * torch.rand(3, generator=chance)
        action = subsume(preference, layer(seen, blocked))
        observation, _, _, _, info = envs.step(action.numpy())
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])
        infos.append(info)
    maps.step(seen, blocked, action, fresh)
    return infos


def in_house(maps: Planner, e: int, start: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Points (n, 2) in cells of a map's frame as metres in the house, by the pose where the episode began."""
    octant = round(start[2] / (np.pi / 4)) % 8
    turn = (octant - octant % 2) * np.pi / 4
    x, y = points.T * maps.cell
    east, south = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    return np.stack([start[0] + east, start[1] + south], axis=-1)


def test_the_map_knows_where_the_body_is(envs):
    maps = Planner(DEFAULT, E)
    infos = walked(envs, maps, STEPS)
    for e in range(E):
        x, y, heading = maps.pose(e)
        start, end = infos[0]["pose"][e], infos[-1]["pose"][e]
        np.testing.assert_allclose(in_house(maps, e, start, np.array([[x, y]]))[0], end[:2], atol=1e-4)
        turned = round((end[2] - start[2]) / (np.pi / 4))
        assert (heading - turned - round(start[2] / (np.pi / 4)) % 2) % 8 == 0


def test_what_is_free_on_the_map_is_floor_and_what_is_taken_holds_a_wall_or_a_piece(envs):
    maps = Planner(DEFAULT, E)
    infos = walked(envs, maps, STEPS)
    for e in range(E):
        sides, cells = _sides(envs.houses[e]), maps.occupancy(e)
        off = {}
        for state in (FREE, TAKEN):
            south, east = np.nonzero(cells == state)
            middles = np.column_stack([east, south]) - 128 + 0.5
            at = in_house(maps, e, infos[0]["pose"][e], middles)[:, None]
            away = np.abs(at - np.clip(at, sides[:, :2], sides[:, 2:])).max(-1)
            off[state] = away.min(-1) / maps.cell
        # Every wall is in its cell or within a centimetre of it; hardly a free cell has one in its midst.
        assert (off[TAKEN] < 0.5 + 0.08).all()
        assert len(off[FREE]) > 500
        assert (off[FREE] < 0.4).mean() < 0.02


def _sides(house: House) -> np.ndarray:
    """Sides (n, 4) of rooms and pieces, doors included: west, north, east, south ends."""
    boxes = [house.floor.box, *(room.box for room in house.rooms)]
    boxes += [piece.box for room in house.rooms for piece in room.pieces]
    w, n, e, s = np.array(boxes).T
    return np.concatenate(
        [np.stack(side, 1) for side in ((w, n, e, n), (w, s, e, s), (w, n, w, s), (e, n, e, s))]
    )


def test_ways_are_as_long_as_a_graph_of_the_same_cells_has_them(envs):
    """Against SciPy's Dijkstra: a diagonal step is as long as a straight one, and needs both corners."""
    maps, checked = Planner(DEFAULT, E), 0
    for steps in (30, 50, 70, 90, 110):
        walked(envs, maps, steps)
        for e in range(E):
            if maps._counts[e, STALE] or maps._counts[e, KIND] == NONE:
                continue  # the map has grown since its ways were measured
            taken, ways = maps.occupancy(e) == TAKEN, maps.ways(e)
            free = ~taken
            for down, right in ((0, 1), (1, 0), (1, 1)):
                free &= ~np.roll(taken, (down, right), axis=(0, 1))
            true = _distances(free, np.flatnonzero((ways == 0) & free))
            x, y, _ = maps.pose(e)
            here = (int(y) + 128, int(x) + 128)
            if x % 1 == y % 1 == 0 and ways[here] < FAR:
                assert ways[here] == true[here]
                checked += 1
            # What a search leaves aside, far from all short ways, can only make others longer.
            assert (ways[(ways < FAR) & free] >= true[(ways < FAR) & free]).all()
    assert checked >= E


def _distances(free: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """Nodes from the nearest source, where nodes that are not free are in nobody's way but their own."""
    number = np.arange(free.size).reshape(free.shape)
    pairs = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        one, other = (
            (slice(0, 256 - down), slice(max(0, -right), 256 - max(0, right))),
            (slice(down, 256), slice(max(0, right), 256 + min(0, right))),
        )
        both = free[one] & free[other]
        if down and right:
            both &= free[other[0], one[1]] & free[one[0], other[1]]
        pairs.append(np.stack([number[one][both], number[other][both]]))
    rows, columns = np.concatenate(pairs, axis=1)
    graph = csr_array((np.ones(len(rows)), (rows, columns)), shape=(free.size, free.size))
    away = dijkstra(graph, directed=False, unweighted=True, indices=sources, min_only=True)
    return away.reshape(free.shape)


def test_what_was_never_seen_is_not_in_the_map():
    """A room in the east that the body never turns to: small and empty, or large and furnished."""
    memories = []
    table = Piece(8.5, 1.0, 0.5, 0.5, type="table")
    for depth, pieces in ((2.0, ()), (3.5, (table,))):
        hidden = Room(6.0, 0.5, depth, 2.5, "hall", pieces, Door(6.0, 1.0, 0.0, 0.762))
        near = Room(0.0, 4.0, 4.0, 3.0, "hall", (), Door(1.0, 4.0, 0.762, 0.0))
        worlds = make_worlds([House(Rect(0, 0, 6.0, 4.0), (near, hidden))], 1, "main")
        options = {"house": [0], "pose": [[3.0, 2.0, np.pi]], "target": [[0.6, 0.6]]}
        observation, _ = worlds.reset(seed=0, options=options)
        maps, blocked, fresh = Planner(worlds.config, 1), torch.zeros(1).bool(), torch.ones(1).bool()
        action = torch.tensor([LEFT])
        for turn in [LEFT, RIGHT, FORWARD, FORWARD, RIGHT, FORWARD, LEFT] * 4:
            maps.step(torch.as_tensor(observation), blocked, action, fresh)
            action, fresh = torch.tensor([turn]), torch.zeros(1).bool()
            observation, _, _, _, info = worlds.step(action.numpy())
            blocked = torch.as_tensor(info["blocked"])
        memories.append([array.numpy() for array in maps.arrays.values()])
    for one, other in zip(*memories, strict=True):
        assert np.array_equal(one, other)


def test_a_map_does_not_depend_on_the_others_of_its_batch(envs):
    together = Planner(DEFAULT, E)
    walked(envs, together, 100)
    alone = make_worlds([envs.houses[0]], 1, "mixed")
    maps = Planner(DEFAULT, 1)
    walked(alone, maps, 100)
    assert torch.equal(maps.features[0], together.features[0])
    assert np.array_equal(maps.occupancy(0), together.occupancy(0))


def test_a_new_episode_begins_with_an_empty_map(envs):
    maps, twice = Planner(DEFAULT, E), Planner(DEFAULT, E)
    walked(envs, twice, 50, seed=1)
    for one in (maps, twice):
        walked(envs, one, 50)
    assert torch.equal(maps.features, twice.features)
    assert np.array_equal(maps.arrays["cells"].numpy(), twice.arrays["cells"].numpy())


def test_features_of_the_mirror_are_the_mirrors_features():
    """Rays and actions exchanged left for right, from a straight and a diagonal start; the advice may differ
    where two ways are equally long, and with it which goal is taken.
    """
    house = random_house(0)
    worlds = make_worlds([house], 2, "mixed")
    for heading in (0.0, np.pi / 4):
        start = worlds.reset(seed=3)[1]["pose"][0]
        options = {"house": [0, 0], "pose": [[*start[:2], heading]] * 2}
        observation, _ = worlds.reset(seed=0, options=options)
        one, other = Planner(DEFAULT, 1), Planner(DEFAULT, 1)
        no, fresh, action = torch.zeros(1).bool(), torch.ones(1).bool(), torch.tensor([LEFT])
        agree = []
        blocked = no
        for turn in [LEFT, FORWARD, FORWARD, RIGHT, FORWARD, LEFT, LEFT, FORWARD] * 4:
            seen = torch.as_tensor(observation[:1])
            flipped = torch.where(action == FORWARD, action, RIGHT - action)
            one.step(seen, blocked, action, fresh)
            other.step(seen.flip(1), blocked, flipped, fresh)
            agree.append((mirrored_features(one.features) - other.features).abs() < 1e-4)
            assert abs((one.occupancy(0) > 0).sum() / (other.occupancy(0) > 0).sum() - 1) < 0.03
            action, fresh = torch.tensor([turn]), no
            observation, _, _, _, info = worlds.step(np.array([turn, turn]))
            blocked = torch.as_tensor(info["blocked"][:1])
        assert torch.cat(agree).float().mean() > 0.9
    features = torch.rand(3, FEATURES)
    assert torch.equal(mirrored_features(mirrored_features(features)), features)


@pytest.fixture(scope="module")
def gridded() -> HouseVectorEnv:
    """Houses whose edges lie on a grid, in whose cells bodies stand."""
    houses = list(generate(3, seed=5, count=2, cell=0.3))
    return make_worlds(houses, len(houses), "mixed", backend="grid")


def ways_of(worlds: HouseVectorEnv, house: House, at: np.ndarray) -> np.ndarray:
    """What bodies can do at places (n, 2) m, by the backend: a bit for each heading, and ``STANDS``."""
    bank = pack([house], worlds.config)
    known = bank.indices.numpy()
    first, columns, rows = known[:3]
    table = known[first : first + columns * rows].reshape(rows, columns)
    place = (at - middle(bank.geometries[0], worlds.config.step)) / worlds.config.step
    column, row = np.rint(place).astype(int).T
    return table[row, column]


def test_walls_are_lines_to_bodies_that_fill_cells(gridded):
    """Between two cells that were seen there is a wall on the map only if there is one in the house, and
    nearly always if there is.
    """
    maps = Planner(gridded.config, gridded.num_envs)
    infos = walked(gridded, maps, 1000)
    nodes = 2 * np.stack(np.meshgrid(range(-60, 60), range(-60, 60)), axis=-1).reshape(-1, 2)
    agree = []
    for e, house in enumerate(gridded.houses):
        start = infos[0]["pose"][e]
        cells = maps.arrays["cells"].view().reshape(-1, 256, 256)[e]
        turn = (round(start[2] / (np.pi / 4)) % 8) // 2 * 2
        for heading in range(0, 8, 2):
            way = np.array(WAYS[heading])
            about = [way * k - (i, j) for k in (0, 2) for i in (0, 1) for j in (0, 1)]
            seen = [cells[nodes[:, 1] + y, nodes[:, 0] + x] >> FLAGS > 0 for x, y in about]
            there = nodes[np.all(seen, axis=0)]
            ways = ways_of(gridded, house, in_house(maps, e, start, there))
            open_, stands = ways >> ((heading + turn) % 8) & 1 == 1, ways >> STANDS & 1 == 1
            solid = [cells[there[:, 1] + way[1] * k, there[:, 0] + way[0] * k] & SOLID for k in (0, 1, 2)]
            free = ~np.any(solid, axis=0)
            assert stands.sum() > 300
            assert free[open_].all()
            agree.append((free == open_)[stands])
    assert np.concatenate(agree).mean() > 0.99


class Twins:
    """A map, and one that is told before each step that there are news everywhere: it finds all anew."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        self.kept, self.anew = Planner(envs.config, envs.num_envs), Planner(envs.config, envs.num_envs)
        self.asked = 0

    def step(self, *inputs: torch.Tensor) -> None:
        self.anew.arrays["news"].view()[:] = 1
        self.kept.step(*inputs)
        self.anew.step(*inputs)
        assert torch.equal(self.kept._counts, self.anew._counts)
        assert np.array_equal(self.kept.arrays["shown"].view(), self.anew.arrays["shown"].view())
        self.asked += int((self.kept._counts[:, THINK] == 0).sum())

    @property
    def advice(self) -> torch.Tensor:
        return self.kept.advice


@pytest.mark.parametrize("kind", ["envs", "gridded"])
def test_what_a_map_keeps_of_tiles_is_what_it_would_find_anew(kind, request):
    """Views, goals and ways: whatever is seen, closed or cleared is news where it matters."""
    envs = request.getfixturevalue(kind)
    twins = Twins(envs)
    walked(envs, twins, 700)  # pyright: ignore[reportArgumentType]
    assert twins.asked > 20 * envs.num_envs
    guesses = twins.kept.arrays["guesses"].view()
    assert (guesses < UNASKED).sum() > 100 * envs.num_envs


def test_what_a_body_that_fills_a_cell_can_do_is_what_its_map_says(gridded):
    """At all eight headings, of which the rays show three or so at a time; and it never bumps."""
    explorer = Explorer(shield(gridded), gridded.config)
    observation, info = gridded.reset(seed=1, options={"house": np.arange(gridded.num_envs)})
    seen, blocked = torch.as_tensor(observation), torch.zeros(gridded.num_envs).bool()
    explorer.begin(gridded.num_envs)
    agree, bumps, found = [], 0, 0
    for _ in range(600):
        poses = info["pose"]
        action = explorer(seen, blocked).numpy()
        free = explorer.tracker.planner.features[:, SCALARS:].view(-1, 8, SIDES)[..., 0].numpy() > 0
        for e, house in enumerate(gridded.houses):
            headings = (round(poses[e, 2] / (np.pi / 4)) + np.arange(8)) % 8
            agree.append(free[e] == (ways_of(gridded, house, poses[e : e + 1, :2]) >> headings & 1 == 1))
        observation, reward, _, _, info = gridded.step(action)
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])
        bumps, found = bumps + info["blocked"].sum(), found + reward.sum()
    assert np.mean(agree) > 0.995
    assert bumps == explorer.interventions == 0
    assert found >= 30


def test_the_explorer_finds_targets_behind_walls(envs):
    """Far more than a target-blind walk, in every house; and the map knows how many it picked up."""
    worlds = make_worlds(envs.houses, E, "secondary")
    explorer = Explorer(shield(worlds), worlds.config)
    score = play(worlds, explorer, seed=0)
    assert (score.targets >= 3).all()
    assert score.blocked <= score.steps * 0.001
    found = explorer.tracker.planner.found.numpy()
    assert np.abs(found - score.targets).sum() <= 0.1 * score.targets.sum()


def test_a_target_in_sight_is_reached_in_hardly_more_steps_than_it_takes():
    """Against the oracle, turns and all: in three quarters of cases in just as many."""
    number = 160
    worlds = make_worlds([random_house(0)], number, "main")
    observation, _ = worlds.reset(seed=1)
    sees = observation[..., -1].any(-1)
    least = np.array([len(path) for path in Oracle(worlds).paths() if path is not None])
    assert len(least) == number
    explorer, taken = Explorer(shield(worlds), worlds.config), np.zeros(number, int)
    explorer.begin(number)
    seen, blocked = torch.as_tensor(observation), torch.zeros(number).bool()
    for step in range(1, 200):
        observation, reward, _, _, info = worlds.step(explorer(seen, blocked).numpy())
        taken = np.where((reward > 0) & (taken == 0), step, taken)
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])
    over = (taken - least)[sees]
    assert len(over) > number / 5
    assert (over >= 0).all()
    assert over.max() <= 6
    assert np.quantile(over, 0.75) <= 1
    assert over.mean() <= 0.8


def test_behaviours_stack_avoid_over_explore_over_network(envs):
    """While no target is known the map decides, then the network does; the shield overrules both."""
    network, tracker, layer = network_of(PQNConfig()), Tracker(envs.config), shield(envs)
    stacked = QPolicy(
        *(network, Stack(layer, Explore(tracker)), torch.Generator().manual_seed(0)),
        epsilon=0.0,
        tracker=tracker,
    )
    seen, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(E).bool()
    stacked.begin(E)
    sought = 0
    for _ in range(150):
        remembered = stacked.remembered
        actions, seeks = stacked(seen, blocked), tracker.planner.seeks
        with torch.no_grad():
            alone = subsume(network(seen, remembered), layer(seen, blocked))
        assert torch.equal(actions, torch.where(seeks, tracker.planner.advice, alone))
        sought += int(seeks.sum())
        observation, _, _, _, info = envs.step(actions.numpy())
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])
    assert 0 < sought < 150 * E


def test_a_layer_that_wants_what_is_forbidden_is_not_heard():
    def only(*actions: int) -> Any:
        wanted = torch.tensor([[action in actions for action in range(3)]])
        return lambda observation, blocked: wanted

    scene, no = torch.zeros(1, 40, 2), torch.zeros(1).bool()
    assert Stack(only(LEFT, RIGHT), only(FORWARD))(scene, no).tolist() == [[True, True, False]]
    assert Stack(only(LEFT, RIGHT), only(FORWARD, LEFT))(scene, no).tolist() == [[True, False, False]]
    assert Stack(only(LEFT, RIGHT), only(RIGHT), only(LEFT))(scene, no).tolist() == [[False, True, False]]


def test_a_network_defers_to_the_map_where_actions_are_worth_the_same():
    q = torch.tensor([[0.5, 0.55, 0.5], [0.5, 0.7, 0.5]])
    advice = torch.tensor([FORWARD, FORWARD])
    assert deferring(q, advice).argmax(-1).tolist() == [FORWARD, RIGHT]


def test_a_new_network_with_a_map_does_what_it_advises(envs):
    policy = QPolicy(network_of(PQNConfig(map=True)), shield(envs), torch.Generator(), epsilon=0.0)
    seen, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(E).bool()
    policy.begin(E)
    for _ in range(50):
        actions = policy(seen, blocked)
        assert policy.tracker
        assert torch.equal(actions, policy.tracker.planner.advice)
        observation, _, _, _, info = envs.step(actions.numpy())
        seen, blocked = torch.as_tensor(observation), torch.as_tensor(info["blocked"])


def test_a_checkpoint_keeps_a_network_with_a_map(tmp_path):
    network = network_of(PQNConfig(map=True))
    torch.nn.init.normal_(next(network.judge[-1].parameters()))
    save(Checkpoint(network, PRESETS["pqn-map"], steps=1), tmp_path / "agent.safetensors")
    found = load(tmp_path / "agent.safetensors")
    given = torch.rand(2, 40, 2), torch.rand(2, 4, 6), torch.rand(2, FEATURES)
    assert found.config == PRESETS["pqn-map"]
    assert torch.equal(found.network(*given), network(*given))


def test_novelty_and_guidance_need_a_map():
    for name in ("novelty", "guided"):
        with pytest.raises(ValueError, match="need map"):
            replace(PQNConfig(), **{name: 0.5})


def test_learning_with_a_map_is_a_function_of_the_seed(envs):
    config = PQNConfig(map=True, novelty=0.02, guided=0.5, environments=E, rollout=8, steps=200)

    def trained() -> dict[str, torch.Tensor]:
        learner = PQN(config, envs)
        speed = [now.map for now in learner.train()][-1]
        assert speed is not None
        assert speed > 0
        return learner.network.state_dict()

    one, same = trained(), trained()
    assert all(torch.equal(one[name], same[name]) for name in one)


def test_episodes_longer_than_a_cell_can_tell_are_refused():
    with pytest.raises(ValueError, match="8,18"):
        Planner(replace(DEFAULT, steps=20_000), 1)


@pytest.mark.parametrize("slant", [0, 1])
def test_a_map_begun_where_no_wall_is_in_sight_is_begun_again_at_the_first_wall(slant):
    """In the midst of a hall of 20 m, straight and diagonal."""
    house = House(
        Rect(0, 0, 20.0, 20.0), (Room(0.0, 20.0, 4.0, 3.0, "hall", (), Door(1.0, 20.0, 0.762, 0.0)),)
    )
    worlds = make_worlds([house], 1, "main")
    options = {"house": [0], "pose": [[10.0, 10.0, slant * np.pi / 4]], "target": [[2.0, 18.0]]}
    observation, _ = worlds.reset(seed=0, options=options)
    maps, no = Planner(worlds.config, 1), torch.zeros(1).bool()
    assert (observation[..., 0] == 1.0).all()
    maps.step(torch.as_tensor(observation), no, torch.tensor([LEFT]), ~no)
    for turn in [RIGHT, LEFT] + [FORWARD] * 60:
        observation, _, _, _, info = worlds.step(np.array([turn]))
        maps.step(torch.as_tensor(observation), torch.as_tensor(info["blocked"]), torch.tensor([turn]), no)
    assert maps.pose(0)[2] % 2 == slant
    assert (maps.occupancy(0) == TAKEN).sum() > 20


def test_maps_of_another_revision_are_refused_before_anything_is_taken_up():
    maps = Planner(DEFAULT, 1)
    before = maps.state
    with pytest.raises(RequestError, match="another revision"):
        maps.state = {name: torch.ones_like(value) for name, value in before.items() if name != "shown"}
    assert all(torch.equal(value, before[name]) for name, value in maps.state.items())
