"""Common parts of learners whose explorers make the maps that they are trained on."""

import json
from abc import abstractmethod
from time import perf_counter
from typing import Any

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.learning.learner import Learner, Progress, Tally
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv

LAST = ("s", "blocked", "ended")
"""Attributes from which the next step starts."""


class MapLearner(Learner):
    """Run in turns: explorers advance by some steps, then the network learns from what they saw.

    Episodes are cut short at random, so that there are maps of all ages.
    """

    config: Any

    epsilon = 0.0
    """Fraction of the explorers' choices that are not the network's."""

    def __init__(self, config: Any, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has NEXT_STEP autoreset."""
        super().__init__(config, envs, report=config.num_steps)
        self.optimizer = torch.optim.AdamW(
            [each for each in self.network.parameters() if each.requires_grad],
            lr=config.learning_rate,
            weight_decay=1e-4,
            foreach=True,
        )
        self.random = np.random.default_rng(self.seed)
        self.explorer = self.explorer_of()
        self.explorer.begin(envs.num_envs)
        self.tracker = self.explorer.tracker

    def explorer_of(self) -> Explorer:
        """Return the explorer that makes the maps."""
        return Explorer(self.avoidance, self.envs.config)

    def iterate(self) -> Progress:
        """Explore, then learn from the maps."""
        start, tally = perf_counter(), Tally()
        self.restart()
        for _ in range(self.config.num_steps):
            self.step(tally)
        loss = self.learn()
        self.clock.all += perf_counter() - start
        return self.report(tally, loss=loss, epsilon=self.epsilon)

    def restart(self) -> None:
        """Begin other episodes in a fraction of the environments."""
        mask = self.random.random(self.envs.num_envs) < self.config.restarts
        if mask.any():
            observation, _ = self.envs.reset(options={"reset_mask": mask})
            self.s, begun = torch.as_tensor(observation), torch.from_numpy(mask)
            self.tracker.fresh |= begun
            self.blocked, self.ended = self.blocked & ~begun, self.ended & ~begun

    def step(self, tally: Tally) -> None:
        """Step all environments."""
        before, start, ended = self.explorer.interventions, perf_counter(), self.ended
        actions = self.act()
        self.clock.mapping += perf_counter() - start
        reward, _, _ = self.step_envs(actions)
        tally.add(reward, ~ended, torch.tensor(self.explorer.interventions - before))
        # The step after an end began the next episode.
        self.tracker.fresh |= ended

    @abstractmethod
    def act(self) -> Tensor:
        """Return the explorers' actions (E,), and note what training needs."""

    @abstractmethod
    def learn(self) -> float:
        """Learn from what was noted; return the mean loss."""

    def own_state(self) -> dict[str, Any]:
        """Return the optimiser's state, the maps, and where the bodies are."""
        return {
            "optimizer": self.optimizer.state_dict(),
            "map": self.tracker.planner.state,
            "last": {name: getattr(self, name).clone() for name in LAST},
            "tracker": {name: getattr(self.tracker, name).clone() for name in ("actions", "fresh")},
            "random": json.dumps(self.random.bit_generator.state),
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        self.optimizer.load_state_dict(state["optimizer"])
        self.tracker.planner.state = state["map"]
        for owner, values in ((self, state["last"]), (self.tracker, state["tracker"])):
            for name, value in values.items():
                setattr(owner, name, value)
        self.random.bit_generator.state = json.loads(state["random"])
