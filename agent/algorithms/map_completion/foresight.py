"""Planners with map prediction: a network's predictions of unseen ground are written into their ``prior``."""

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.map_completion.marks import Marks
from vitruvius.agent.algorithms.map_completion.network import WINDOW, CompletionNetwork, Prediction
from vitruvius.agent.algorithms.map_completion.windows import LOOKED, Windows, seen
from vitruvius.agent.planner import TUNED, Planner, PlannerConfig
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.planner.viewpoints.belief import BLOCKED, PATH, WALL
from vitruvius.agent.policies.policies import Tracker
from vitruvius.sim.config import Config

MIN_STEPS_BETWEEN, MIN_NEW_CELLS = 48, 64
"""Steps of an environment between two predictions, and cells that must be new, at least. A pick-up always
leads to a prediction."""

MAX_STEPS_BETWEEN = 384
"""Steps after which the network predicts again even if nothing is new, as the planner has looked at more."""

EARLY_STEPS = (1, 5, 9)
"""Steps of an episode at which the network predicts before ``MIN_STEPS_BETWEEN`` have passed."""

STEP_INTERVAL = 4
"""Interval, in steps of an episode, of the predictions: environments that began together then make larger
batches, which take less time per window."""

MIN_FLOOR_PROBABILITY = 0.05
"""Least probability of floor at which paths may lead over an unseen block and targets are sought there."""

DITHER = (np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]]) + 0.5) / 16
"""Ordered dither, added by the block's place before weights become integers. Their mean over some blocks is
then right, even if each weight is less than one (Bayer 1973)."""

BATCH_WINDOWS = 32
"""Number of windows in a batch: as many as fit a processor's cache."""


class Foresight(Tracker):
    """Tracker that steps planners and updates their ``prior`` with a network."""

    def __init__(self, world: Config, network: CompletionNetwork, config: PlannerConfig = TUNED) -> None:
        self.network = network
        super().__init__(world, config, prior=True)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        super().begin(environments)
        self.windows, self.marks = Windows(self.planner), Marks(self.world, self.planner)
        self.seen, self.found, self.age = np.zeros((3, environments), int)

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """Step the planners with what the last actions led to, then predict; return the planners."""
        planner = super().look(observation, blocked)
        self.marks.note(observation)
        time = planner.read("time").numpy()
        self.seen[time == 1], self.found[time == 1], self.age[time == 1] = 0, 0, 0
        self.age += 1
        if (now := time % STEP_INTERVAL == 1).any():
            due = (planner.seen.numpy() - self.seen >= MIN_NEW_CELLS) & (
                (self.age >= MIN_STEPS_BETWEEN) | np.isin(time, EARLY_STEPS)
            )
            due |= (planner.read("found").numpy() != self.found) | (self.age >= MAX_STEPS_BETWEEN)
            self.foresee(np.flatnonzero(now & due & planner.seeks.numpy()))
        return planner

    def foresee(self, environments: np.ndarray) -> None:
        """Predict in these environments (n,) int."""
        if not len(environments):
            return
        windows, corners = self.windows.read(environments)
        marks = self.marks.read(environments, corners)
        self.windows.write(environments, self.given(self.predict(windows, marks, -corners), windows))
        self.planner.choose_again(environments)
        self.seen[environments] = self.planner.seen.numpy()[environments]
        self.found[environments] = self.planner.read("found").numpy()[environments]
        self.age[environments] = 0

    @torch.inference_mode()
    def predict(self, windows: np.ndarray, marks: np.ndarray, starts: np.ndarray) -> Prediction:
        """Return the predictions for windows (n, W, W) uint8 with ``marks`` (n, 2, W, W) uint8.

        The maps of the windows began at ``starts`` (n, 2).
        """
        given = torch.from_numpy(windows), torch.from_numpy(marks), torch.from_numpy(starts).float()
        parts = [
            self.network(*each) for each in zip(*(field.split(BATCH_WINDOWS) for field in given), strict=True)
        ]
        return Prediction(*(torch.cat(column) for column in zip(*parts, strict=True)))

    def given(self, prediction: Prediction, windows: np.ndarray) -> np.ndarray:
        """Return what a prediction says as the planner's ``prior`` stores it, (n, W, W) uint16.

        A value holds the block's weight, ``PATH`` if paths may lead there, and the probability that sight
        ends there.
        """
        floor, sight = (logits.sigmoid().numpy() for logits in (prediction.floor, prediction.sight))
        target, known = prediction.target.exp().numpy(), seen(windows)
        # Mean density of the targets that are expected where the planner has not looked; a block of this
        # density counts as certain.
        left = np.where(windows & LOOKED, 0, target)
        dense = np.square(left).sum((1, 2)) / left.sum((1, 2)).clip(1e-12)
        count = CERTAIN * target / dense.clip(1e-12)[:, None, None]
        count = (count + np.tile(DITHER, (WINDOW // 4, WINDOW // 4))).clip(max=CERTAIN).astype(np.uint16)
        # Every block that may be floor counts at least 1: once all likely places are seen, the unlikely
        # follow.
        path = known | (floor >= MIN_FLOOR_PROBABILITY)
        count = np.where(path, count.clip(1), 0)
        wall = np.rint(BLOCKED * (1 - np.where(known, 1.0, sight))).astype(np.uint16)
        return wall << WALL | (PATH * path).astype(np.uint16) | count
