"""Where the steps of an episode go: to the target, through doors, between rooms, and to search them.

Each step is of one phase, the first of these that fits where the body is before it:

| phase | the step is made |
|---|---|
| approach | after a ray has met the target: since its last pick-up the policy knows where to go |
| door | with the eye within a body's side of a door |
| crossing | in a space that no target can lie in: the main room, where targets are in secondary rooms |
| survey | in a room that is new: it has seen of less than ``MOST`` of it whether a target lies there |
| again | in a room that is not, but of which less than that has been seen since the last pick-up |
| corners | in a room of which more than that has been seen since then, but not all |
| out | in a room of which all has been seen since then: what is left is to go elsewhere |

Turning and blocked moves occur in all of them, and are counted beside them. Axes: H houses, P phases,
R rooms (the main room is 0), W words of 64 spots.
"""

from dataclasses import dataclass

import numpy as np

from agent.evaluation.episodes import reset
from agent.policies.episodes import moments
from agent.policies.policies import Policy
from sim import HouseVectorEnv
from sim.actions import FORWARD
from sim.baselines.coverage import Coverage

PHASES = ("approach", "door", "crossing", "survey", "again", "corners", "out")
APPROACH, DOOR, CROSSING, SURVEY, AGAIN, CORNERS, OUT = range(len(PHASES))

MOST = 0.9
"""Share of a room's spots, 0.29 m apart: what is left then are corners, and what is behind furniture."""


@dataclass(frozen=True)
class StepAccount:
    """What a policy's steps went to, one episode in each of H houses."""

    steps: np.ndarray
    """(H, P) int64 steps of each phase."""

    sighted: np.ndarray
    """(H, P) int64 targets picked up, by the phase in which a ray first met them: in ``approach`` are those
    that were in sight as soon as they appeared."""

    turning: np.ndarray
    """(H, P) int64 those of the steps that were turns."""

    blocked: np.ndarray
    """(H, P) int64 those of the steps that were moves that walls or furniture blocked."""

    def of(self, houses: np.ndarray) -> "StepAccount":
        """Of some of the houses (H,) bool."""
        return StepAccount(*(each[houses] for each in (self.steps, self.sighted, self.turning, self.blocked)))


def follow(envs: HouseVectorEnv, policy: Policy, seed: int) -> StepAccount:
    """Play the protocol's episodes, environment i in house i, and account for each step.

    The bank must have a house for each environment, and episodes that end by time alone, all at once.
    """
    observation = reset(envs, seed)
    search, every = RoomSearch(envs), np.arange(envs.num_envs)
    counts = np.zeros((4, envs.num_envs, len(PHASES)), np.int64)
    phase = origin = np.zeros(envs.num_envs, int)  # ``origin``: in which the known target was first met
    known = np.zeros(envs.num_envs, bool)
    for now in moments(envs, policy, observation):
        picked, sees = now.reward.numpy() > 0, now.observation[..., -1].numpy().any(-1)
        if now.step:
            counts[1, every, np.where(known, origin, phase)] += picked
            counts[3, every, phase] += now.blocked.numpy()
            origin = np.where(picked, APPROACH, np.where(known, origin, phase))
            search.look(picked)
        known = sees | (known & ~picked)
        phase = np.where(known, APPROACH, search.phase())
        if now.actions is not None:
            counts[0, every, phase] += 1
            counts[2, every, phase] += now.actions.numpy() != FORWARD
    return StepAccount(*counts)


class RoomSearch:
    """Which rooms each of the environments has looked at, in its episode and since its last pick-up."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Begin where the bodies are now."""
        self.watch = Coverage(envs)
        self.watch.begin()
        self.envs, self.body, shapes = envs, max(envs.config.body), envs.geometries
        rooms = 1 + max(len(shape.rooms) for shape in shapes)
        self.seen = self.watch.seen
        self.earlier = np.zeros_like(self.seen)
        self.rooms = np.full((len(shapes), rooms - 1, 4), np.nan)
        self.doors = np.full((len(shapes), max(len(shape.doors) for shape in shapes), 4), np.nan)
        self.masks = np.zeros((len(shapes), rooms, 8 * self.seen[0].nbytes), bool)
        for house, shape in enumerate(shapes):
            self.rooms[house, : len(shape.rooms)] = shape.rooms
            self.doors[house, : len(shape.doors)] = shape.doors
            places = self.watch.spots[house]
            self.masks[house, room_of(places, self.rooms[house]), np.arange(len(places))] = True
        self.total = self.masks.sum(axis=-1)
        self.masks = np.packbits(self.masks, axis=-1, bitorder="little").view(self.seen.dtype)

    def look(self, picked: np.ndarray) -> None:
        """Look from where the bodies are; where a target was ``picked`` (E,) bool, the next is sought."""
        self.earlier[picked] |= self.seen[picked]
        self.watch.forget(picked)
        self.watch.look()

    def phase(self) -> np.ndarray:
        """What phase (E,) int64 a step made now is of, where no target is known."""
        info = self.envs.info()
        pose, house = info["pose"], info["house"]
        room = room_of(pose[:, :2], self.rooms[house])
        mask, total = self.masks[house, room], self.total[house, room]

        def looked(words: np.ndarray, share: float = MOST) -> np.ndarray:
            return np.bitwise_count(words & mask).sum(axis=-1) >= share * total

        doors = self.doors[house]
        gap = np.maximum(np.abs(pose[:, None, :2] - doors[..., :2]) - doors[..., 2:], 0)
        at_door = (np.hypot(gap[..., 0], gap[..., 1]) <= self.body).any(axis=-1)
        return np.select(
            [
                at_door,
                total == 0,
                ~looked(self.seen | self.earlier),
                ~looked(self.seen),
                ~looked(self.seen, share=1.0),
            ],
            [DOOR, CROSSING, SURVEY, AGAIN, CORNERS],
            OUT,
        )


def room_of(places: np.ndarray, rooms: np.ndarray) -> np.ndarray:
    """Which room each of the places (n, 2) is in, (n,) int: 1 to R of ``rooms`` (R, 4) or (n, R, 4), boxes by
    their middles and half sides; 0 in none of them.
    """
    inside = (np.abs(places[:, None] - rooms[..., :2]) < rooms[..., 2:]).all(axis=-1)
    return np.where(inside.any(axis=-1), 1 + inside.argmax(axis=-1), 0)
