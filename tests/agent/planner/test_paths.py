"""Paths and advice, against exhaustive searches of small maps and the simulator's shortest paths."""

from typing import Any

import numpy as np
import torch

from tests.agent.planner.adapter import SIDE, UNKNOWN, Planner
from tests.agent.planner.brute_force import about, distances, fewest_actions, neighbours, small_map
from tests.agent.planner.conftest import E, Walk, ask
from tests.sample_houses import random_house
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner.paths import UNREACHED
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import FORWARD
from vitruvius.sim.oracle.oracle import Oracle


def planted(random: np.random.Generator, odd: bool) -> tuple[list[Any], list[Any], list[dict]]:
    """Small maps with a known target some nodes away: memories, poses, and the steps to it from each node."""
    memories, poses, ways = [], [], []
    while len(memories) < E:
        memory = small_map(random, solid=0.35, unit=1)
        nodes = memory.nodes
        (x, y), (i, j) = random.choice(sorted(nodes), 2, replace=False).tolist()
        if max(abs(x - i), abs(y - j)) > 4:
            ends = {(k, m) for k, m in nodes if abs(k - i) < 3 and abs(m - j) < 3}
            ways.append(distances(ends, lambda node, nodes=nodes: (to for _, to in neighbours(node, nodes))))
            px, py = 2 * np.array([x, y]) + odd * random.integers(-1, 2, 2)
            poses.append((int(px), int(py), int(random.integers(8))))
            memory.target = (i, j)
            memories.append(memory)
    return memories, poses, ways


def test_a_path_to_a_target_is_a_shortest_way_on_the_map(planner: Planner) -> None:
    """From nodes and from between them, and none where an exhaustive search finds none."""
    random, lengths = np.random.default_rng(0), []
    for odd in (False, False, True, True):
        memories, poses, ways = planted(random, odd)
        for (x, y, _), way, after in zip(poses, ways, ask(planner, memories, poses, known=1), strict=True):
            from_nodes = [
                2 * way[node] + max(abs(2 * node[0] - x), abs(2 * node[1] - y))
                for node in about(x, y)
                if node in way
            ]
            assert after.path == min(from_nodes, default=UNKNOWN)
            lengths.append(after.path)
    assert UNKNOWN in lengths
    assert max(set(lengths) - {UNKNOWN}) > 16


def test_a_body_that_follows_the_advice_goes_a_shortest_way_with_few_turns(planner: Planner) -> None:
    """Until it touches the target: half a node before the way's end."""
    random, taken, fewest = np.random.default_rng(1), 0, 0
    number, world = E, planner.tested.world
    rays = np.zeros((number, world.rays, world.channels), np.float32)
    rays[..., 0] = planner.tested.arrays["clear"].numpy().max() + 1e-3  # just room for a step forward
    for _ in range(3):
        memories, poses, ways = planted(random, odd=False)
        advice = np.array([after.advice for after in ask(planner, memories, poses, known=1)])
        steps, actions, going = np.zeros((3, number), int)
        going[:] = [after.path < UNKNOWN for after in (planner.memory(e) for e in range(number))]
        fewest += sum(
            fewest_actions(((x // 2, y // 2), h), {node for node in way if not way[node]}, memory.nodes) - 1
            for e, ((x, y, h), way, memory) in enumerate(zip(poses, ways, memories, strict=True))
            if going[e]
        )
        for _ in range(120):
            steps, actions = steps + going * (advice == FORWARD), actions + going
            for e in range(number):
                planner.write(e, time=301, new=0)  # so that rays are not swept
            no = np.zeros(number, bool)
            planner.step(rays, no, advice, no)
            advice = planner.array("advice")[:, 0].copy()
            going &= [planner.memory(e).known for e in range(number)]
        taken += actions.sum()
        for (x, y, _), way, went in zip(poses, ways, steps, strict=True):
            if (x // 2, y // 2) in way:
                assert went == 2 * way[x // 2, y // 2] - 1
    assert fewest <= taken <= 1.1 * fewest


def test_a_body_that_stands_at_a_known_target_without_touching_it_searches_again() -> None:
    """Since the last search the target turned out to lie a fraction of a cell aside, maybe behind a wall."""
    envs = make_envs([random_house(seed) for seed in range(6)], 6, "main")
    policy = Explorer(shield(envs), envs.config)
    policy.begin(6)
    observation, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(6, dtype=torch.bool)
    planner, checked = policy.tracker.planner, 0
    distance = planner.arrays["distance"].view().reshape(6, SIDE, SIDE)
    for _ in range(60):
        far, known = planner.read("path").numpy().copy(), planner.read("known").numpy() > 0
        away = known & (far > 30) & (far < UNREACHED)
        for e in np.flatnonzero(away):
            x, y, _ = planner.pose(int(e))
            near = [np.arange(int(at) - 2, int(at) + 4) % SIDE for at in (y, x)]
            distance[e][np.ix_(*near)] = 0  # as if the goal were at the body
        observation, _, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked = info["blocked"]
        on_node = (planner.read("x") | planner.read("y")).numpy() % 2 == 0
        still = away & on_node & (planner.read("known").numpy() > 0)
        assert (planner.read("path").numpy()[still] > 20).all()
        checked += still.sum()
    assert checked > 5


def test_a_viewpoint_stays_the_goal_until_it_is_reached_or_something_has_happened(walk: Walk) -> None:
    """Events that end a goal.

    The viewpoint is closed or out of reach, its candidate is seen, a target is known or picked up, or 32
    steps have passed.
    """
    kept, dropped = 0, 0
    for _, _, _, _, before, after in walk:
        if after.time > 1 and before.kind == "search":
            if after.kind == "search" and after.plan_age > 0:
                assert after.goal == before.goal
                kept += 1
            else:
                x, y = before.goal
                reached = any(before.distance[j % SIDE, i % SIDE] == 0 for i, j in about(after.x, after.y))
                happened = after.known or before.plan_age >= 32 or after.solid[y, x]
                dropped += 1
                assert (
                    happened
                    or before.path == UNKNOWN
                    or before.look < 0
                    or (reached and after.heading == before.look)
                )
    assert kept > 100
    assert dropped > 20


def test_mirrored_rays_and_actions_give_mirrored_advice(continuous: Walk) -> None:
    """Ties between two equally good ways are excepted."""
    advice = np.array([step.after.advice for step in continuous]).reshape(-1, E)
    agree = []
    for (observation, blocked, action, begun), expected in zip(continuous.inputs[:32], advice, strict=False):
        mirrored, flipped = (np.where(way == FORWARD, way, 1 - way) for way in (action, expected))
        continuous.planner.step(observation[:, ::-1].copy(), blocked, mirrored, begun)
        agree.append(flipped == continuous.planner.array("advice")[:, 0])
    assert np.mean(agree) > 0.9


def explored(envs: HouseVectorEnv, steps: int, seed: int) -> tuple[Explorer, np.ndarray, int]:
    """Return an explorer after some steps, with its rewards (T, E) and its number of collisions."""
    explorer, rewards, bumps = Explorer(shield(envs), envs.config), [], 0
    explorer.begin(envs.num_envs)
    observation, _ = envs.reset(seed=seed, options={"house": np.arange(envs.num_envs) % len(envs.houses)})
    blocked = np.zeros(envs.num_envs, bool)
    for _ in range(steps):
        actions = explorer(torch.as_tensor(observation), torch.as_tensor(blocked))
        observation, reward, _, _, info = envs.step(actions.numpy())
        rewards.append(reward)
        blocked, bumps = info["blocked"], bumps + info["blocked"].sum()
    return explorer, np.array(rewards), bumps


def test_an_explorer_on_a_grid_never_bumps(grid: Walk) -> None:
    explorer, rewards, bumps = explored(grid.envs, 600, seed=1)
    assert bumps == explorer.interventions == 0
    assert rewards.sum() >= 30


def test_an_explorer_finds_targets_behind_walls(continuous: Walk) -> None:
    """It finds far more than a walk that cannot see targets, in every house, and counts its pick-ups."""
    envs = make_envs([random_house(seed) for seed in range(6)], 6, "secondary")
    explorer, rewards, bumps = explored(envs, 1499, seed=0)
    truly, found = rewards.sum(0), explorer.tracker.planner.read("found").numpy()
    assert (truly >= 3).all()
    assert bumps <= rewards.size * 0.001
    assert np.abs(found - truly).sum() <= 0.1 * truly.sum()


def test_a_target_in_sight_is_reached_in_hardly_more_steps_than_it_takes() -> None:
    """The simulator's shortest paths, turns included, are as long in three quarters of the cases."""
    number = 80
    envs = make_envs([random_house(0)], number, "main")
    observation, _ = envs.reset(seed=1, options={"house": np.zeros(number, int)})
    sees, least = (
        observation[..., -1].any(-1),
        np.array([len(path) for path in Oracle(envs).paths() if path is not None]),
    )
    _, rewards, _ = explored(envs, 200, seed=1)
    over = (rewards.argmax(0) + 1 - least)[sees]
    assert len(over) > number / 5
    assert over.min() >= 0
    assert over.max() <= 6
    assert np.quantile(over, 0.75) <= 1
    assert over.mean() <= 0.8
