"""Parallel training runs of the paper's agent, each with its own environments, network, memory and optimiser.

One process steps all runs together and fits all networks together, which costs little more than one run. The
rules are those of ``algorithms.paper``. A run waits if its episode ends before those of the others.

Axes: N runs, E environments of a run, T steps, B samples, R rays, C channels, A actions.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import one_hot

from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.paper.learner import q_targets
from vitruvius.agent.algorithms.paper.network import PaperNetwork
from vitruvius.agent.policies.policies import MIDDLE_RAYS
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import ACTIONS, FORWARD

Layers = list[tuple[Tensor, Tensor]]
"""Weights (N, inputs, outputs) and biases (N, 1, outputs) of the dense layers, in order."""

CHUNK = 100
"""Number of steps for which random numbers are sampled together."""

NONE = np.zeros(0, np.int64)

NEAR = 0.049
"""Distance as a fraction of the range. The avoidance layer turns the body if anything but the target is
nearer."""


def stacked(networks: Sequence[PaperNetwork]) -> Layers:
    """Return the weights of all networks as stacked layers."""
    dense = [[layer for layer in network.layers if isinstance(layer, nn.Linear)] for network in networks]
    return [
        (torch.stack([one.weight.T for one in layers]), torch.stack([one.bias[None] for one in layers]))
        for layers in zip(*dense, strict=True)
    ]


def forward(layers: Layers, s: Tensor) -> tuple[list[Tensor], Tensor]:
    """Return each layer's input, and each network's values (N, B, A) for its observations (N, B, R, C).

    The values equal those of ``PaperNetwork``.
    """
    read, (weight, bias) = [s], layers[0]
    x = torch.baddbmm(bias, s.flatten(1, 2), weight).relu_().view(*s.shape[:2], -1)
    for weight, bias in layers[1:-1]:
        read.append(x)
        x = torch.baddbmm(bias, x, weight).relu_()
    read.append(x)
    weight, bias = layers[-1]
    return read, torch.baddbmm(bias, x, weight).softmax(-1)


@torch.no_grad()
def find_gradients(layers: Layers, pair: Tensor, a: Tensor, r: Tensor, ended: Tensor) -> None:
    """Write the gradients of ``paper.squared_loss`` at one step of each run into the layers' ``grad``.

    ``pair`` (N, 2, R, C) has the states before and after; ``a``, ``r`` and ``ended`` are (N,). The gradients
    are computed by hand, because autograd takes twice the time here; a test compares both.
    """
    read, q = forward(layers, pair)
    q, q_t = q.unbind(1)
    error = (q - q_targets(r, ended, q_t)[:, None]) * one_hot(a, ACTIONS)
    slope = 2 / ACTIONS * error
    slope = (q * (slope - (slope * q).sum(-1, keepdim=True)))[:, None]  # through the softmax
    for (weight, bias), both in zip(layers[:0:-1], read[:0:-1], strict=True):
        x = both[:, :1]
        torch.mul(x.mT, slope, out=weight.grad)
        torch.sum(slope, 1, keepdim=True, out=bias.grad)
        slope = torch.bmm(slope, weight.mT) * (x > 0)
    (weight, bias), s = layers[0], pair[:, 0]
    slope = slope.view(*s.shape[:2], -1)
    torch.bmm(s.mT, slope, out=weight.grad)
    torch.sum(slope, 1, keepdim=True, out=bias.grad)


class Actors:
    """Actors of networks of some configs, each in its own environments."""

    def __init__(
        self, configs: Sequence[PaperConfig], layers: Layers, envs: HouseVectorEnv, seed: int
    ) -> None:
        """Take ``envs``, which has the environments of the first run, then those of the second, and so on."""
        self.layers, self.envs, self.rng = layers, envs, np.random.default_rng(seed)
        self.runs, self.spacing = len(configs), envs.config.ray_spacing
        turn = (1 - configs[0].forward) / 2
        self.shares = turn, turn, configs[0].forward

        def flag(values: Sequence[bool]) -> np.ndarray:
            return np.repeat(values, envs.num_envs // len(configs))

        self.next = flag([config.angles == "next" for config in configs])
        self.homing = flag([config.homing for config in configs])
        self.avoids = flag([config.avoidance == "paper" for config in configs])

    def read(self, observation: np.ndarray) -> np.ndarray:
        """Return the input of the networks (N * E, R, C); each run chooses which rays' angles it reads."""
        read, rows = observation.copy(), self.next
        read[rows, :-1, 0] = observation[rows, 1:, 0]
        read[rows, -1, 0] = (observation[rows, -1, 0] * 359 - self.spacing) % 360 / 359
        return read

    def noise(self, epsilon: float) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield for each step a mask of random actions, random actions, and rotations (N * E,)."""
        shape = (CHUNK, self.envs.num_envs)
        while True:  # many steps at once, which is faster
            random = self.rng.choice(ACTIONS, shape, p=self.shares)
            yield from zip(
                self.rng.random(shape) < epsilon, random, self.rng.integers(2, size=shape), strict=True
            )

    @torch.no_grad()
    def act(self, read: np.ndarray, noise: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
        """Return actions (N * E,) int64, equal to those of ``avoidance.PaperRule`` and ``policies.home``."""
        chosen, random, rotation = noise
        is_target = read[..., 2] > 0
        near = ((read[..., 1] < NEAR) & ~is_target).any(1) & self.avoids
        homing = is_target[:, MIDDLE_RAYS].any(1) & self.homing
        _, q = forward(self.layers, torch.from_numpy(read).view(self.runs, -1, *read.shape[1:]))
        best = q.argmax(-1).flatten().numpy()
        return np.where(near, rotation, np.where(chosen, np.where(homing, FORWARD, random), best))

    def play(
        self, observation: np.ndarray, epsilon: float, keep: Callable[[np.ndarray], None] = lambda _: None
    ) -> dict[str, np.ndarray]:
        """Play an episode in each environment.

        Return ``a``, ``r``, ``ended`` and ``valid`` of each step, (T, N * E). ``valid`` is True for the steps
        of the episode. ``keep`` is called with each of the T + 1 states (N * E, R, C).
        """
        read, steps = self.read(observation), []
        keep(read)
        valid, noise = np.ones(len(read), bool), self.noise(epsilon)
        while valid.any():
            a = self.act(read, next(noise))
            seen, r, terminated, truncated, _ = self.envs.step_torch(torch.from_numpy(a))
            ended = terminated.numpy() | truncated.numpy()
            read = self.read(seen.numpy())
            keep(read)
            steps.append((a, r.numpy() * valid, ended & valid, valid))
            valid = valid & ~ended
        names = ("a", "r", "ended", "valid")
        return {name: np.stack(rows) for name, rows in zip(names, zip(*steps, strict=True), strict=True)}


class Replays:
    """The last steps of each run.

    After an episode's steps follows a row that is not ``valid``: its final state.
    """

    def __init__(self, runs: int, rows: int, rays: int, channels: int) -> None:
        """Allocate ``rows`` rows of each run."""
        self.s = torch.zeros(runs, rows, rays, channels, dtype=torch.half)
        self.a = torch.zeros(runs, rows, dtype=torch.int64)
        self.r = torch.zeros(runs, rows)
        self.ended, self.valid = (torch.zeros(runs, rows, dtype=torch.bool) for _ in range(2))
        self.rows, self.written = rows, [0] * runs

    def append(self, run: int, env: int, played: dict[str, np.ndarray]) -> np.ndarray:
        """Store an environment's episode. Return the rows of its rewarded steps."""
        steps = int(played["valid"][:, env].sum())
        rows = (self.written[run] + torch.arange(steps + 1)) % self.rows
        self.s[run, rows] = torch.from_numpy(played["s"][: steps + 1, env])
        for name in ("a", "r", "ended"):
            getattr(self, name)[run, rows[:-1]] = torch.from_numpy(played[name][:steps, env])
        self.valid[run, rows] = torch.arange(steps + 1) < steps
        self.written[run] += steps + 1
        return rows[:-1].numpy()[played["r"][:steps, env] > 0]

    def sample(self, run: int, first: np.ndarray, size: int, rng: np.random.Generator) -> Tensor:
        """Return rows (size,): the given ones first, then different random steps.

        If there are too few steps, some are repeated.
        """
        known = np.flatnonzero(self.valid[run].numpy())
        rest = max(0, size - len(first))
        others = rng.choice(known, rest, replace=len(known) < rest)
        return torch.from_numpy(np.concatenate([first[:size], others]))


class Runs:
    """Training runs of configs that differ only in seed, angles, homing, initialisation and avoidance."""

    def __init__(self, configs: Sequence[PaperConfig], envs: HouseVectorEnv) -> None:
        """Begin; ``envs`` has the environments of all runs, and NEXT_STEP autoreset."""
        self.config, self.configs, self.envs = configs[0], configs, envs
        self.layers = [
            (weight.detach().requires_grad_(), bias.detach().requires_grad_())
            for weight, bias in stacked([PaperNetwork.of(config) for config in configs])
        ]
        for part in (part for layer in self.layers for part in layer):
            part.grad = torch.zeros_like(part)
        config = self.config
        self.optimizer = torch.optim.Adam(
            [part for layer in self.layers for part in layer],
            lr=config.learning_rate,
            eps=config.adam_epsilon,
            fused=True,
        )
        self.actors = Actors(configs, self.layers, envs, config.seed)
        self.memory = Replays(len(configs), config.buffer_size, envs.config.rays, envs.config.channels)
        self.rng = np.random.default_rng([config.seed, 1])
        # The seeds of environments are far apart, so that runs share none.
        seeds = [1000 * one.seed + env for one in configs for env in range(config.num_envs)]
        self.observation = envs.reset(seed=seeds)[0]
        self.episodes, self.updates = 0, 0

    @property
    def epsilon(self) -> float:
        """Current fraction of random actions."""
        return max(self.config.final_epsilon, self.config.epsilon * self.config.epsilon_decay**self.episodes)

    def episode(self) -> dict[str, np.ndarray]:
        """Play an episode in each environment and learn from each. Return its targets and steps (N, E)."""
        each, count = self.config.num_envs, len(self.configs)
        states: list[np.ndarray] = []
        # Half precision: an error of 2 mm at the end of the range, for half of the memory.
        played = self.actors.play(
            self.observation, self.epsilon, lambda read: states.append(read.astype(np.half))
        )
        played["s"] = np.stack(states)
        for env in range(each):
            rewarded = [self.memory.append(run, run * each + env, played) for run in range(count)]
            self.fit(rewarded)
            self.episodes += 1
        self.observation = self.envs.reset()[0]
        shape = (count, each)
        return {
            "targets": played["r"].sum(0).astype(int).reshape(shape),
            "steps": played["valid"].sum(0).reshape(shape),
        }

    def fit(self, rewarded: Sequence[np.ndarray]) -> None:
        """Fit each network to a batch of its own steps, one after the other."""
        memory, config = self.memory, self.config
        rows = torch.stack(
            [memory.sample(run, first, config.batch_size, self.rng) for run, first in enumerate(rewarded)]
        )
        at = torch.arange(len(rows))[:, None]
        pairs = torch.stack([memory.s[at, rows], memory.s[at, (rows + 1) % memory.rows]], 2).float()
        a, r, ended = (part[at, rows] for part in (memory.a, memory.r, memory.ended))
        for pair, *step in zip(*(part.unbind(1) for part in (pairs, a, r, ended)), strict=True):
            find_gradients(self.layers, pair, *step)
            self.optimizer.param_groups[0]["lr"] = config.learning_rate / (1 + config.lr_decay * self.updates)
            self.optimizer.step()
            self.updates += 1

    def spread(self) -> list[float]:
        """Return the spread of each run's values between the states that it remembers.

        The spread is 0 if the run's softmax is saturated, so that the run learns nothing more.
        """
        rows = torch.stack(
            [self.memory.sample(run, NONE, 1000, self.rng) for run in range(len(self.configs))]
        )
        states = self.memory.s[torch.arange(len(rows))[:, None], rows].float()
        with torch.no_grad():
            return forward(self.layers, states)[1].std(1).mean(-1).tolist()

    def state(self) -> dict[str, Any]:
        """Return everything that the next episode depends on."""
        return {
            "layers": [[part.detach() for part in layer] for layer in self.layers],
            "optimizer": self.optimizer.state_dict(),
            "memory": self.memory.__dict__,
            "rngs": [rng.bit_generator.state for rng in (self.rng, self.actors.rng)],
            "envs": {name: torch.from_numpy(array) for name, array in self.envs.state.items()},
            "observation": torch.from_numpy(self.observation),
            "counts": (self.episodes, self.updates),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from a state."""
        with torch.no_grad():
            for mine, given in zip(self.layers, state["layers"], strict=True):
                for part, value in zip(mine, given, strict=True):
                    part.copy_(value)
        self.optimizer.load_state_dict(state["optimizer"])
        self.memory.__dict__.update(state["memory"])
        for rng, kept in zip((self.rng, self.actors.rng), state["rngs"], strict=True):
            rng.bit_generator.state = kept
        self.envs.state = {name: tensor.numpy() for name, tensor in state["envs"].items()}
        self.observation = state["observation"].numpy()
        self.episodes, self.updates = state["counts"]
