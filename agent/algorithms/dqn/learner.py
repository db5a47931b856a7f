"""Deep Q-learning from a replay buffer (DQN), to be read next to its papers.

| part | source |
|---|---|
| replay buffer, target network | Mnih et al. 2015, doi:10.1038/nature14236 |
| double Q-learning | van Hasselt et al. 2016, arXiv:1509.06461 |
| n-step returns | Hessel et al. 2018 (Rainbow), arXiv:1710.02298: not corrected for exploring actions |

The rule comes first, as pure functions of tensors. Then follows the learner, which repeats three phases: it
steps all environments, stores the steps, and learns from a sample of them.

Axes: E environments, n steps of a return, B samples, R rays, C channels, M half-lives, A actions; ``s_tm1,
a_tm1`` lead to ``s_t``.
"""

from copy import deepcopy
from typing import Any, NamedTuple

import torch
from torch import Tensor, nn

from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.avoidance import subsume
from vitruvius.agent.learning.networks import OwnNetwork, q_network
from vitruvius.agent.learning.replay import ReplayBuffer
from vitruvius.agent.learning.replay_learner import ReplayLearner
from vitruvius.agent.policies.network import QNetwork
from vitruvius.agent.policies.policies import epsilon_greedy, exploration
from vitruvius.sim import HouseVectorEnv


def n_step_returns(
    r: Tensor, terminated: Tensor, truncated: Tensor, *, gamma: float
) -> tuple[Tensor, Tensor, Tensor]:
    """Return n-step returns from the first step of each sample: ``g, ahead, discount``, each (B,).

    ``r`` (n, B) are rewards; ``terminated`` and ``truncated`` (n, B) bool state how a step ended. ``g`` is
    the sum of the discounted rewards up to the first end. The value of the state ``ahead`` steps on is
    multiplied by ``discount``, which is 0 if that state is terminal, but not after a time-out. Steps after an
    end are left out.
    """
    alive = torch.ones_like(terminated[0])
    died, ahead, g = ~alive, torch.zeros(len(alive), dtype=torch.int64), torch.zeros_like(r[0])
    for k in range(len(r)):
        g = g + gamma**k * r[k] * alive
        ahead = ahead + alive
        died = died | (alive & terminated[k])
        alive = alive & ~(terminated[k] | truncated[k])
    return g, ahead, gamma**ahead * ~died


def double_q_targets(
    g: Tensor, discount_t: Tensor, q_t_target: Tensor, q_t_online: Tensor, allowed_t: Tensor
) -> Tensor:
    """Return targets (B,) for the values of the taken actions: the return plus the next state's value.

    The network chooses the action in the next state by its values ``q_t_online`` (B, A), among the actions
    that are ``allowed_t`` (B, A) bool. The action's value comes from the target network, ``q_t_target`` (B,
    A).
    """
    best = subsume(q_t_online, allowed_t)
    return g + discount_t * q_t_target.gather(1, best[:, None]).squeeze(1)


def huber_loss(q_tm1: Tensor, a_tm1: Tensor, target: Tensor, valid: Tensor) -> Tensor:
    """Return the Huber loss, a scalar, of the taken actions' values (B, A) to their targets (B,).

    The loss is squared up to an error of 1 and linear from there. ``valid`` (B,) bool leaves out the steps
    after an end, whose action the environment ignored.
    """
    q = q_tm1.gather(1, a_tm1[:, None]).squeeze(1)
    loss = nn.functional.huber_loss(q, target, reduction="none")
    return (loss * valid).sum() / valid.sum().clamp(min=1)


class ReplayBatch(NamedTuple):
    """Steps to learn from. ``m`` is the memory (B, M, 6) of an observation ``s`` (B, R, C)."""

    s_tm1: Tensor
    m_tm1: Tensor
    a_tm1: Tensor
    g: Tensor
    discount_t: Tensor
    s_t: Tensor
    m_t: Tensor
    allowed_t: Tensor
    valid: Tensor


def n_step_batch(replay: ReplayBuffer, rows: Tensor, envs: Tensor, *, n: int, gamma: float) -> ReplayBatch:
    """Return the steps in these rows (B,) of these environments (B,), with their n-step returns."""
    window, along = rows + torch.arange(n)[:, None], envs.expand(n, -1)
    ends = (replay.read(name, window, along) for name in ("r", "terminated", "truncated"))
    g, ahead, discount_t = n_step_returns(*ends, gamma=gamma)
    return ReplayBatch(
        s_tm1=replay.read("s", rows, envs).float(),
        m_tm1=replay.read("m", rows, envs).float(),
        a_tm1=replay.read("a", rows, envs),
        g=g,
        discount_t=discount_t,
        s_t=replay.read("s", rows + ahead, envs).float(),
        m_t=replay.read("m", rows + ahead, envs).float(),
        allowed_t=replay.read("allowed", rows + ahead, envs),
        valid=replay.read("valid", rows, envs),
    )


class DQN(ReplayLearner):
    """Run of deep Q-learning: two networks and a replay buffer."""

    config: DQNConfig
    last = ("s", "m", "blocked", "ended", "updates")

    @staticmethod
    def network_of(config: DQNConfig) -> QNetwork | OwnNetwork:
        """Return a new network: see ``Learner``."""
        return q_network(config)

    def __init__(self, config: DQNConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        super().__init__(config, envs)
        self.least_rows = config.n_step + 1
        self.target = deepcopy(self.network)
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=config.learning_rate, fused=True)
        count = config.num_envs
        self.m = self.network.memory.empty(count)
        flags = self.blocked
        # Half precision is exact to 2 mm at the end of the range. It is as fast to read and takes half the
        # memory.
        self.replay = ReplayBuffer(
            config.buffer_size // count,
            s=self.s.half(),
            m=self.m.half(),
            allowed=torch.zeros(count, self.network.actions, dtype=torch.bool),
            a=torch.zeros(count, dtype=torch.int64),
            r=torch.zeros(count),
            terminated=flags,
            truncated=flags,
            valid=flags,
        )

    @property
    def epsilon(self) -> float:
        """Current fraction of random actions."""
        return self.config.epsilon_at(self.fraction)

    def step(self) -> list[Tensor]:
        """Step all environments once, learn at every ``train_frequency``-th step, and return the losses."""
        self.act()
        due = self.ready and self.replay.written % self.config.train_frequency == 0
        return [self.train_step(self.sample())] if due else []

    @torch.no_grad()
    def act(self) -> None:
        """Step all environments once, and store the executed actions."""
        s, blocked, begun = self.s, self.blocked, self.ended
        allowed, q = self.avoidance(s, blocked), self.network(s, self.m)
        noise = exploration(q.shape[:1], self.generator, self.epsilon, self.config.forward, 1, q.shape[1])
        preference = epsilon_greedy(q, *noise)
        a = subsume(preference, allowed)
        r, terminated, truncated = self.step_envs(a)
        self.replay.append(
            s=s,
            m=self.m,
            allowed=allowed,
            a=a,
            r=r,
            terminated=terminated,
            truncated=truncated,
            valid=~begun,
        )
        self.tally.add(r, valid=~begun, overruled=a != preference.argmax(-1))
        # The step after an end begins the next episode: its memory is empty.
        self.m = self.network.memory(self.m, s, blocked, a, begun)

    def sample(self) -> ReplayBatch:
        """Return random steps from the replay buffer."""
        config = self.config
        rows, envs = self.replay.sample(config.batch_size, config.n_step, self.generator)
        return n_step_batch(self.replay, rows, envs, n=config.n_step, gamma=config.gamma)

    def train_step(self, batch: ReplayBatch) -> Tensor:
        """Learn from a batch; return the loss."""
        config = self.config
        with torch.no_grad():
            q_t_target = self.target(batch.s_t, batch.m_t)
            q_t_online = self.network(batch.s_t, batch.m_t)
            target = double_q_targets(batch.g, batch.discount_t, q_t_target, q_t_online, batch.allowed_t)
        loss = huber_loss(self.network(batch.s_tm1, batch.m_tm1), batch.a_tm1, target, batch.valid)
        self.anneal(config.final_lr_fraction)
        loss = self.descend(loss, config.max_grad_norm)
        self.updates += 1
        if self.updates % config.target_network_frequency == 0:
            self.target.load_state_dict(self.network.state_dict())
        return loss

    def own_state(self) -> dict[str, Any]:
        """Return the learner's state, with the target network."""
        return super().own_state() | {"target": self.target.state_dict()}

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        super().restore_own(state)
        self.target.load_state_dict(state["target"])
