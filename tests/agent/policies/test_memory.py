"""Memory: exponential moving averages that rise, fall, and begin empty."""

import pytest
import torch

from vitruvius.agent.learning.config import QLearningConfig
from vitruvius.agent.policies.memory import Memory
from vitruvius.agent.policies.network import QNetwork
from vitruvius.sim.actions import FORWARD, LEFT

NO = torch.zeros(1, dtype=torch.bool)
NOTHING = torch.zeros(1, 40, 2)


def test_an_average_rises_to_a_half_in_its_half_life_and_falls_as_fast():
    memory = Memory((1, 4))
    held = memory.empty(1)
    for _ in range(4):
        held = memory(held, NOTHING, NO, torch.tensor([LEFT]), NO)
    assert held[0, 1].tolist() == pytest.approx([0.5, 0, 0, 0, 0, 0])
    for _ in range(4):
        held = memory(held, NOTHING, NO, torch.tensor([FORWARD]), NO)
    assert held[0, 1].tolist() == pytest.approx([0.25, 0, 0.5, 0, 0, 0])


def test_it_remembers_bumps_and_on_which_side_the_target_was():
    memory, seen = Memory((1,)), NOTHING.clone()
    seen[0, 3, 1] = 1
    bump = torch.ones(1, dtype=torch.bool)
    held = memory(memory.empty(1), seen, bump, torch.tensor([FORWARD]), NO)
    assert held.flatten().tolist() == [0, 0, 0.5, 0.5, 0.5, 0]


def test_the_memory_is_empty_where_an_episode_begins():
    held, yes = torch.ones(2, 2, 6), torch.ones(2, dtype=torch.bool)
    actions, begun = torch.tensor([LEFT, LEFT]), torch.tensor([True, False])
    held = Memory((1, 4))(held, torch.ones(2, 40, 2), yes, actions, begun)
    assert held[0].eq(0).all()
    assert held[1].gt(0).any()


def test_a_network_has_by_default_the_half_lives_of_a_default_run():
    assert QNetwork().shape == (40, 2, QLearningConfig.half_lives)
