"""Supervised training of map completion: explorers make the maps, the houses give the labels."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from vitruvius.agent.algorithms.map_completion.config import CompletionConfig
from vitruvius.agent.algorithms.map_completion.foresight import Foresight
from vitruvius.agent.algorithms.map_completion.marks import Marks
from vitruvius.agent.algorithms.map_completion.network import CompletionNetwork, Prediction
from vitruvius.agent.algorithms.map_completion.sight import cast_rays
from vitruvius.agent.algorithms.map_completion.truth import GROUND, UNKNOWN, Truth
from vitruvius.agent.algorithms.map_completion.windows import Windows, seen
from vitruvius.agent.learning.environments import require_own_maps, shield
from vitruvius.agent.learning.map_learner import MapLearner
from vitruvius.agent.learning.simulator import simulator
from vitruvius.agent.policies.network import seeded
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv

NEAR_BLOCKS = 12
"""Distance from seen ground, in blocks, within which unseen ground has full weight."""

SQUARE_BLOCKS = 4
"""Side, in blocks, of the squares by which this distance is measured."""

FAR_WEIGHT = 0.05
"""Weight of ground that lies farther away or was seen."""

SIGHT, TARGETS, KINDS = 1.0, 0.2, 0.1
"""Weights of sight, the place of the target and the kinds of ground in the loss, relative to floor."""


class WindowBatch(NamedTuple):
    """Inputs and labels of n windows, from which the network learns."""

    windows: Tensor
    """(n, W, W) uint8, as ``Windows.read`` returns them."""

    marks: Tensor
    """(n, 2, W, W) uint8, as ``Marks.read`` returns them."""

    starts: Tensor
    """(n, 2) float32: starts of the episodes, blocks south and east of the first block."""

    floor: Tensor
    """(n, W, W) uint8; ``floor``, ``target`` and ``kinds`` as in ``truth.Blocks``."""

    target: Tensor
    """(n, W, W) float32."""

    kinds: Tensor
    """(n, W, W) uint8."""

    rays: Tensor
    """(n, W, W) float32; ``rays`` and ``passed`` as in ``sight.SightLines``."""

    passed: Tensor
    """(n, W, W) float32."""


class MapCompletion(MapLearner):
    """Run of map completion.

    In each turn the explorers advance by some steps; then the network learns from a window of each one's map.
    """

    config: CompletionConfig
    network: CompletionNetwork

    @staticmethod
    def network_of(config: CompletionConfig) -> CompletionNetwork:
        """Return a new network: see ``Learner``."""
        kinds = simulator(config).kinds
        with seeded(config.seed):
            return CompletionNetwork(len(GROUND) + len(config.kinds), len(kinds), config.channels)

    @staticmethod
    def policy_of(
        network: CompletionNetwork, config: CompletionConfig, envs: HouseVectorEnv, seed: int = 0
    ) -> Explorer:
        """Return an explorer whose planners use the network's predictions."""
        require_own_maps(config, envs)
        return Explorer(shield(envs), envs.config, tracker=Foresight(envs.config, network))

    def __init__(self, config: CompletionConfig, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has NEXT_STEP autoreset.

        If the config names no kinds of ground, the kinds are those of the environments' houses.
        """
        rooms = [room for house in envs.houses for room in house.rooms]
        found = {room.type for room in rooms} | {piece.type for room in rooms for piece in room.pieces}
        config = replace(config, kinds=config.kinds or tuple(sorted(found)))
        super().__init__(config, envs)
        planner = self.tracker.planner
        self.windows, self.marks = Windows(planner), Marks(envs.config, planner)
        self.truth = Truth(envs, config.kinds, planner.cell)
        self.reset_envs()

    def act(self) -> Tensor:
        """Return the explorer's actions: see ``MapLearner``.

        Note the true house where an episode has begun.
        """
        actions = self.explorer(self.s, self.blocked)
        self.marks.note(self.s)
        self.truth.begin(np.flatnonzero(self.tracker.planner.read("time").numpy() == 1))
        return actions

    def learn(self) -> float:
        """Learn from a window of each map, in the config's epochs; return the mean loss."""
        config = self.config
        self.anneal(config.final_lr_fraction)
        batch, losses = self.batch(), []
        for _ in range(config.update_epochs):
            order = torch.randperm(self.envs.num_envs, generator=self.generator)
            for part in order.split(config.batch_size):
                losses.append(self.update(turned(WindowBatch(*(each[part] for each in batch)), self.random)))
        return float(torch.stack(losses).mean())

    def batch(self) -> WindowBatch:
        """Return a window of each map, with its labels."""
        everyone = np.arange(self.envs.num_envs)
        windows, corners = self.windows.read(everyone)
        given = windows, self.marks.read(everyone, corners), -corners.astype(np.float32)
        truth = self.truth.read(everyone, corners)
        sight = cast_rays(windows, truth.solid, self.random)
        return WindowBatch(*map(torch.from_numpy, (*given, truth.floor, truth.target, truth.kinds, *sight)))

    def update(self, batch: WindowBatch) -> Tensor:
        """Learn from a batch; return the loss."""
        loss = completion_loss(self.network(batch.windows, batch.marks, batch.starts), batch)
        return self.descend(loss, self.config.max_grad_norm)

    def own_state(self) -> dict[str, Any]:
        """Return the learner's state: see ``MapLearner``.

        It includes the marks, and the houses and poses noted.
        """
        return super().own_state() | {
            "marks": {name: torch.from_numpy(getattr(self.marks, name)) for name in ("blocks", "found")},
            "truth": {name: torch.from_numpy(getattr(self.truth, name)) for name in ("pose", "house")},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        super().restore_own(state)
        for owner, values in ((self.truth, state["truth"]), (self.marks, state["marks"])):
            for name, value in values.items():
                setattr(owner, name, value.numpy())


def completion_loss(prediction: Prediction, batch: WindowBatch) -> Tensor:
    """Return the cross-entropy of a prediction for a batch.

    It sums four terms: floor; the kind of ground; the next target's block; and whether a ray that reaches a
    block passes it. Floor and kinds weigh most where ground is unseen but near to seen ground.
    """
    known = seen(batch.windows)
    # Squares of COARSE blocks: a wide pool over single blocks takes a quarter of all the time.
    squares = F.max_pool2d(known[:, None].float(), SQUARE_BLOCKS)
    near = F.max_pool2d(squares, 2 * NEAR_BLOCKS // SQUARE_BLOCKS + 1, 1, NEAR_BLOCKS // SQUARE_BLOCKS)
    about = F.interpolate(near, scale_factor=float(SQUARE_BLOCKS))[:, 0]
    weight = torch.where(known, FAR_WEIGHT, about.clamp(min=FAR_WEIGHT))
    floor = F.binary_cross_entropy_with_logits(prediction.floor, batch.floor.float(), reduction="none")
    kinds, weights = (each[:, ::2, ::2] for each in (batch.kinds, weight))
    told = kinds != UNKNOWN
    logits = prediction.kinds.permute(0, 2, 3, 1).flatten(0, 2)  # as they lie in memory
    ground = F.cross_entropy(logits, (kinds.long() * told).flatten(), reduction="none").view_as(weights)
    target = -(batch.target * prediction.target).sum((1, 2)) / batch.target.sum((1, 2)).clamp(min=1e-6)
    sight = F.binary_cross_entropy_with_logits(prediction.sight, batch.passed, reduction="none")
    blocks = mean(floor, weight) + SIGHT * mean(sight, batch.rays)
    return blocks + TARGETS * target.mean() + KINDS * mean(ground, weights * told)


def mean(values: Tensor, weight: Tensor) -> Tensor:
    """Return the weighted mean, 0 without any weight."""
    return (values * weight).sum() / weight.sum().clamp(min=1e-6)


def turned(batch: WindowBatch, random: np.random.Generator) -> WindowBatch:
    """Return the same houses, rotated by random quarter turns and mirrored at random."""
    quarters, mirrored = int(random.integers(4)), random.random() < 0.5
    last = batch.windows.shape[-1] - 1
    south, east = batch.starts.unbind(1)
    for _ in range(quarters):
        south, east = last - east, south
    starts = torch.stack([south, last - east if mirrored else east], 1)

    def turn(field: Tensor) -> Tensor:
        field = torch.rot90(field, quarters, (-2, -1))
        return (field.flip(-1) if mirrored else field).contiguous()

    fields = {name: turn(field) for name, field in batch._asdict().items() if name != "starts"}
    return WindowBatch(starts=starts, **fields)
