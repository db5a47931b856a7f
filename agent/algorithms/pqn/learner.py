"""Parallel Q-learning with Q(lambda), "PQN" (Gallici et al. 2024, arXiv:2407.04811): read them together.

Many environments are stepped together, and the network learns on-policy from all of them. There is no replay
buffer and no target network, as LayerNorm keeps the values from growing without bound. The rule comes first,
as pure functions of tensors. Then follows the learner, which repeats three phases: it acts for a rollout,
computes the rollout's returns, and trains the network.

Axes: T steps of a rollout, E environments, B samples of a batch, R rays, C channels, A actions. The names
follow the transition: ``s_tm1, a_tm1`` lead to ``r_t`` and ``s_t``.
"""

from collections.abc import Iterator
from time import perf_counter
from typing import Any, NamedTuple

import torch
from torch import Tensor

from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.pqn.recurrent import RecurrentQNetwork
from vitruvius.agent.algorithms.pqn.rollout import Rollout
from vitruvius.agent.learning import ranks
from vitruvius.agent.learning.learner import Learner, Progress, Tally
from vitruvius.agent.learning.networks import OwnNetwork, q_network
from vitruvius.agent.learning.simulator import actions, simulator
from vitruvius.agent.policies.network import QNetwork, seeded
from vitruvius.sim import HouseVectorEnv


def lambda_returns(
    r_t: Tensor, terminated_t: Tensor, truncated_t: Tensor, v_t: Tensor, *, gamma: float, q_lambda: float
) -> Tensor:
    """Return Peng's Q(lambda) targets (T, E) for the actions taken.

    ``r_t`` (T, E) are rewards. ``v_t`` (T, E) is the value of the state that each step led to: the greatest
    Q-value of an allowed action.

    ``terminated_t`` and ``truncated_t`` (T, E) bool state how a step ended. The value of a terminal state is
    0. The value of a state at a time-out is ``v_t``, as the episode could have gone on. No return flows from
    an episode to the one before.

    Returns are not cut at exploring actions: this is Peng's form, whose bias is small if exploring actions
    are few.
    """
    bootstrap = r_t + gamma * v_t.masked_fill(terminated_t, 0.0)
    # Fraction of the next return that flows back into this one: none across an end.
    flow = gamma * q_lambda * (~(terminated_t | truncated_t)).to(r_t.dtype)
    returns = bootstrap - flow * v_t
    returns[-1] = bootstrap[-1]
    for t in range(len(r_t) - 2, -1, -1):
        returns[t].addcmul_(flow[t], returns[t + 1])
    return returns


def q_loss(q_tm1: Tensor, a_tm1: Tensor, g_tm1: Tensor, valid: Tensor, count: Tensor | None = None) -> Tensor:
    """Return half the mean squared error of the taken actions' values (B, A) to their returns (B,), a scalar.

    ``valid`` (B,) bool leaves out the steps after an end, whose action the environment ignored. ``count`` is
    the number of valid steps if several batches count as one.
    """
    error = q_tm1.gather(1, a_tm1[:, None]).squeeze(1) - g_tm1
    return 0.5 * (error.square() * valid).sum() / (valid.sum() if count is None else count).clamp(min=1)


class RolloutBatch(NamedTuple):
    """Steps to learn from, (B, ...) each."""

    s_tm1: Tensor
    m_tm1: Tensor
    a_tm1: Tensor
    g_tm1: Tensor
    valid: Tensor


class PQN(Learner):
    """Run of parallel Q-learning."""

    config: PQNConfig

    @staticmethod
    def network_of(config: PQNConfig) -> QNetwork | OwnNetwork | RecurrentQNetwork:
        """Return a new network: see ``Learner``."""
        if config.network == "feedforward":
            return q_network(config)
        world = simulator(config)
        with seeded(config.seed):
            return RecurrentQNetwork(world.rays, world.channels, actions=actions(config))

    def __init__(self, config: PQNConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has this rank's share of the environments, and NEXT_STEP autoreset."""
        super().__init__(config, envs, report=config.num_steps)
        self.optimizer = torch.optim.RAdam(self.network.parameters(), lr=config.learning_rate, foreach=True)
        observation, memory = self.reset_envs(), self.network.memory.empty(envs.num_envs)
        self.rollout = Rollout.starting(config.num_steps, observation, memory)

    @property
    def epsilon(self) -> float:
        """Current fraction of random actions."""
        return self.config.epsilon_at(self.fraction)

    def iterate(self) -> Progress:
        """Act for a rollout and learn from it."""
        start, epsilon, rollout = perf_counter(), self.epsilon, self.rollout
        self.act(epsilon)
        loss = self.train_epochs(self.returns())
        self.clock.all += perf_counter() - start
        tally = Tally(float(rollout.r.sum()), float(rollout.valid.sum()), rollout.overruled)
        return self.report(tally, loss=loss, epsilon=epsilon)

    def act(self, epsilon: float) -> None:
        """Fill the rollout: act in all environments, with a fraction ``epsilon`` of random actions."""
        self.rollout.fill(
            self.envs,
            self.network,
            self.avoidance,
            epsilon=epsilon,
            forward=self.config.forward,
            generator=self.generator,
            simulating=self.simulating,
        )

    def returns(self) -> Tensor:
        """Return the return of each action of the rollout (T, E)."""
        config, rollout = self.config, self.rollout
        return lambda_returns(
            *(rollout.r, rollout.terminated, rollout.truncated, rollout.v[1:]),
            gamma=config.gamma,
            q_lambda=config.q_lambda,
        )

    def train_epochs(self, g: Tensor) -> float:
        """Train the network towards the rollout's returns (T, E); return the mean loss."""
        config = self.config
        self.anneal(config.final_lr_fraction)
        losses = []
        for _ in range(config.update_epochs):
            losses += [self.train_step(batch) for batch in self.minibatches(g)]
        return float(torch.stack(losses).mean())

    def minibatches(self, g: Tensor) -> Iterator[RolloutBatch]:
        """Yield the rollout's steps in a random order, divided among minibatches."""
        if self.config.network == "recurrent":
            yield from self.sequences(g)
            return
        rollout = self.rollout
        states = (kept[:-1].flatten(0, 1) for kept in (rollout.s, rollout.memory))
        steps = RolloutBatch(*states, *(kept.flatten() for kept in (rollout.a, g, rollout.valid)))
        for part in self.permutation(g.numel()).chunk(self.config.num_minibatches):
            yield RolloutBatch(*(field.index_select(0, part) for field in steps))

    def permutation(self, count: int) -> Tensor:
        """Return the numbers below ``count`` in a random order."""
        return torch.randperm(count, generator=self.generator, device=self.generator.device)

    def sequences(self, g: Tensor) -> Iterator[RolloutBatch]:
        """Yield minibatches for a recurrent network: each has whole rollouts of some environments.

        The memories are computed again from the first ones, so that gradients reach back through all steps.
        """
        rollout = self.rollout
        ended = ~rollout.valid  # the step after an end begins another episode
        for envs in self.permutation(g.shape[1]).chunk(self.config.num_minibatches):
            s, a = rollout.s[:-1, envs], rollout.a[:, envs]
            memory = self.network.memory.unrolled(
                rollout.memory[0, envs], s, rollout.blocked[:-1, envs], a, ended[:, envs]
            )
            fields = (s, memory, a, g[:, envs], rollout.valid[:, envs])
            yield RolloutBatch(*(field.flatten(0, 1) for field in fields))

    def train_step(self, batch: RolloutBatch) -> Tensor:
        """Learn from a batch; return the loss. The batches of all ranks count as one."""
        count = batch.valid.sum()
        ranks.all_reduce(count)
        q = self.network(batch.s_tm1, batch.m_tm1)
        loss = q_loss(q, batch.a_tm1, batch.g_tm1, batch.valid, count)
        return self.descend(loss, self.config.max_grad_norm) * ranks.size()

    def own_state(self) -> dict[str, Any]:
        """Return the optimiser's state, and the last state of the last rollout."""
        rollout = self.rollout
        return {
            "optimizer": self.optimizer.state_dict(),
            "last": {name: getattr(rollout, name)[-1].clone() for name in LAST},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        self.optimizer.load_state_dict(state["optimizer"])
        for name in LAST:
            getattr(self.rollout, name)[-1] = state["last"][name]


LAST = ("s", "blocked", "memory", "terminated", "truncated")
"""Tensors of a rollout from which the next one starts."""
