"""Learning map completion, supervised: explorers make the maps, the houses tell what was to be predicted."""

import json
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from agent.build import network_of
from agent.learner import Learner, Progress, Tally, linear
from agent.map_completion.config import CompletionConfig
from agent.map_completion.network import CompletionNetwork, Prediction
from agent.map_completion.truth import FLOOR, TARGET, UNKNOWN, Truth
from agent.map_completion.windows import SEEN, Windows
from agent.policies import Explorer
from sim import HouseVectorEnv

NEAR = 12
"""Blocks from seen ground within which unseen ground counts fully."""

FAR = 0.05
"""What ground counts that lies farther, or that was seen."""

ROOMS = 0.3
"""What the types of rooms count in the loss."""


class MapCompletion(Learner):
    """A run of map completion. In each turn explorers go on for some steps; then the network learns from a
    window of each one's map. Episodes are cut short at random, so that there are maps of all ages.
    """

    config: CompletionConfig
    network: CompletionNetwork

    def __init__(self, config: CompletionConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has NEXT_STEP autoreset. The types of rooms are those of its houses, where
        the config names none.
        """
        found = sorted({room.type for house in envs.houses for room in house.rooms})
        config = replace(config, rooms=config.rooms or tuple(found))
        super().__init__(config, envs, network_of(config), report=config.num_steps)
        self.optimizer = torch.optim.AdamW(
            self.network.parameters(), lr=config.learning_rate, weight_decay=1e-4, foreach=True
        )
        self.random = np.random.default_rng(self.seed)
        self.explorer = Explorer(self.avoidance, envs.config)
        self.explorer.begin(envs.num_envs)
        self.tracker = self.explorer.tracker
        self.windows, self.truth = Windows(self.tracker.planner), Truth(envs, config.rooms)
        self.observation = self.reset_envs()
        self.blocked, self.ended = torch.zeros(2, envs.num_envs, dtype=torch.bool)

    def iterate(self) -> Progress:
        """Explore, and learn from the maps."""
        start, tally = perf_counter(), Tally()
        self.restart()
        for _ in range(self.config.num_steps):
            self.step(tally)
        exploring = perf_counter() - start
        loss = self.learn()
        self.clock.simulating += exploring
        self.clock.all += perf_counter() - start
        return self.report(tally, loss=loss, epsilon=0.0)

    def restart(self) -> None:
        """Begin other episodes in a share of the environments."""
        mask = self.random.random(self.envs.num_envs) < self.config.restarts
        if mask.any():
            observation, _ = self.envs.reset(options={"reset_mask": mask})
            self.observation, begun = torch.as_tensor(observation), torch.from_numpy(mask)
            self.tracker.fresh |= begun
            self.blocked &= ~begun
            self.ended &= ~begun

    def step(self, tally: Tally) -> None:
        """A step of all explorers."""
        before = self.explorer.interventions
        actions = self.explorer(self.observation, self.blocked)
        self.truth.begin(np.flatnonzero(self.tracker.planner.read("time").numpy() == 1))
        observation, reward, terminated, truncated, info = self.envs.step_torch(actions)
        tally.add(reward, ~self.ended, torch.tensor(self.explorer.interventions - before))
        # The step after an end began the next episode.
        self.tracker.fresh |= self.ended
        self.ended = terminated | truncated
        self.observation, self.blocked = observation.clone(), info["blocked"].clone()

    def learn(self) -> float:
        """Learn from a window of each map, in the config's epochs; the mean loss."""
        config = self.config
        for group in self.optimizer.param_groups:
            group["lr"] = config.learning_rate * linear(1.0, config.final_lr_fraction, self.fraction)
        everyone = np.arange(self.envs.num_envs)
        windows, corners = self.windows.read(everyone)
        bits, rooms = self.truth.read(self.tracker.planner, everyone, corners)
        fields = [torch.from_numpy(each) for each in (windows, -corners.astype(np.float32), bits, rooms)]
        losses = []
        for _ in range(config.update_epochs):
            for part in torch.randperm(len(corners), generator=self.generator).split(config.batch_size):
                windows, starts, bits, rooms = (each[part] for each in fields)
                losses.append(self.update(*turned(windows, starts, bits, rooms, self.random)))
        return float(torch.stack(losses).mean())

    def update(self, windows: Tensor, starts: Tensor, bits: Tensor, rooms: Tensor) -> Tensor:
        """Learn from a batch; the loss."""
        loss = completion_loss(self.network(windows, starts), windows, bits, rooms)
        self.optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), self.config.max_grad_norm)
        self.optimizer.step()
        return loss.detach()

    def own_state(self) -> dict[str, Any]:
        """The optimiser, the maps, and where the explorers are."""
        return {
            "optimizer": self.optimizer.state_dict(),
            "map": self.tracker.planner.state,
            "truth": {name: torch.from_numpy(getattr(self.truth, name)) for name in ("pose", "house")},
            "last": {name: getattr(self, name).clone() for name in LAST},
            "tracker": {name: getattr(self.tracker, name).clone() for name in ("actions", "fresh")},
            "random": json.dumps(self.random.bit_generator.state),
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
        self.optimizer.load_state_dict(state["optimizer"])
        self.tracker.planner.state = state["map"]
        for name, value in state["truth"].items():
            setattr(self.truth, name, value.numpy())
        for owner, values in ((self, state["last"]), (self.tracker, state["tracker"])):
            for name, value in values.items():
                setattr(owner, name, value)
        self.random.bit_generator.state = json.loads(state["random"])


LAST = ("observation", "blocked", "ended")
"""What the next step starts from."""


def completion_loss(prediction: Prediction, windows: Tensor, bits: Tensor, rooms: Tensor) -> Tensor:
    """The mean cross-entropy of a prediction for ``windows`` (n, W, W) whose truth is ``bits`` and ``rooms``
    (n, W, W): of floor, above all where it was not seen but is near to what was; of targets and of rooms
    where there is floor.
    """
    seen = windows >> 3 >= SEEN
    along = F.max_pool2d(seen[:, None].float(), (1, 2 * NEAR + 1), 1, (0, NEAR))
    about = F.max_pool2d(along, (2 * NEAR + 1, 1), 1, (NEAR, 0))[:, 0]
    weight = torch.where(seen, FAR, about.clamp(min=FAR))
    floor, target = (bits & FLOOR > 0).float(), (bits & TARGET > 0).float()
    inside, types = floor * about, prediction.rooms.shape[1]
    floors = F.binary_cross_entropy_with_logits(prediction.floor, floor, reduction="none")
    targets = F.binary_cross_entropy_with_logits(prediction.target, target, reduction="none")
    kinds = F.cross_entropy(prediction.rooms, rooms.long().clamp(max=types - 1), reduction="none")
    return mean(floors, weight) + mean(targets, inside) + ROOMS * mean(kinds, inside * (rooms != UNKNOWN))


def mean(values: Tensor, weight: Tensor) -> Tensor:
    """The weighted mean, 0 where nothing counts."""
    return (values * weight).sum() / weight.sum().clamp(min=1e-6)


def turned(
    windows: Tensor, starts: Tensor, bits: Tensor, rooms: Tensor, random: np.random.Generator
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """The same houses, turned by quarters and mirrored at random: fields (n, W, W), and ``starts`` (n, 2)."""
    quarters, mirrored, last = int(random.integers(4)), random.random() < 0.5, windows.shape[-1] - 1
    south, east = starts.unbind(1)
    for _ in range(quarters):
        south, east = last - east, south

    def turn(field: Tensor) -> Tensor:
        field = torch.rot90(field, quarters, (1, 2))
        return (field.flip(2) if mirrored else field).contiguous()

    starts = torch.stack([south, last - east if mirrored else east], 1)
    return turn(windows), starts, turn(bits), turn(rooms)
