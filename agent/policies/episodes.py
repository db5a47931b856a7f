"""Loop in which a policy acts: one episode in each of E environments, side by side."""

from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

import torch
from torch import Tensor

from vitruvius.agent.policies.policies import Policy
from vitruvius.sim import HouseVectorEnv


class Moment(NamedTuple):
    """Environments before a step, and the result of the last step.

    Tensors are the simulator's own memory, which the next step overwrites.
    """

    step: int
    """Number of steps so far."""

    observation: Tensor
    """Observations, (E, R, C) float32."""

    blocked: Tensor
    """(E,) bool: true where the last actions were blocked."""

    reward: Tensor
    """Rewards of the last actions, (E,) float32; 0 at first."""

    ended: Tensor
    """(E,) bool: true for episodes that have ended."""

    actions: Tensor | None
    """Actions that the policy has chosen, (E,) int64; None after the last step."""


def moments(
    envs: HouseVectorEnv,
    policy: Policy,
    observation: Tensor,
    steps: int | None = None,
    *,
    blocked: Tensor | None = None,
    through: bool = False,
) -> Iterator[Moment]:
    """Play from the observations (E, R, C) until all episodes have ended, or for ``steps`` steps.

    Yields before each step and after the last one. ``blocked`` (E,) bool belongs to episodes under way;
    without it episodes begin, and the policy forgets the past. With ``through``, play continues into the next
    episodes when all have ended.
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
