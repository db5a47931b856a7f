"""The loop in which a policy acts: one episode in each of E environments, side by side."""

from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

import torch
from torch import Tensor

from agent.policies.policies import Policy
from sim import HouseVectorEnv


class Moment(NamedTuple):
    """Environments before a step, and what the last one led to. Tensors are the simulator's own memory, which
    the next step overwrites.
    """

    step: int
    """Steps so far."""

    observation: Tensor
    """(E, R, C) float32."""

    blocked: Tensor
    """(E,) bool: whether the last actions came to nothing."""

    reward: Tensor
    """(E,) float32, of the last actions; 0 at first."""

    ended: Tensor
    """(E,) bool: which episodes have ended."""

    actions: Tensor | None
    """(E,) int64: what the policy has chosen; None after the last step."""


def moments(
    envs: HouseVectorEnv,
    policy: Policy,
    observation: Tensor,
    steps: int | None = None,
    *,
    blocked: Tensor | None = None,
    through: bool = False,
) -> Iterator[Moment]:
    """Play on from the observations (E, R, C) until all episodes have ended, or for some ``steps``; yields
    before each step and after the last one.

    ``blocked`` (E,) bool is of episodes that are under way; without it they begin, and the policy forgets the
    past. With ``through`` it goes on where all have ended, into the next ones.
    """
    if blocked is None:
        policy.begin(envs.num_envs)
    bumped: Tensor = observation.new_zeros(envs.num_envs, dtype=torch.bool) if blocked is None else blocked
    reward, ended = observation.new_zeros(envs.num_envs), torch.zeros_like(bumped)
    for step in count():
        if step == steps or (ended.all() and not through):
            yield Moment(step, observation, bumped, reward, ended, None)
            return
        actions = policy(observation, bumped)
        yield Moment(step, observation, bumped, reward, ended, actions)
        observation, reward, terminated, truncated, info = envs.step_torch(actions)
        bumped, ended = info["blocked"], ended | terminated | truncated
