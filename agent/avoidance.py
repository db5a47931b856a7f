"""Avoidance layer: a higher layer that forbids actions to the layers below it.

The design is the subsumption architecture (Brooks 1986). A layer reads the observations (E, R, C) and a mask
(E,) bool of blocked last moves, and returns a mask (E, A) bool of the actions it allows. ``subsume`` then
takes the best allowed action by the preferences of the layer below, which may be a network or a random walk.
A new layer is a function or a class with one method. ``Stack`` puts layers in order: see
``examples/own_behaviour.py``.
"""

from typing import Protocol

import numpy as np
import torch
from torch import Tensor

from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT, RIGHT
from vitruvius.sim.config import Config

NOISE_DEVIATIONS = 3.0
"""Margin for noise, in standard deviations."""


class Layer(Protocol):
    """Behaviour that may overrule the layers below it."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return the mask (E, A) bool of allowed actions, with at least one in each row."""
        ...


class Shield:
    """Layer that forbids ``forward`` if the body's path is not free by the rays, or after a collision.

    Both rotations are always allowed: a body that turns in place touches nothing. The region that an
    axis-aligned square sweeps in one step is convex and contains the eye. So the region is free, as far as
    the rays show, exactly if each ray reaches beyond the region's edge. The test needs one table of distances
    for each kind of heading and one comparison for each ray.

    Headings along the walls and headings at 45 degrees to them sweep different regions. The rays show which
    of the two applies, as every wall is parallel to an axis. The rays miss a corner between two rays, or one
    next to the body and out of sight. The body then collides with it, and the layer forbids the same move
    again.
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
        """Make the layer for rays at ``angles`` (R,) radians from the heading, of range ``ray_range``.

        ``body`` is the side of the square, ``step`` its move along each axis, ``margin`` the gap that it
        keeps on every side, ``noise`` the standard deviation of the rays' distances; all in metres.

        ``distance`` is the observations' column with the distance. ``door`` is the column that is 1 for rays
        that end on a closed door, or None without such doors: a body may walk at a door, which opens it.
        ``device`` is the observations' device.
        """
        self.distance, self.door = distance, door
        self.apart, self.tolerance = pair(noise), 1e-4 + NOISE_DEVIATIONS * 2**0.5 * noise
        self.most = 1 - NOISE_DEVIATIONS * noise / ray_range
        clear = clearance(angles, body, step, margin) / ray_range
        self.clear = torch.tensor(clear, dtype=torch.float32, device=device)
        self.at_door = 1.5 * self.clear.amax(0)
        # Walls run along the first two at a straight heading, along the other two at a diagonal one.
        turned = angles + np.pi / 4 * np.array([[0], [2], [1], [3]])
        self.across = torch.tensor(np.sin(turned) * ray_range, dtype=torch.float32, device=device)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return the mask (E, 3) bool of allowed actions."""
        distance, passed = observation[..., self.distance], observation[..., -1]
        if self.door is not None:
            is_door = observation[..., self.door]
            passed = passed + is_door
            # A collision in front of a door is a push.
            blocked = blocked & ~((is_door > 0) & (distance < self.at_door)).any(-1)
        far = (distance + passed)[..., None, :]  # 1 or more at the target, which is never in the way
        free = (far - self.clear).amin(-1) >= 0
        free, free_diagonally = free.unbind(-1)
        # The vote is costly and rarely needed: only if the two regions differ.
        asked = free != free_diagonally
        free[asked] = free[asked] ^ self.diagonal(distance[asked])
        allowed = blocked.new_ones(*blocked.shape, ACTIONS)
        allowed[..., FORWARD] = free & ~blocked
        return allowed

    def diagonal(self, distance: Tensor) -> Tensor:
        """Return a mask (E,) of headings at 45 degrees to the walls, from the rays' distances (E, R).

        If two rays meet one wall, the line through both points runs along an axis. The line lies along or
        across the heading if the heading is straight, at 45 degrees to it if it is diagonal. The pairs vote.
        """
        place = distance[..., None, :] * self.across
        same = (place[..., self.apart :] - place[..., : -self.apart]).abs_() < self.tolerance
        votes = (same & (distance[..., None, self.apart :] < self.most)).sum(-1)
        return votes[..., 2:].sum(-1) > votes[..., :2].sum(-1)


def pair(noise: float) -> int:
    """Return how many rays apart the two rays of a pair are that show the heading's angle to the walls.

    Exact rays use the next ray. Noisy rays use one so far away that two ends on one wall lie further apart
    than the noise reaches.
    """
    return 4 if noise > 0 else 1


def clearance(angles: np.ndarray, body: float, step: float, margin: float) -> np.ndarray:
    """Return the distances (2, R), metres, that rays must reach for a free step, straight and diagonal.

    ``angles`` (R,) are radians from the heading, ``body`` is the side of the square, ``step`` its move along
    each axis, ``margin`` the gap that it keeps on every side.
    """
    half, sine, cosine = body / 2 + margin, np.abs(np.sin(angles)), np.cos(angles)
    with np.errstate(divide="ignore"):  # the ray straight ahead leaves by the front alone
        straight = np.minimum((half + step) / cosine, half / sine)
        diagonal = np.sqrt(2) * np.minimum((half + step) / (cosine + sine), half / sine)
    return np.stack([straight, diagonal])


def air(world: Config) -> float:
    """Return the gap in metres that the shield keeps on every side of the body.

    An obstacle in the next cell touches a body that fills its own cell: there the gap is negative, as
    distances are rounded. With noisy rays it is negative, too. Many rays pass near a door's frame, and one of
    them is usually too short, while a collision costs only one step.
    """
    return (-0.005 if world.in_cells else 0.005) - 2.5 * world.noise


class PaperRule:
    """Rule of the paper: a random rotation whenever an obstacle is nearer than a threshold.

    The target is no obstacle. The rule overrules the network altogether, and a door of 0.76 m stops most
    bodies that would pass it.
    """

    def __init__(self, generator: torch.Generator, threshold: float = 0.049, distance: int = -2) -> None:
        """Make the rule with a threshold, a generator and the observations' column with the distance.

        The threshold is a fraction of the range; the default is the paper's 10.8 px of 220.
        """
        self.generator, self.threshold, self.distance = generator, threshold, distance

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return the mask (E, 3) bool of allowed actions: all, or one rotation alone."""
        distance, is_target = observation[..., self.distance], observation[..., -1] > 0
        far = (distance.masked_fill(is_target, 1.0) >= self.threshold).all(-1)
        left = torch.rand(far.shape, generator=self.generator, device=far.device) < 0.5
        allowed = torch.empty(*far.shape, ACTIONS, dtype=torch.bool, device=far.device)
        allowed[..., LEFT], allowed[..., RIGHT], allowed[..., FORWARD] = far | left, far | ~left, far
        return allowed


class Free:
    """Layer that allows everything."""

    def __init__(self, actions: int = ACTIONS) -> None:
        """Allow ``actions`` actions."""
        self.actions = actions

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return a mask (E, A) bool that allows all actions."""
        return torch.ones(len(blocked), self.actions, dtype=torch.bool, device=blocked.device)


class Stack:
    """Layers in order of priority, the highest first.

    Each layer restricts the choice that the layers above it leave. A layer that would leave nothing is
    ignored. ``Stack(shield, own)`` over a network makes three layers.
    """

    def __init__(self, *layers: Layer) -> None:
        self.layers = layers

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return the mask (E, A) bool of allowed actions."""
        allowed = self.layers[0](observation, blocked)
        for layer in self.layers[1:]:
            both = allowed & layer(observation, blocked)
            allowed = torch.where(both.any(-1, keepdim=True), both, allowed)
        return allowed


def subsume(preference: Tensor, allowed: Tensor) -> Tensor:
    """Return the allowed action (E,) int64 of greatest preference (E, A)."""
    return preference.masked_fill(~allowed, -torch.inf).argmax(-1)


def best_value(q: Tensor, allowed: Tensor) -> Tensor:
    """Return the greatest Q-value (E,) of the allowed actions: the bootstrap under the acting layer."""
    return q.masked_fill(~allowed, -torch.inf).amax(-1)


def random_preference(like: Tensor, generator: torch.Generator, forward: float = 0.93) -> Tensor:
    """Return preferences (..., A) whose best allowed action is a random one.

    ``forward`` is the probability of the action forward; all other actions have the same probability. The
    preferences are log-probabilities with Gumbel noise: their argmax is a sample, also under a mask.
    """
    share = torch.full(like.shape[-1:], (1 - forward) / (like.shape[-1] - 1), device=like.device)
    share[FORWARD] = forward
    uniform = torch.rand(like.shape, generator=generator, device=like.device)
    return share.log() - (-(uniform.clamp(1e-12, 1 - 1e-7)).log()).log()
