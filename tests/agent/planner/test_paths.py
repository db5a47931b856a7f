"""Paths and advice, against the NumPy reference and the simulator's shortest paths."""

import numpy as np
import torch

from agent.learning.environments import make_envs, shield
from agent.planner.paths import FAR
from agent.policies.policies import Explorer
from sim import HouseVectorEnv
from sim.actions import FORWARD, LEFT, RIGHT
from sim.baselines.oracle import Oracle
from tests.agent.planner import planning
from tests.agent.planner.adapter import UNKNOWN
from tests.agent.planner.conftest import E, Step, Walk
from tests.agent.planner.reference import SIDE
from tests.agent.planner.test_occupancy import abilities
from tests.sample_houses import random_house


def test_paths_are_as_short_as_a_breadth_first_search_finds(walk: Walk) -> None:
    """From the body, where the search has just been made; and all nodes' distances are those of some path."""
    body, checked = walk.body, 0
    for e, _, _, _, _, after in walk:
        far = planning.away(after.distance, after.x, after.y)
        assert after.path == (UNKNOWN if far is None else far)
        if e % 2 == 0 and after.kind != "none" and after.path_age == 0:
            zero = after.distance == 0
            assert not zero.any() or any(np.array_equal(zero, ends) for ends in planning.sources(body, after))
            true = planning.distances(after, zero, int(after.distance.max()) + 1)
            assert far == planning.away(true, after.x, after.y)
            assert (after.distance >= true)[after.distance >= 0].all()
            checked += 1
    assert checked > 30


def test_a_body_that_stands_at_a_known_target_without_touching_it_searches_again() -> None:
    """The target turned out to lie a part of a cell aside since the last search, maybe behind a wall."""
    envs = make_envs([random_house(seed) for seed in range(6)], 6, "main")
    policy = Explorer(shield(envs), envs.config)
    policy.begin(6)
    observation, blocked = torch.as_tensor(envs.reset(seed=0)[0]), torch.zeros(6, dtype=torch.bool)
    planner, checked = policy.tracker.planner, 0
    distance = planner.arrays["distance"].view().reshape(6, SIDE, SIDE)
    for _ in range(60):
        far, known = planner.read("path").numpy().copy(), planner.read("known").numpy() > 0
        away = known & (far > 30) & (far < FAR)
        for e in np.flatnonzero(away):
            x, y, _ = planner.pose(int(e))
            near = [np.arange(int(at) - 2, int(at) + 4) % SIDE for at in (y, x)]
            distance[e][np.ix_(*near)] = 0  # as if the goal were where it stands
        observation, _, _, _, info = envs.step_torch(policy(observation, blocked))
        blocked = info["blocked"]
        on_node = (planner.read("x") | planner.read("y")).numpy() % 2 == 0
        still = away & on_node & (planner.read("known").numpy() > 0)
        assert (planner.read("path").numpy()[still] > 20).all()
        checked += still.sum()
    assert checked > 5


def test_a_goal_is_kept_until_something_is_reached_or_changed(walk: Walk) -> None:
    """A viewpoint stays the goal until it is reached, its candidate is seen, it is closed or out of reach,
    a target is known or picked up, or 32 steps have gone by.
    """
    kept = 0
    for _, _, _, _, before, after in walk:
        if after.time > 1 and before.kind == "search" and (after.kind != "search" or after.plan_age == 0):
            x, y = before.goal
            reasons = [
                after.known,
                before.known,
                before.plan_age >= 32,
                after.solid[y, x],
                before.path == UNKNOWN,
            ]
            at = planning.away(before.distance, after.x, after.y)
            reasons += [at is None, at == 0 and after.heading == before.look]
            if before.look < 0:
                reasons.append(not planning.hides(after, before.since)[y // 2, x // 2])
            assert any(reasons)
        elif after.time > 1 and before.kind == "search":
            assert after.goal == before.goal
            kept += 1
    assert kept > 100


def forward(walk: Walk, step: Step) -> bool:
    """Whether rays and bump let the body go on."""
    return walk.body.may_go(step.observation, step.after.heading % 2) and not step.blocked


def test_advice_is_that_of_the_reference(walk: Walk) -> None:
    """The advised step is free, brings the goal nearest, and needs the fewest turns of those that do."""
    for step in walk:
        after = step.after
        if after.time % 4 == step.e % 4 and after.time > 1:
            _, gain = planning.steps(walk.body, after, forward(walk, step))
            turn = planning.turn(walk.body, after, gain)
            assert after.advice == (FORWARD if turn == 0 else RIGHT if turn > 4 else LEFT)


def test_mirrored_rays_and_actions_give_mirrored_advice(continuous: Walk) -> None:
    """But where two ways are equally good."""
    advice = np.array([step.after.advice for step in continuous]).reshape(-1, E)
    agree = []
    for (observation, blocked, action, begun), expected in zip(continuous.inputs[:32], advice, strict=False):
        mirrored, flipped = (np.where(way == FORWARD, way, 1 - way) for way in (action, expected))
        continuous.planner.step(observation[:, ::-1].copy(), blocked, mirrored, begun)
        agree.append(flipped == continuous.planner.array("advice")[:, 0])
    assert np.mean(agree) > 0.9


def test_steps_that_are_free_on_the_map_of_a_grid_are_free_in_the_house(grid: Walk) -> None:
    """At all eight headings, of which the rays show three or so at a time."""
    free = np.array([planning.steps(grid.body, step.after, forward(grid, step))[0] for step in grid])
    poses = np.stack(grid.poses)
    can = abilities(grid, poses[..., :2].reshape(-1, 2)).reshape(-1, E, 1)
    headings = (np.rint(poses[..., 2:] / (np.pi / 4)).astype(int) + np.arange(8)) % 8
    bumps = np.stack([blocked for _, blocked, _, _ in grid.inputs])[..., None] & (np.arange(8) == 0)
    assert (free.reshape(-1, E, 8) == (can >> headings & 1 == 1))[~bumps].mean() > 0.995


def explored(envs: HouseVectorEnv, steps: int, seed: int) -> tuple[Explorer, np.ndarray, int]:
    """An explorer after some steps; its rewards (T, E) and bumps."""
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
    """Far more than a target-blind walk, in every house; and the planner knows how many it picked up."""
    envs = make_envs([random_house(seed) for seed in range(6)], 6, "secondary")
    explorer, rewards, bumps = explored(envs, 1499, seed=0)
    truly, found = rewards.sum(0), explorer.tracker.planner.read("found").numpy()
    assert (truly >= 3).all()
    assert bumps <= rewards.size * 0.001
    assert np.abs(found - truly).sum() <= 0.1 * truly.sum()


def test_a_target_in_sight_is_reached_in_hardly_more_steps_than_it_takes() -> None:
    """Against the simulator's shortest paths, turns and all: in three quarters of cases in just as many."""
    number = 160
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
