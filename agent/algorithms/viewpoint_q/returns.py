"""Returns of options, and the reward that a house makes certain. Pure functions of tensors.

Axes: T steps, E environments.
"""

import torch
from torch import Tensor


def option_returns(
    r: Tensor, playing: Tensor, chose: Tensor, v: Tensor, *, gamma: float, q_lambda: float
) -> Tensor:
    """Peng's Q(lambda) targets (T, E) for options, of meaning where one began.

    ``r`` (T, E) are the rewards of steps; ``playing`` (T, E) bool whether the episode still went on before
    each; ``chose`` (T, E) bool whether an option began with it, and ``v`` (T, E) the greatest Q-value there.
    An option lasts until the next one: its return is the sum of gamma^t r over its steps, and gamma^n times
    what follows (Sutton, Precup and Singh 1999, doi:10.1016/S0004-3702(99)00052-1): a share ``q_lambda`` of
    the next option's return and the rest of its value. Nothing follows the end of an episode: its length is
    known, and the time that is left is among the features.
    """
    returns, carry = torch.zeros_like(r), torch.zeros_like(r[0])
    for t in range(len(r) - 1, -1, -1):
        carry = torch.where(playing[t], r[t] + gamma * carry, 0.0)
        returns[t] = carry
        carry = torch.where(chose[t], q_lambda * carry + (1 - q_lambda) * v[t], carry)
    return returns


def expected_finds(before: Tensor, after: Tensor, seeks: Tensor, total: Tensor) -> Tensor:
    """How likely each step showed the target (T, E), by a house's own spots: a reward of the same mean as
    finding it, and less variance (the compensator of that event).

    In how many of the ``total`` (E,) spots the target cannot lie, as what was seen says, ``before`` each step
    and ``after`` it (T, E); ``seeks`` (T, E) bool whether it was unknown until then. Of a step that picks up
    a target they tell of the next one.
    """
    return (after - before) / (total - before).clamp(min=1.0) * seeks
