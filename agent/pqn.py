"""Parallel Q-learning with Q(lambda) (Gallici et al. 2024), as pure functions of tensors.

Axes: T steps of a rollout, E environments, B samples of a batch, R rays, C channels, A actions. The names
follow the transition: ``s_tm1, a_tm1`` lead to ``r_t`` and ``s_t``.
"""

import torch
from torch import Tensor


def lambda_returns(
    r_t: Tensor, terminated_t: Tensor, truncated_t: Tensor, v_t: Tensor, *, discount: float, trace: float
) -> Tensor:
    """Peng's Q(lambda) targets (T, E) for the actions taken.

    ``r_t`` (T, E) are rewards, ``v_t`` (T, E) the greatest allowed Q-value of the state that each step led
    to, ``terminated_t`` and ``truncated_t`` (T, E) bool how it ended. A terminal state is worth nothing; a
    time-out is worth ``v_t``, as the world would have gone on; neither lets a later episode's return through.
    Not cut at exploring actions: Peng's form, whose bias is small where these are few.
    """
    bootstrap = r_t + discount * v_t.masked_fill(terminated_t, 0.0)
    # How much of the next return flows back into this one: none across an end.
    flow = discount * trace * (~(terminated_t | truncated_t)).to(r_t.dtype)
    returns = torch.empty_like(r_t)
    returns[-1] = bootstrap[-1]
    for t in range(len(r_t) - 2, -1, -1):
        returns[t] = bootstrap[t] + flow[t] * (returns[t + 1] - v_t[t])
    return returns


def q_loss(q_tm1: Tensor, a_tm1: Tensor, g_tm1: Tensor, valid: Tensor) -> Tensor:
    """Half the mean squared error of the taken actions' values (B, A) to their returns (B,), a scalar.

    ``valid`` (B,) bool leaves out the steps after an end, whose action the world ignored.
    """
    error = q_tm1.gather(1, a_tm1[:, None]).squeeze(1) - g_tm1
    return 0.5 * (error.square() * valid).sum() / valid.sum().clamp(min=1)


def linear(start: float, end: float, progress: float) -> float:
    """The value on the line from start to end at progress 0 to 1, and the end beyond."""
    return start + (end - start) * min(max(progress, 0.0), 1.0)
