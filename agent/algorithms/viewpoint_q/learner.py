"""The learner: play an episode in every environment, compute the returns of its options, learn from them."""

from time import perf_counter
from typing import Any, NamedTuple

import torch
from torch import Tensor

from agent.algorithms.build import network_of
from agent.algorithms.viewpoint_q.config import ViewpointQConfig
from agent.algorithms.viewpoint_q.network import Chooser, Situation
from agent.algorithms.viewpoint_q.returns import expected_finds, option_returns
from agent.learning.learner import Learner, Progress, Tally, linear
from agent.planner import Planner
from agent.policies.policies import Explorer
from sim import HouseVectorEnv
from sim.baselines.lookout import Lookout

EXPLORED = 0.5
"""Share of a run over which the share of random choices falls to its last."""


class Choices(NamedTuple):
    """The choices of episodes, n in all."""

    step: Tensor
    """(n,) int64, and of which environment."""

    env: Tensor

    now: Situation

    pick: Tensor
    """(n,) int64, the offer that was taken."""


class Recorder(Chooser):
    """A chooser that notes its choices, and where a target is sought."""

    def begin(self) -> None:
        """Forget all: an episode begins."""
        self.noted: list[tuple[Tensor, Tensor, Situation, Tensor]] = []
        self.seeks: list[Tensor] = []

    def __call__(self, planner: Planner) -> tuple[Tensor, Situation, Tensor]:
        """Choose, see ``Chooser``."""
        envs, now, picks = super().__call__(planner)
        self.noted.append((torch.full_like(envs, len(self.seeks)), envs, now, picks))
        self.seeks.append(planner.seeks.clone())
        return envs, now, picks

    def choices(self) -> Choices:
        """All of them."""
        step, env, now, pick = zip(*self.noted, strict=True)
        whole = Situation(*(torch.cat(part) for part in zip(*now, strict=True)))
        return Choices(torch.cat(step), torch.cat(env), whole, torch.cat(pick))


class ViewpointQ(Learner):
    """A run of Q-learning over viewpoints."""

    config: ViewpointQConfig

    def __init__(self, config: ViewpointQConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` are all environments."""
        super().__init__(config, envs, network_of(config), report=envs.config.steps)
        self.optimizer = torch.optim.RAdam(self.network.parameters(), lr=config.learning_rate)
        self.chooser = Recorder(self.network, self.generator)
        self.explorer = Explorer(self.avoidance, envs.config, chooser=self.chooser)
        self.reset_envs()
        self.lookout = Lookout(envs) if config.privileged else None

    def iterate(self) -> Progress:
        """Play an episode in every environment, and learn from it."""
        start, config = perf_counter(), self.config
        self.chooser.epsilon = linear(config.epsilon, config.final_epsilon, self.fraction / EXPLORED)
        picked, playing, seen = self.play()
        choices = self.chooser.choices()
        r = picked if seen is None else self.expected(picked, seen)
        loss = self.learn(choices, self.returns(choices, r, playing))
        self.clock.all += perf_counter() - start
        tally = Tally(float(picked.sum()), float(playing.sum()), self.explorer.interventions)
        return self.report(tally, loss=loss, epsilon=self.chooser.epsilon)

    def expected(self, picked: Tensor, seen: Tensor) -> Tensor:
        """The privileged rewards (T, E) of what ``play`` gave."""
        assert self.lookout
        seeks = torch.stack(self.chooser.seeks) | (picked > 0)
        return expected_finds(seen[0], seen[1], seeks, torch.from_numpy(self.lookout.totals()).float())

    @torch.inference_mode()
    def play(self) -> tuple[Tensor, Tensor, Tensor | None]:
        """Play an episode: rewards (T, E), where it went on (T, E) bool, and if rewards are privileged in how
        many spots the target cannot lie, before and after each step (2, T, E): see ``expected_finds``.
        """
        observation = torch.as_tensor(self.envs.reset()[0])
        count, steps = self.envs.num_envs, self.envs.config.steps
        blocked, going = torch.zeros(count, dtype=torch.bool), torch.ones(count, dtype=torch.bool)
        r, playing = torch.zeros(steps, count), torch.zeros(steps, count, dtype=torch.bool)
        seen = torch.zeros(2, steps, count) if self.lookout else None
        self.explorer.begin(count)
        self.chooser.begin()
        if self.lookout:
            self.lookout.begin()
        for t in range(steps):
            last = self.envs.world.describe()[1] if self.lookout else None
            actions, start = self.explorer(observation, blocked), perf_counter()
            observation, reward, terminated, truncated, info = self.envs.step_torch(actions)
            self.clock.simulating += perf_counter() - start
            blocked, playing[t] = info["blocked"], going
            r[t] = reward * going
            if self.lookout and seen is not None:
                self.lookout.forget((reward > 0).numpy(), last)
                seen[0, t] = torch.from_numpy(self.lookout.counts())
                self.lookout.look()
                seen[1, t] = torch.from_numpy(self.lookout.counts())
            going = going & ~(terminated | truncated)
        return r, playing, seen

    @torch.no_grad()
    def returns(self, choices: Choices, r: Tensor, playing: Tensor) -> Tensor:
        """Return (n,) of each choice, for rewards of steps (T, E)."""
        at = choices.step, choices.env
        chose, v = torch.zeros_like(playing), torch.zeros_like(r)
        chose[at], v[at] = True, self.network(choices.now).amax(1)
        config = self.config
        return option_returns(r, playing, chose, v, gamma=config.gamma, q_lambda=config.q_lambda)[at]

    def learn(self, choices: Choices, g: Tensor) -> float:
        """Train the network towards the returns (n,); the mean loss."""
        config, losses = self.config, []
        for group in self.optimizer.param_groups:
            group["lr"] = config.learning_rate * linear(1.0, 0.05, self.fraction)
        for _ in range(config.update_epochs):
            for rows in torch.randperm(len(g), generator=self.generator).split(config.batch_size):
                q = self.network(choices.now.of(rows)).gather(1, choices.pick[rows, None]).squeeze(1)
                loss = 0.5 * (q - g[rows]).square().mean()
                self.optimizer.zero_grad()
                loss.backward()
                torch.nn.utils.clip_grad_norm_(self.network.parameters(), config.max_grad_norm)
                self.optimizer.step()
                losses.append(loss.detach())
        return float(torch.stack(losses).mean()) if losses else 0.0

    def own_state(self) -> dict[str, Any]:
        """The optimiser: between two reports no episode is under way."""
        return {"optimizer": self.optimizer.state_dict()}

    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
        self.optimizer.load_state_dict(state["optimizer"])
