"""The free backend compared with shapely: ``python -m tests.sim.backends.free_study --cases 1000000``.

Shapely has the houses in float64, computed by other code than the simulator's. A ray ends where a line from
the eye first meets a wall or furniture. A disc moves until its distance to all of them is its radius, which
bisection finds, and then along the obstacle.
"""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import shapely

from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import walls
from tests.thick import thickened
from vitruvius.logic import FreeWall, House, Piece, Room
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.drive import Drive

WAY = 2e-5
"""Difference in metres that float32 can make, for a distance and for a place."""

SAMPLES = 201
"""Number of samples of a path of up to 0.4 m: between two samples a disc enters a corner by at most 4e-6
m."""

BRISK = Drive(time_step=0.1, speed=4.0, reverse=2.0, turn_speed=8.0, acceleration=1e9, turn_acceleration=1e9)
"""Limits with steps of up to 0.4 m, so that many steps meet an obstacle."""


def with_slanted_walls(seed: int) -> House:
    """Return a room with furniture and a dozen walls at any angle: thin, thick, and a few along an axis."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(5, 9, 2)
    free = []
    for k in range(12):
        start, angle = rng.uniform(0.2, size - 0.2), rng.uniform(0, 2 * np.pi)
        if k % 4 == 0:
            angle = np.pi / 2 * rng.integers(4)
        way = rng.uniform(0.2, 2.5) * np.round([np.cos(angle), np.sin(angle)], 6)
        end = np.clip(start + way, 0.0, size)
        if np.abs(end - start).max() > 0.05:
            thick = float(rng.choice([0.0, rng.uniform(0.02, 0.4)]))
            free.append(FreeWall(float(start[0]), float(start[1]), float(end[0]), float(end[1]), thick))
    at, sides = rng.uniform(0, size - 1, (3, 2)).tolist(), rng.uniform(0.2, 0.9, (3, 2)).tolist()
    pieces = tuple(
        Piece(x, y, width, height, "table") for (x, y), (width, height) in zip(at, sides, strict=True)
    )
    room = Room(0.0, 0.0, float(size[0]), float(size[1]), "R0", "hall", pieces)
    return House((room,), hub="R0", topology="own", free_walls=tuple(free))


def houses(count: int, seed: int = 0) -> list[House]:
    """Return houses of all kinds, half of them with walls at an angle."""
    plans = [*PLANS.values(), *map(thickened, PLANS.values())]
    straight = [
        sample_houses.random_house(seed + k, k % 2 == 1)
        if k % 3
        else [*plans, random_plan(seed + k)][k % (len(plans) + 1)]
        for k in range(count // 2)
    ]
    return straight + [with_slanted_walls(seed + k) for k in range(count - len(straight))]


class Solids:
    """Obstacles for rays and bodies in a house."""

    def __init__(self, house: House) -> None:
        """Build the obstacles by shapely's set operations."""
        parts = [walls(house), *(shapely.box(*piece.box) for room in house.rooms for piece in room.pieces)]
        for wall in house.free_walls:
            line = shapely.LineString([(wall.x1, wall.y1), (wall.x2, wall.y2)])
            parts.append(line.buffer(wall.thickness / 2, cap_style="flat") if wall.thickness else line)
        self.all = shapely.GeometryCollection(parts)
        self.lines = shapely.union_all(
            [part if part.length and not part.area else part.boundary for part in parts]
        )
        shapely.prepare(self.all)
        shapely.prepare(self.lines)

    def seen(self, eye: np.ndarray, angle: np.ndarray, reach: float) -> np.ndarray:
        """Return the lengths of rays (N,) from eyes (N, 2)."""
        ends = eye + reach * np.column_stack([np.cos(angle), -np.sin(angle)])
        met = shapely.intersection(shapely.linestrings(np.stack([eye, ends], axis=1)), self.lines)
        return np.nan_to_num(np.asarray(shapely.distance(shapely.points(eye), met)), nan=reach)

    def away(self, place: np.ndarray) -> np.ndarray:
        """Return the distances of places (N, 2) from all obstacles."""
        return np.asarray(shapely.distance(shapely.points(place), self.all))

    def leaning(self, place: np.ndarray) -> np.ndarray:
        """Return unit vectors (N, 2) from the nearest point of any obstacle to places."""
        coords = shapely.get_coordinates(shapely.shortest_line(self.all, shapely.points(place))).reshape(
            -1, 2, 2
        )
        way = coords[:, 1] - coords[:, 0]
        return way / np.linalg.norm(way, axis=1, keepdims=True)

    def gone(self, place: np.ndarray, way: np.ndarray, radius: float) -> np.ndarray:
        """Return the fraction of its path (N, 2) that a disc moves before it touches an obstacle, at most 1.

        The fraction is the first of ``SAMPLES`` places at which the disc would be inside, refined by
        bisection. Contact of less than a millionth of a metre does not stop the disc.
        """
        share = np.linspace(0, 1, SAMPLES)

        def inside(at: np.ndarray) -> np.ndarray:
            spots = place[:, None] + at[..., None] * way[:, None]
            return self.away(spots.reshape(-1, 2)).reshape(at.shape) < radius - 1e-6

        met = inside(np.tile(share, (len(place), 1)))
        first = np.where(met.any(axis=1), met.argmax(axis=1), SAMPLES)
        low, high = (share[np.clip(first - back, 0, SAMPLES - 1)] for back in (1, 0))
        for _ in range(30):
            half = (low + high) / 2
            here = inside(half[:, None])[:, 0]
            low, high = np.where(here, low, half), np.where(here, half, high)
        return np.where(first == SAMPLES, 1.0, low)


@dataclass(frozen=True)
class Outcome:
    """Differences between the simulator and shapely in a number of cases."""

    rays: int
    wrong_rays: int
    grazing: int
    """Rays that shapely, too, sees end elsewhere after a tiny change of their direction."""
    moves: int
    met: int
    """Moves with an obstacle in the way."""
    wrong_moves: int
    close: int
    """Moves that shapely, too, ends elsewhere with a slightly larger or smaller disc."""
    furthest: float
    """Largest difference of a distance that is not grazing, in metres."""


def compare(
    bank: Sequence[House], each: int, at_contact: str = "slide", seed: int = 0, sideways: float = 0.0
) -> Outcome:
    """Compare the rays and a step of ``each`` bodies in each house.

    ``sideways``: largest sideways speed, m/s.
    """
    drive = replace(BRISK, at_contact=at_contact, sideways=sideways)
    config = replace(DEFAULT, drive=drive, rays=40, ray_spacing=9.0, first_ray=175.0)
    count, rng = each * len(bank), np.random.default_rng(seed)
    envs = HouseVectorEnv(bank, num_envs=count, backend="free", targets="all", preset=config)
    solids, radius = [Solids(house) for house in bank], config.body[0] / 2
    house, pose = np.repeat(np.arange(len(bank)), each), np.zeros((count, 3))
    for k, shape in enumerate(envs.geometries):
        west, north, east, south = shape.bounds
        found = np.zeros((0, 2))
        while len(found) < each:
            some = rng.uniform((west, north), (east, south), (4 * each, 2)).astype(np.float32).astype(float)
            # Half of the bodies begin near an obstacle.
            far = solids[k].away(some)
            limit = np.where(np.arange(len(some)) % 2, radius + 0.2, np.inf)
            found = np.vstack([found, some[shape.holds(some) & (far > radius + 1e-4) & (far < limit)]])
        pose[house == k, :2] = found[rng.permutation(len(found))[:each]]
    pose[:, 2] = rng.uniform(0, 2 * np.pi, count)
    corner = np.tile([[90.0, 90.0]], (count, 1))  # a target out of sight
    seen, info = envs.reset(seed=seed, options={"house": house, "pose": pose, "target": corner})
    pose = info["pose"].astype(float)
    v, w = rng.uniform(-drive.reverse, drive.speed, count), rng.uniform(-8, 8, count)
    w[rng.random(count) < 0.2] = 0
    left = rng.uniform(-sideways, sideways, count) if sideways else np.zeros(count)
    action = np.column_stack([v, left, w] if sideways else [v, w]).astype(np.float32)
    after = envs.step(action)[4]
    ours, blocked = after["pose"][:, :2].astype(float), after["blocked"]
    angle = pose[:, 2, None] + config.ray_angles
    v, w = action.astype(float).T[[0, -1]]
    turn = w * drive.time_step
    chord = drive.time_step * np.sinc(turn / 2 / np.pi)
    middle = pose[:, 2] + turn / 2
    cosine, sine = np.cos(middle), np.sin(middle)
    way = chord[:, None] * np.column_stack([v * cosine - left * sine, -v * sine - left * cosine])
    totals = np.zeros(6, int)
    furthest = 0.0
    for k, there in enumerate(solids):
        here = house == k
        rays = _rays(
            there, pose[here], angle[here], seen[here, :, 0] * np.float32(config.range), config.range
        )
        moves = _moves(there, pose[here, :2], way[here], ours[here], blocked[here], radius, at_contact)
        totals += [*rays[:2], *moves]
        furthest = max(furthest, rays[2])
    wrong_rays, grazing, met, wrong_moves, close, _ = totals.tolist()
    return Outcome(count * config.rays, wrong_rays, grazing, count, met, wrong_moves, close, furthest)


def _rays(
    solids: Solids, pose: np.ndarray, angle: np.ndarray, ours: np.ndarray, reach: float
) -> tuple[int, int, float]:
    """Return the numbers of wrong and grazing rays, and the largest difference of the other rays."""
    eye = np.repeat(pose[:, :2], angle.shape[1], axis=0)
    angle, ours = angle.ravel(), ours.astype(float).ravel()
    theirs = solids.seen(eye, angle, reach)
    off = np.abs(ours - theirs)
    other = off > WAY
    # Sideways by the extension of a line beyond its end, and by the float32 error of a ray's direction.
    side = 4e-5 / np.maximum(0.1, np.minimum(ours, theirs)[other]) + 1e-6
    near = [solids.seen(eye[other], angle[other] + share * side, reach) for share in (-1, -0.3, 0, 0.3, 1)]
    fine = (ours[other] >= np.min(near, axis=0) - WAY) & (ours[other] <= np.max(near, axis=0) + WAY)
    return int((~fine).sum()), int(fine.sum()), float(off[~other].max(initial=0.0))


def _moves(
    solids: Solids,
    place: np.ndarray,
    way: np.ndarray,
    ours: np.ndarray,
    blocked: np.ndarray,
    radius: float,
    at_contact: str,
) -> tuple[int, int, int, int]:
    """Return the numbers of moves that met an obstacle, wrong moves, close ones, and ends too near to one."""
    ends = [_moved(solids, place, way, radius + slack, at_contact) for slack in (0.0, -WAY, WAY)]
    met = np.linalg.norm(ends[0] - place - way, axis=1) > WAY
    off = np.linalg.norm(ours - ends[0], axis=1)
    other = off > 2 * WAY
    spread = np.max([np.linalg.norm(end - ends[0], axis=1) for end in ends[1:]], axis=0)
    fine = other & (spread > 0.2 * off)
    inside = solids.away(ours) < radius - WAY
    wrong = (
        (other & ~fine)
        | inside
        | (blocked != met) & (np.abs(np.linalg.norm(ends[0] - place - way, axis=1)) > 4 * WAY)
    )
    return int(met.sum()), int(wrong.sum()), int((fine & ~wrong).sum()), int(inside.sum())


def _moved(solids: Solids, place: np.ndarray, way: np.ndarray, radius: float, at_contact: str) -> np.ndarray:
    """Return the end places of discs that try to move along their paths."""
    at, left, last = place.copy(), way.copy(), np.zeros_like(way)
    for _ in range(4):
        share = solids.gone(at, left, radius)
        at = at + share[:, None] * left
        stopped = share < 1
        if at_contact == "stop" or not stopped.any():
            break
        lean = np.zeros_like(way)
        lean[stopped] = solids.leaning(at[stopped])
        left = np.where(stopped[:, None], (1 - share)[:, None] * left, 0)
        left -= np.minimum(0, (left * lean).sum(axis=1))[:, None] * lean
        left[(left * last).sum(axis=1) < 0] = 0
        last = lean
    return at


def main() -> None:
    """Print the differences."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000, help="rays in all; a move for each 40 of them")
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    bank, kinds = houses(40, given.seed), list(product(("slide", "stop"), (0.0, 3.0)))
    each = -(-given.cases // 40 // len(kinds) // len(bank))
    for k, (at_contact, sideways) in enumerate(kinds):
        found = compare(bank, each, at_contact, given.seed + k, sideways)
        print(at_contact, f"sideways up to {sideways:g} m/s", found, flush=True)


if __name__ == "__main__":
    main()
