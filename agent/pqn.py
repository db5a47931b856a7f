"""Parallel Q-learning with Q(lambda), "PQN" (Gallici et al. 2024, arXiv:2407.04811), to be read beside it.

Many worlds are stepped at once and learnt from at once, on-policy: no replay memory and no target network, as
LayerNorm keeps the values from running away. First the rule, as pure functions of tensors; then the learner:
act for a rollout, work out what the actions were worth, bring the network nearer to that, again.

Axes: T steps of a rollout, E environments, B samples of a batch, R rays, C channels, A actions. The names
follow the transition: ``s_tm1, a_tm1`` lead to ``r_t`` and ``s_t``.
"""

from collections.abc import Iterator
from time import perf_counter
from typing import Any, NamedTuple

import torch
from torch import Tensor

from agent import ranks
from agent.actions import mirrored
from agent.config import PQNConfig
from agent.learner import Learner, Progress
from agent.levels import Levels
from agent.memory import mirrored_memory
from agent.planner import Planner, mirrored_features
from agent.rollout import Rollout
from sim import HouseVectorEnv


def lambda_returns(
    r_t: Tensor, terminated_t: Tensor, truncated_t: Tensor, v_t: Tensor, *, discount: float, trace: float
) -> Tensor:
    """Peng's Q(lambda) targets (T, E) for the actions taken.

    ``r_t`` (T, E) are rewards, ``v_t`` (T, E) what the state is worth that each step led to: its greatest
    allowed Q-value, or with a map that of the action which would be preferred. ``terminated_t`` and
    ``truncated_t`` (T, E) bool say how it ended. A terminal state is worth nothing; a time-out is worth
    ``v_t``, as the world would have gone on; neither lets a later episode's return through. Not cut at
    exploring actions: Peng's form, whose bias is small where these are few.
    """
    bootstrap = r_t + discount * v_t.masked_fill(terminated_t, 0.0)
    # How much of the next return flows back into this one: none across an end.
    flow = discount * trace * (~(terminated_t | truncated_t)).to(r_t.dtype)
    returns = bootstrap - flow * v_t
    returns[-1] = bootstrap[-1]
    for t in range(len(r_t) - 2, -1, -1):
        returns[t].addcmul_(flow[t], returns[t + 1])
    return returns


def q_loss(q_tm1: Tensor, a_tm1: Tensor, g_tm1: Tensor, valid: Tensor, count: Tensor | None = None) -> Tensor:
    """Half the mean squared error of the taken actions' values (B, A) to their returns (B,), a scalar.

    ``valid`` (B,) bool leaves out the steps after an end, whose action the world ignored. ``count`` is how
    many are valid, where the batch is but a part of all that is learnt from.
    """
    error = q_tm1.gather(1, a_tm1[:, None]).squeeze(1) - g_tm1
    return 0.5 * (error.square() * valid).sum() / (valid.sum() if count is None else count).clamp(min=1)


def linear(start: float, end: float, progress: float) -> float:
    """The value on the line from start to end at progress 0 to 1, and the end beyond."""
    return start + (end - start) * min(max(progress, 0.0), 1.0)


class Batch(NamedTuple):
    """Steps to learn from, (B, ...) each."""

    s_tm1: Tensor
    m_tm1: Tensor
    f_tm1: Tensor
    a_tm1: Tensor
    g_tm1: Tensor
    valid: Tensor

    def seen_in_the_mirror(self) -> "Batch":
        """The same steps with left and right exchanged."""
        return self._replace(
            s_tm1=self.s_tm1.flip(1),
            m_tm1=mirrored_memory(self.m_tm1),
            f_tm1=mirrored_features(self.f_tm1),
            a_tm1=mirrored(self.a_tm1),
        )


class PQN(Learner):
    """A run of parallel Q-learning."""

    config: PQNConfig

    def __init__(self, config: PQNConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has this rank's share of the environments, and NEXT_STEP autoreset."""
        super().__init__(config, envs, config.rollout)
        self.optimizer = torch.optim.RAdam(self.network.parameters(), lr=config.learning_rate, foreach=True)
        self.begin()

    def begin(self) -> None:
        """Begin episodes in all worlds, with empty memories and maps."""
        envs, config = self.envs, self.config
        self.levels = Levels(len(envs.houses), envs.num_envs) if config.levels else None
        if self.levels:
            envs.assign(self.levels.deal(envs.num_envs, self.generator))
        observation, memory = self.first_look(), self.network.memory.empty(envs.num_envs)
        self.map = Planner(envs.config, envs.num_envs) if config.map else None
        self.rollout = Rollout.starting(config.rollout, observation, memory, self.map)

    @property
    def epsilon(self) -> float:
        """Share of random actions now."""
        c = self.config
        return linear(c.epsilon, c.final_epsilon, self.fraction / max(c.exploration, 1e-9))

    def advance(self) -> Progress:
        """Act for a rollout and learn from it."""
        start, config, rollout, epsilon = perf_counter(), self.config, self.rollout, self.epsilon
        rollout.fill(
            *(self.envs, self.network, self.avoidance),
            epsilon=epsilon,
            forward=config.forward,
            generator=self.generator,
            guided=config.guided,
        )
        g = self.returns()
        loss = self.update(g)
        if self.levels:
            ended = rollout.terminated | rollout.truncated
            self.levels.update(rollout.house, g - rollout.v[:-1], ended, rollout.valid)
            self.envs.assign(self.levels.deal(self.envs.num_envs, self.generator))
        self.clock.simulating += rollout.simulating
        self.clock.mapping += rollout.mapping
        self.clock.all += perf_counter() - start
        return self.report(
            found=float(rollout.r.sum()),
            counted=float(rollout.valid.sum()),
            overruled=rollout.overruled,
            loss=loss,
            epsilon=epsilon,
        )

    def update(self, g: Tensor) -> float:
        """Learn what the rollout's actions were worth (T, E); the mean loss."""
        config = self.config
        for group in self.optimizer.param_groups:
            group["lr"] = config.learning_rate * linear(1.0, config.final_rate, self.fraction)
        losses = []
        for epoch in range(config.epochs):
            for number, batch in enumerate(self.batches(g)):
                turned = config.mirror and (epoch + number) % 2
                losses.append(self.improve(batch.seen_in_the_mirror() if turned else batch))
        return float(torch.stack(losses).mean())

    def returns(self) -> Tensor:
        """What each action of the rollout (T, E) was worth; the map's bonus counts beside the rewards."""
        config, rollout = self.config, self.rollout
        novelty = linear(config.novelty, 0.0, self.fraction / max(config.fading, 1e-9))
        return lambda_returns(
            rollout.r + novelty * rollout.bonus if novelty else rollout.r,
            rollout.terminated,
            rollout.truncated,
            rollout.v[1:],
            discount=config.discount,
            trace=config.trace,
        )

    def batches(self, g: Tensor) -> Iterator[Batch]:
        """The rollout's steps in an order by chance, shared out among minibatches."""
        rollout, parts = self.rollout, self.config.minibatches
        if self.config.network == "recurrent":
            yield from self.sequences(g)
            return
        states = (kept[:-1].flatten(0, 1) for kept in (rollout.s, rollout.memory, rollout.features))
        steps = Batch(*states, *(kept.flatten() for kept in (rollout.a, g, rollout.valid)))
        for part in self.shuffled(g.numel()).chunk(parts):
            yield Batch(*(field.index_select(0, part) for field in steps))

    def shuffled(self, count: int) -> Tensor:
        """The numbers below ``count`` in an order by chance."""
        return torch.randperm(count, generator=self.generator, device=self.generator.device)

    def sequences(self, g: Tensor) -> Iterator[Batch]:
        """The same for a network that learns what to remember: each part has some worlds' whole rollouts,
        their memories worked out anew from the first ones, so that gradients reach back through all steps.
        """
        rollout = self.rollout
        ended = ~rollout.valid  # the step after an end begins another episode
        for worlds in self.shuffled(g.shape[1]).chunk(self.config.minibatches):
            s, a = rollout.s[:-1, worlds], rollout.a[:, worlds]
            memory = self.network.memory.unrolled(
                rollout.memory[0, worlds], s, rollout.blocked[:-1, worlds], a, ended[:, worlds]
            )
            fields = (s, memory, rollout.features[:-1, worlds], a, g[:, worlds], rollout.valid[:, worlds])
            yield Batch(*(field.flatten(0, 1) for field in fields))

    def improve(self, batch: Batch) -> Tensor:
        """Bring the network nearer to the returns; the loss. All ranks' batches count as one."""
        count = batch.valid.sum()
        ranks.add_up(count)
        q = self.network(batch.s_tm1, batch.m_tm1, batch.f_tm1)
        loss = q_loss(q, batch.a_tm1, batch.g_tm1, batch.valid, count)
        self.optimizer.zero_grad()
        loss.backward()
        ranks.add_up_gradients(self.network)
        if self.config.clip is not None:
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), self.config.clip)
        self.optimizer.step()
        return loss.detach() * ranks.size()

    def own_state(self) -> dict[str, Any]:
        """The optimiser, the maps, and the state that the rollout before ended in."""
        rollout = self.rollout
        return {
            "optimizer": self.optimizer.state_dict(),
            "map": self.map.state if self.map else None,
            "levels": self.levels.state() if self.levels else None,
            "last": {name: getattr(rollout, name)[-1].clone() for name in LAST},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
        self.optimizer.load_state_dict(state["optimizer"])
        if self.map:
            self.map.state = state["map"]
        if self.levels:
            self.levels.restore(state["levels"])
        for name, last in state["last"].items():
            getattr(self.rollout, name)[-1] = last


LAST = ("s", "blocked", "memory", "features", "terminated", "truncated")
"""What the next rollout goes on from."""
