"""The memory: exponential moving averages that rise, fall, are flipped, and begin empty."""

import pytest
import torch

from agent.actions import FORWARD, LEFT, flipped_actions
from agent.memory import Memory, flipped_memory

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


def test_the_memory_of_flipped_observations_is_the_flipped_memory():
    memory, held = Memory((1, 4, 16)), Memory((1, 4, 16)).empty(5)
    other = held
    generator = torch.Generator().manual_seed(0)
    scenes = (torch.rand(20, 5, 40, 2, generator=generator) > 0.97).float()
    new, bumped = torch.zeros(5, dtype=torch.bool), torch.tensor([True, False, False, True, False])
    for seen, actions in zip(scenes, torch.randint(3, (20, 5), generator=generator), strict=True):
        held = memory(held, seen, bumped, actions, new)
        other = memory(other, seen.flip(1), bumped, flipped_actions(actions), new)
    assert held.gt(0).any((0, 1)).all()
    torch.testing.assert_close(flipped_memory(held), other)
