"""Policies: the fraction of random actions."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from vitruvius.agent.baselines.driving import explorer as driving
from vitruvius.agent.baselines.driving.explorer import DrivingExplorer
from vitruvius.agent.policies import policies
from vitruvius.agent.policies.policies import RandomPolicy, Tracker, epsilon_greedy, exploration, home
from vitruvius.sim.actions import FORWARD, LEFT
from vitruvius.sim.config import DEFAULT


def seeded() -> torch.Generator:
    return torch.Generator().manual_seed(0)


@pytest.mark.parametrize("draws", [1, 2])
@pytest.mark.parametrize("epsilon", [0.0, 0.25, 1.0])
def test_a_share_of_the_actions_is_random_and_the_rest_are_the_best(epsilon, draws):
    q = torch.tensor([[1.0, 0.0, 0.0]]).expand(20_000, 3)
    actions = epsilon_greedy(q, *exploration((len(q),), seeded(), epsilon, 1.0, draws)).argmax(-1)
    assert (actions == FORWARD).float().mean().item() == pytest.approx(epsilon, abs=0.01)
    assert ((actions == FORWARD) | (actions == LEFT)).all()


def test_a_policy_begins_without_interventions_and_counts_those_of_an_episode():
    class Never:
        def __call__(self, observation, blocked):
            return torch.tensor([[True, True, False]]).expand(len(observation), 3)

    policy = RandomPolicy(Never(), seeded(), forward=1.0)
    assert policy.interventions == 0
    scene, still = torch.zeros(5, 40, 2), torch.zeros(5, dtype=torch.bool)
    assert (policy(scene, still) != FORWARD).all()
    assert policy.interventions == 5
    policy.begin(5)
    assert policy.interventions == 0


def test_a_random_action_goes_to_a_target_that_a_middle_ray_sees():
    scene = torch.zeros(3, 40, 2)
    scene[1, 20, -1] = 1.0
    scene[2, 0, -1] = 1.0
    preference = torch.tensor([[1.0, 0.0, 0.0]]).expand(3, 3)
    assert home(preference, scene).argmax(-1).tolist() == [LEFT, FORWARD, LEFT]


def test_what_drives_has_no_layer_and_so_no_interventions():
    assert DrivingExplorer.interventions == 0


class Planners:
    """Stub of a planner, which makes no map and records its arguments."""

    def __init__(self, _, environments, *__, led=False):
        self.advice = torch.zeros(environments, 2)
        self.led, self.fresh = led, []

    def step(self, *arguments):
        self.fresh.append(arguments[3].tolist())


NOTHING, STILL = torch.zeros(3, 40, 2), torch.zeros(3, dtype=torch.bool)


@pytest.mark.parametrize("chooser", [True, False])
def test_a_tracker_has_a_planner_for_each_environment_that_a_chooser_leads(monkeypatch, chooser):
    monkeypatch.setattr(policies, "Planner", Planners)
    asked = []

    def choose(planner):
        asked.append(planner)

    tracker = Tracker(DEFAULT, chooser=choose if chooser else None)
    tracker.begin(3)
    planner: Any = tracker.look(NOTHING, STILL)
    assert tracker.look(NOTHING, STILL) is planner
    assert len(planner.advice) == 3
    assert planner.fresh == [[True] * 3, [False] * 3]
    assert planner.led == chooser
    assert asked == [planner, planner] * chooser


def test_an_explorer_that_drives_has_a_planner_for_each_environment(monkeypatch):
    monkeypatch.setattr(policies, "Planner", Planners)
    monkeypatch.setattr(driving, "steered", lambda drive, off, room: off)
    explorer = DrivingExplorer(replace(DEFAULT, drives=True), lambda: np.zeros((3, 3)))
    explorer.begin(3)
    assert len(explorer(NOTHING, STILL)) == 3
    assert len(explorer(NOTHING, STILL)) == 3
    planner: Any = explorer.tracker.planner
    assert planner.fresh == [[True] * 3, [False] * 3]
