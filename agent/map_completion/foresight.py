"""Planners that foresee: what a network predicts of unseen ground is written into their ``prior``."""

import numpy as np
import torch
from torch import Tensor

from agent.map_completion.marks import Marks
from agent.map_completion.network import CompletionNetwork, Prediction
from agent.map_completion.windows import SEEN, Windows
from agent.planner import TUNED, Planner, PlannerConfig
from agent.planner.belief import OPAQUE, PATH
from agent.planner.config import CERTAIN
from agent.policies import Tracker
from sim.config import Config

EVERY, NEWS = 24, 16
"""Steps of an environment between two predictions, at least; cells that must be new."""

EARLY = (1, 4, 10)
"""Steps of an episode at which it predicts anyway."""

PATHS, WALLS = 0.3, 0.05
"""How surely a block must be floor for paths to lead over it unseen; and below which views end there."""

ELSEWHERE = 0.05
"""What floor counts on which targets do not lie: it may be on the way to where they do."""

LIKELY = 1.5
"""Times the density of targets where they are expected, at which a block counts as ``CERTAIN``."""

AT_ONCE = 32
"""Windows in a batch: what fits a processor's cache."""


class Foresight(Tracker):
    """Keeps planners in step, and their ``prior`` up to date by a network."""

    def __init__(self, world: Config, network: CompletionNetwork, config: PlannerConfig = TUNED) -> None:
        """For environments of the configuration ``world``."""
        self.network = network
        super().__init__(world, config, prior=True)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of that many environments."""
        super().begin(environments)
        self.windows, self.marks = Windows(self.planner), Marks(self.world, self.planner)
        self.seen, self.age = np.zeros(environments, int), np.zeros(environments, int)

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """The planners, with what the last actions led to; predictions are of the maps as they are then."""
        planner = super().look(observation, blocked)
        self.marks.note(observation)
        time = planner.read("time").numpy()
        self.seen[time == 1], self.age[time == 1] = 0, 0
        self.age += 1
        seen = planner.seen.numpy()
        due = (seen - self.seen >= NEWS) & ((self.age >= EVERY) | np.isin(time, EARLY))
        self.foresee(np.flatnonzero(due & planner.seeks.numpy()))
        return planner

    def foresee(self, environments: np.ndarray) -> None:
        """Predict in these environments (n,) int."""
        if not len(environments):
            return
        windows, corners = self.windows.read(environments)
        marks = self.marks.read(environments, corners)
        self.windows.write(environments, self.given(self.predict(windows, marks, -corners), windows))
        self.seen[environments] = self.planner.seen.numpy()[environments]
        self.age[environments] = 0

    @torch.inference_mode()
    def predict(self, windows: np.ndarray, marks: np.ndarray, starts: np.ndarray) -> Prediction:
        """What is predicted of windows (n, W, W) uint8 with ``marks`` (n, 2, W, W) uint8, of maps that began
        at ``starts`` (n, 2).
        """
        given = torch.from_numpy(windows), torch.from_numpy(marks), torch.from_numpy(starts).float()
        parts = [self.network(*each) for each in zip(*(field.split(AT_ONCE) for field in given), strict=True)]
        return Prediction(*(torch.cat(column) for column in zip(*parts, strict=True)))

    def given(self, prediction: Prediction, windows: np.ndarray) -> np.ndarray:
        """What blocks count by a prediction, ``OPAQUE`` where views end, and with ``PATH`` where paths lead,
        (n, W, W) uint8.
        """
        floor, target = prediction.floor.sigmoid().numpy(), prediction.target.exp().numpy()
        seen = windows >> 3 >= SEEN
        # Where a target is expected, this is the mean density of targets.
        dense = np.square(target).sum((1, 2)) / target.sum((1, 2)).clip(1e-12)
        likely = target / (LIKELY * dense.clip(1e-12)[:, None, None])
        count = (CERTAIN * (likely + ELSEWHERE * floor).clip(max=1)).astype(np.uint8)
        count[(floor < WALLS) & ~seen] = OPAQUE
        return count | (PATH * ((floor > PATHS) | seen)).astype(np.uint8)
