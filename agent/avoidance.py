"""The avoidance layer: what a higher layer forbids to those below it (Brooks 1986, the subsumption layer).

A layer reads the observations (E, R, C), and whether the last move was blocked (E,) bool, and says which
actions it allows (E, A) bool. ``subsume`` then takes the best allowed action by the preferences of the layer
below, be it a network or a random walk. A new layer is a function or a class with one method, and ``Stack``
puts it under others: see ``examples/own_behaviour.py``.
"""

from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from sim.actions import ACTIONS, FORWARD, LEFT, RIGHT
from sim.config import Config

SPREAD = 3.0
"""Standard deviations of noise that are allowed for."""


class Layer(Protocol):
    """A behaviour that may overrule those below it."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, A) bool the layer allows, at least one of them in each row."""
        ...


class Shield:
    """Forbids ``forward`` where the rays say that the body's path is not free, or a bump has just said so.

    Both rotations are always allowed: a body that turns in place touches nothing. The region that an
    axis-aligned square sweeps in one step is convex and holds the eye, so it is free as far as the rays tell
    exactly if each one reaches beyond the region's edge: one table of distances a heading, one comparison a
    ray. Headings along the walls and headings at 45 degrees to them sweep different regions; which of the
    two it is shows in the rays, as every wall is parallel to an axis. A corner between two rays, or beside
    the body and so out of sight, is met by a bump; the same move again would meet it too.
    """

    def __init__(
        self,
        angles: np.ndarray,
        ray_range: float,
        body: float,
        step: float,
        margin: float = 0.005,
        noise: float = 0.0,
        distance: int = -2,
        door: int | None = None,
        device: str = "cpu",
    ) -> None:
        """Make the layer for rays at ``angles`` (R,) radians from the heading, of this range.

        ``body`` is the side of the square, ``step`` its move along each axis, ``margin`` the air that it
        keeps on every side, ``noise`` the standard deviation of the rays' distances; metres.
        ``distance`` is the observations' column that has it, ``door`` the one that says which rays end on a
        closed door, where there are such: a body may walk at it, which opens it. ``device`` is the
        observations'.
        """
        self.distance, self.door = distance, door
        self.apart, self.tolerance = pair(noise), 1e-4 + SPREAD * 2**0.5 * noise
        self.most = 1 - SPREAD * noise / ray_range
        clear = clearance(angles, body, step, margin) / ray_range
        self.clear = torch.tensor(clear, dtype=torch.float32, device=device)
        self.at_door = 1.5 * self.clear.amax(0)
        # Where the body stands straight, the walls run along the first two; diagonally, along the others.
        turned = angles + np.pi / 4 * np.array([[0], [2], [1], [3]])
        self.across = torch.tensor(np.sin(turned) * ray_range, dtype=torch.float32, device=device)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, 3) bool are allowed."""
        distance, passed = observation[..., self.distance], observation[..., -1]
        if self.door is not None:
            is_door = observation[..., self.door]
            passed = passed + is_door
            # A bump before a door is a push.
            blocked = blocked & ~((is_door > 0) & (distance < self.at_door)).any(-1)
        far = (distance + passed)[..., None, :]  # 1 or more where the target is: it is never in the way
        free = (far - self.clear).amin(-1) >= 0
        free, free_diagonally = free.unbind(-1)
        # The vote is costly and rarely needed: only where the two regions differ.
        asked = free != free_diagonally
        free[asked] = free[asked] ^ self.diagonal(distance[asked])
        allowed = blocked.new_ones(*blocked.shape, ACTIONS)
        allowed[..., FORWARD] = free & ~blocked
        return allowed

    def diagonal(self, distance: Tensor) -> Tensor:
        """Whether each heading (E,) lies at 45 degrees to the walls, from the rays' distances (E, R).

        Where two rays meet one wall, the line through both points runs along an axis: along or
        across the heading if that is straight, at 45 degrees to it if it is diagonal. The pairs vote.
        """
        place = distance[..., None, :] * self.across
        same = (place[..., self.apart :] - place[..., : -self.apart]).abs_() < self.tolerance
        votes = (same & (distance[..., None, self.apart :] < self.most)).sum(-1)
        return votes[..., 2:].sum(-1) > votes[..., :2].sum(-1)


def pair(noise: float) -> int:
    """Rays from one to the other of a pair that shows how the heading lies to the walls: by exact rays the
    next one; by noisy ones so far that two ends on one wall lie further along it than noise reaches.
    """
    return 4 if noise > 0 else 1


def clearance(angles: np.ndarray, body: float, step: float, margin: float) -> np.ndarray:
    """How far each ray (2, R) must reach for a step forward to be free, straight and diagonal, metres.

    ``angles`` (R,) radians from the heading, ``body`` the side of the square, ``step`` its move along each
    axis, ``margin`` the air that it keeps on every side.
    """
    half, sine, cosine = body / 2 + margin, np.abs(np.sin(angles)), np.cos(angles)
    with np.errstate(divide="ignore"):  # the ray straight ahead leaves by the front alone
        straight = np.minimum((half + step) / cosine, half / sine)
        diagonal = np.sqrt(2) * np.minimum((half + step) / (cosine + sine), half / sine)
    return np.stack([straight, diagonal])


def air(world: Config) -> float:
    """Metres that the shield keeps on every side of the body. What stands in the next cell touches a body
    that fills its own: there it is below 0, as distances are rounded. So it is where rays are noisy: of the
    many that a door's frame is near to, one is mostly too short, and a bump costs but a step.
    """
    return (-0.005 if world.in_cells else 0.005) - 2.5 * world.noise


class PaperRule:
    """The paper's rule: a random rotation whenever anything but the target is nearer than a threshold.

    It overrules the network altogether, and a door of 0.76 m stops most bodies that would pass it.
    """

    def __init__(self, generator: torch.Generator, threshold: float = 0.049, distance: int = -2) -> None:
        """Take a threshold as a fraction of the range (the paper's 10.8 px of 220), a generator, and the
        observations' column that has the distance.
        """
        self.generator, self.threshold, self.distance = generator, threshold, distance

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, 3) bool are allowed: all, or one rotation alone."""
        distance, is_target = observation[..., self.distance], observation[..., -1] > 0
        far = (distance.masked_fill(is_target, 1.0) >= self.threshold).all(-1)
        left = torch.rand(far.shape, generator=self.generator, device=far.device) < 0.5
        allowed = torch.empty(*far.shape, ACTIONS, dtype=torch.bool, device=far.device)
        allowed[..., LEFT], allowed[..., RIGHT], allowed[..., FORWARD] = far | left, far | ~left, far
        return allowed


class Free:
    """A layer that allows everything."""

    def __init__(self, actions: int = ACTIONS) -> None:
        """Of so many actions."""
        self.actions = actions

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, A) bool are allowed: all."""
        return torch.ones(len(blocked), self.actions, dtype=torch.bool, device=blocked.device)


class Stack:
    """Layers in order of priority, the highest first. Each restricts the choice that those above it leave;
    where it would leave nothing, it is ignored. ``Stack(shield, own)`` over a network: three layers.
    """

    def __init__(self, *layers: Layer) -> None:
        self.layers = layers

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Which actions (E, A) bool are allowed."""
        allowed = self.layers[0](observation, blocked)
        for layer in self.layers[1:]:
            both = allowed & layer(observation, blocked)
            allowed = torch.where(both.any(-1, keepdim=True), both, allowed)
        return allowed


def subsume(preference: Tensor, allowed: Tensor) -> Tensor:
    """The allowed action (E,) int64 of greatest preference (E, A)."""
    return preference.masked_fill(~allowed, -torch.inf).argmax(-1)


def best_value(q: Tensor, allowed: Tensor) -> Tensor:
    """The greatest Q-value (E,) among the allowed actions: the bootstrap under the same layer as the acts."""
    return q.masked_fill(~allowed, -torch.inf).amax(-1)


def random_preference(like: Tensor, generator: torch.Generator, forward: float = 0.93) -> Tensor:
    """Preferences (..., A) whose best allowed action is a random one, ``forward`` with that probability, all
    others alike.

    Gumbel noise on log-probabilities: its argmax is a sample of them, also under a mask.
    """
    share = torch.full(like.shape[-1:], (1 - forward) / (like.shape[-1] - 1), device=like.device)
    share[FORWARD] = forward
    uniform = torch.rand(like.shape, generator=generator, device=like.device)
    return share.log() - (-(uniform.clamp(1e-12, 1 - 1e-7)).log()).log()
