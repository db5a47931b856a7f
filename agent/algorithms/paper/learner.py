"""Paper's agent: a Q-network with a softmax that learns at the end of each episode from replayed steps.

Deep Q-learning without a target network and without a discount, as in the original program's code:

- an episode ends by a collision or after 1500 steps, both terminal. Then 500 steps are replayed: first all
  rewarded steps of the episode, then random ones;
- each of these steps gives one update of Adam (epsilon 1e-7), 500 in all; Adam's rate is divided by
  1 + 0.01 x the updates so far;
- the executed action is stored, even if avoidance overruled another; a state's value ignores avoidance;
- the first weights are Glorot's uniform ones, the first biases 0, as in Keras;
- a random action goes forward when a middle ray sees the target;
- the agent learns in one environment, for 817 episodes: the released weights' file counts 408,500 updates.

Differences: states are stored in half precision, and Adam's epsilon is added as in torch.

Axes: E environments, B samples, R rays, C channels, A actions; ``s_tm1, a_tm1`` lead to ``r_t`` and ``s_t``.
"""

from typing import Any, NamedTuple

import torch
from torch import Tensor

from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.paper.network import PaperNetwork
from vitruvius.agent.avoidance import subsume
from vitruvius.agent.learning.environments import layer_of
from vitruvius.agent.learning.replay import ReplayBuffer
from vitruvius.agent.learning.replay_learner import ReplayLearner
from vitruvius.agent.policies.policies import QPolicy, epsilon_greedy, exploration, home
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import ACTIONS


class EpisodeBatch(NamedTuple):
    """Steps to learn from, (B, ...) each."""

    s_tm1: Tensor
    a_tm1: Tensor
    r_t: Tensor
    ended_t: Tensor
    s_t: Tensor


def q_targets(r_t: Tensor, ended_t: Tensor, q_t: Tensor) -> Tensor:
    """Return targets (B,) for the values of the taken actions.

    A target is the reward plus the greatest value (B, A) of the next state. It is the reward alone if the
    episode ``ended_t`` (B,) bool there, by a collision or a time-out.
    """
    return r_t + ~ended_t * q_t.amax(-1)


def squared_loss(q_tm1: Tensor, a_tm1: Tensor, target: Tensor) -> Tensor:
    """Return the mean squared error of the values (B, A), a scalar.

    Taken actions have targets (B,); the other actions count as correct.
    """
    error = q_tm1.gather(-1, a_tm1[:, None]).squeeze(-1) - target
    return error.square().mean() / ACTIONS


class Paper(ReplayLearner):
    """Run of the paper's agent."""

    config: PaperConfig
    last = ("s", "blocked", "ended", "began", "updates", "episodes")
    least_rows = 2

    @staticmethod
    def network_of(config: PaperConfig) -> PaperNetwork:
        """Return a new network: see ``Learner``."""
        return PaperNetwork.of(config)

    @staticmethod
    def policy_of(network: Any, config: PaperConfig, envs: HouseVectorEnv, seed: int = 0) -> QPolicy:
        """Return the policy: see ``Learner``.

        With ``plays_as_original`` it acts as the original was evaluated.
        """
        generator = torch.Generator().manual_seed(seed)
        layer = layer_of(config, envs, generator)
        if config.plays_as_original:
            return QPolicy(network, layer, generator, config.final_epsilon, config.forward, homing=True)
        return QPolicy(network, layer, generator)

    def __init__(self, config: PaperConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        super().__init__(config, envs)
        self.optimizer = torch.optim.Adam(
            self.network.parameters(), lr=config.learning_rate, eps=config.adam_epsilon, fused=True
        )
        self.episodes, count = 0, config.num_envs
        self.began = torch.zeros(count, dtype=torch.int64)
        self.replay = ReplayBuffer(
            config.buffer_size // count,
            s=self.s.half(),  # 2 mm at the end of the range, in half the memory
            a=torch.zeros(count, dtype=torch.int64),
            r=torch.zeros(count),
            ended=self.ended,
            valid=self.ended,
        )

    @property
    def epsilon(self) -> float:
        """Current fraction of random actions."""
        c = self.config
        return max(c.final_epsilon, c.epsilon * c.epsilon_decay**self.episodes)

    @property
    def fraction(self) -> float:
        """Fraction of the run that is done, 0 to 1."""
        limit = self.config.episodes
        return min(1.0, max(super().fraction, self.episodes / limit if limit else 0.0))

    def step(self) -> list[Tensor]:
        """Step all environments once, and replay for each episode that ended before; return the losses."""
        ended, losses = self.ended, []
        self.act()  # first, so that the buffer has the states in which the episodes ended
        for env in ended.nonzero().flatten().tolist():
            self.episodes += 1
            began, self.began[env] = int(self.began[env]), self.replay.written
            if self.ready:
                batch = self.batch(*self.sample(env, began))
                parts = zip(*(field.chunk(self.config.num_minibatches) for field in batch), strict=True)
                losses += [self.train_step(EpisodeBatch(*part)) for part in parts]
        return losses

    @torch.no_grad()
    def act(self) -> None:
        """Step all environments once, and store the executed actions."""
        s, valid, allowed = self.s, ~self.ended, self.avoidance(self.s, self.blocked)
        preference = self.preference(self.network(s), s)
        a = subsume(preference, allowed)
        r, _, _ = self.step_envs(a)
        self.replay.append(s=s, a=a, r=r, ended=self.ended, valid=valid)
        self.tally.add(r, valid=valid, overruled=a != preference.argmax(-1))

    def preference(self, q: Tensor, s: Tensor) -> Tensor:
        """Return preferences (E, A): the Q-values, or a random action in some environments.

        The fraction of random actions is ``epsilon``. With homing, a random action is forward if a middle ray
        of the observations (E, R, C) sees the target.
        """
        chosen, random = exploration(q.shape[:1], self.generator, self.epsilon, self.config.forward)
        return epsilon_greedy(q, chosen, home(random, s) if self.config.homing else random)

    def sample(self, env: int, began: int) -> tuple[Tensor, Tensor]:
        """Return rows and environments, (B,) int64 each, of the steps to replay.

        First come the rewarded steps of this environment's episode, which ``began`` in that row, then random
        steps.
        """
        size, replay = self.config.batch_size, self.replay
        rows, envs = replay.sample_valid(size, 1, self.generator)
        episode = torch.arange(max(began, replay.oldest), replay.written - 1)
        rewarded = episode[replay.read("r", episode, torch.full_like(episode, env)) > 0][:size]
        rows[: len(rewarded)], envs[: len(rewarded)] = rewarded, env
        return rows, envs

    def batch(self, rows: Tensor, envs: Tensor) -> EpisodeBatch:
        """Return the steps in these rows (B,) of these environments (B,)."""
        replay = self.replay
        return EpisodeBatch(
            s_tm1=replay.read("s", rows, envs).float(),
            a_tm1=replay.read("a", rows, envs),
            r_t=replay.read("r", rows, envs),
            ended_t=replay.read("ended", rows, envs),
            s_t=replay.read("s", rows + 1, envs).float(),
        )

    def train_step(self, batch: EpisodeBatch) -> Tensor:
        """Learn from a batch; return the loss."""
        q_tm1, q_t = self.network(torch.cat([batch.s_tm1, batch.s_t])).chunk(2)  # in one call: faster
        target = q_targets(batch.r_t, batch.ended_t, q_t.detach())
        loss = squared_loss(q_tm1, batch.a_tm1, target)
        self.set_learning_rate(self.config.learning_rate / (1 + self.config.lr_decay * self.updates))
        self.updates += 1
        return self.descend(loss)
