"""Coverage: the spots of a house where a body would have seen a target, and the rooms that it was in.

A spot is seen if a ray would end on a target there, as for an agent. So walls, furniture, the range of rays
and the gaps between rays count. An unseen target can lie exactly in the unseen spots.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.free.body import cosine_sine
from vitruvius.sim.backends.free.see import FreeRays
from vitruvius.sim.backends.rays import PARALLEL, Rays
from vitruvius.sim.config import Config
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, Words, kernel, start, ti
from vitruvius.sim.world.arrays import HOUSE
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.states import loaded
from vitruvius.sim.world.world import World

FAR_OFF_M = 1e6
"""Coordinate in metres of a placeholder target, which is so far away that it hides nothing."""

WORD = 64
"""Number of spots in a word of bits."""

SPOT_PITCH_M = 0.29
"""Approximate distance between the spots of ``Coverage``, in metres; the actual distance is a whole number of
steps."""


@ti.func
def bit(k):
    """Return the bit of the k-th spot in its word."""
    return ti.u64(1) << ti.cast(k % ti.static(WORD), ti.u64)


@ti.data_oriented
class LineOfSight:
    """Rays of a look, and tests if one of them would have met a target at a spot."""

    def __init__(self, episodes: Episodes) -> None:
        """Look as the bodies of a configuration do, with all rays at once."""
        self.episodes, self.config = episodes, episodes.config
        self.backend = type(episodes.backend)(self.config, self.config.rays)
        # Possible differences between a bearing and the counted direction of a ray, in whole turns.
        self.turns, self.rays = (0,), self.rays_of(self.config)
        self.half = self.config.target / 2
        self.radius = self.half * 2**0.5

    def rays_of(self, config: Config) -> Any:
        """Return the directions of rays."""
        return Rays(config, 1)

    @ti.func
    def over(self, cell, ray):
        """Return the length of a ray for each metre along x and along y."""
        row = self.rays.first(cell[2], ray)
        return ti.Vector([self.rays.table[row], self.rays.table[row + ti.static(2 * self.rays.count)]])

    @ti.func
    def may_see(self, offset, cell):
        """Return True if a target at an offset from the eye may be visible: see ``Rays.may_see``."""
        return self.rays.may_see(offset, ti.static(self.half), self.backend.body.headings[cell[2]])

    @ti.func
    def distances(self, world: ti.template(), house, origin, cell):
        """Return the length of each ray, in metres, if no target stops it."""
        nowhere = ti.Vector([ti.f32(FAR_OFF_M), ti.f32(FAR_OFF_M)])
        distance, _ = self.backend.see(world.numbers, world.indices, house, origin, cell, nowhere, 0)
        return distance

    @ti.func
    def window(self, distance: ti.template(), corner, origin, cell):
        """Return the range of the spots that a look may show, (ivec4): smallest and largest i, then j."""
        eye = self.backend.body.eye(origin, cell)
        low, high = eye - ti.static(max(self.config.body)), eye + ti.static(max(self.config.body))
        for r in range(ti.static(self.config.rays)):
            over = self.over(cell, r)
            for axis in ti.static(range(2)):
                end = eye[axis] + distance[r] / over[axis]
                low[axis], high[axis] = ti.min(low[axis], end), ti.max(high[axis], end)
        low = (low - ti.static(self.half) - corner) / ti.static(self.config.step)
        high = (high + ti.static(self.half) - corner) / ti.static(self.config.step)
        low, high = ti.floor(low), ti.ceil(high)
        return ti.cast(ti.Vector([low[0], high[0], low[1], high[1]]), ti.i32)

    @ti.func
    def spot(self, corner, i, j):
        """Return the coordinates of a house's place, in metres."""
        return corner + ti.Vector([i, j]) * ti.static(self.config.step)

    @ti.func
    def meets(self, distance: ti.template(), origin, cell, spot):
        """Return 1 (i32) if a target at a spot is under the body or crossed by a ray before its end."""
        met = self.episodes.overlaps(origin, cell, spot)
        offset = spot - self.backend.body.eye(origin, cell)
        if not met and self.may_see(offset, cell):
            away = offset.norm()
            # Only rays with about the bearing of the spot can meet a target there.
            bearing = ti.atan2(-offset[1], offset[0]) * ti.static(180 / np.pi) - self.backend.body.degrees(
                cell
            )
            bearing -= 360.0 * ti.round(bearing / 360.0)
            middle = (ti.static(self.config.first_ray) - bearing) / ti.static(self.config.ray_spacing)
            width = ti.f32(ti.static(180 / self.config.ray_spacing))
            if away > ti.static(self.radius):
                width = ti.asin(self.radius / away) * ti.static(180 / np.pi / self.config.ray_spacing)
            for turn in ti.static(self.turns):
                number = middle + ti.static(360.0 * turn / self.config.ray_spacing)
                first = ti.max(0, ti.cast(ti.ceil(number - width), ti.i32))
                last = ti.min(ti.static(self.config.rays - 1), ti.cast(ti.floor(number + width), ti.i32))
                for ray in range(first, last + 1):
                    met |= self.crosses(offset, self.over(cell, ray), distance[ray])
        return met

    @ti.func
    def crosses(self, offset, over, distance):
        """Return 1 (i32) if a ray with direction ``over`` enters a target at an offset before it ends."""
        near, far = ti.f32(0.0), distance
        for axis in ti.static(range(2)):
            # The ray is in the square between its entry and its exit along both axes.
            one, other = (offset[axis] - self.half) * over[axis], (offset[axis] + self.half) * over[axis]
            near, far = ti.max(near, ti.min(one, other)), ti.min(far, ti.max(one, other))
        return ti.cast(near < far, ti.i32)


@ti.data_oriented
class FreeLineOfSight(LineOfSight):
    """Line of sight for bodies with any heading, and for any number of rays, also all around."""

    def __init__(self, episodes: Episodes) -> None:
        """Look as the bodies of a configuration do."""
        super().__init__(episodes)
        self.turns = (-1, 0, 1)

    def rays_of(self, config: Config) -> Any:
        """Return the directions of rays: see ``LineOfSight``."""
        return FreeRays(config, 1)

    @ti.func
    def over(self, cell, ray):
        """Return the length of a ray for each metre along x and along y: see ``LineOfSight``."""
        cosine, sine = cosine_sine(self.backend.body.heading(cell))
        first, second = self.rays.table[ray], self.rays.table[ti.static(self.config.rays) + ray]
        way = ti.Vector([cosine * first - sine * second, -(sine * first + cosine * second)])
        return 1.0 / ti.select(ti.abs(way) < ti.static(PARALLEL), ti.static(PARALLEL), way)

    @ti.func
    def may_see(self, offset, cell):
        """Return True if a target at an offset from the eye may be visible: see ``LineOfSight``."""
        cosine, sine = cosine_sine(self.backend.body.heading(cell))
        return self.rays.within(offset, ti.static(self.half), offset[0] * cosine - offset[1] * sine)


class Coverage:
    """Fraction of its house that each of E environments has looked at, and the rooms it has been in.

    The spots are the places where this world's targets may lie, on a square grid of ``SPOT_PITCH_M``. Only
    for the CPU.
    """

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Watch these environments, whose bank must not change. Call ``begin`` at each reset.

        ``spots``: for each house the centres (n, 2) float64 of the possible targets, metres.
        """
        self.world: World = envs.unwrapped.world
        if self.world.config.closed_doors:
            raise ValueError("coverage needs open doorways: give it environments with closed_doors=0")
        pitch = in_steps(SPOT_PITCH_M, self.world)
        spots = [here.targets[here.spread(pitch)] for here in self.world.places]
        self.arrays = {
            "spots": Array.of(np.concatenate(spots).ravel()),
            "starts": Array.of(np.cumsum([0, *map(len, spots)]).astype(np.int32)),
            "origins": Array.of(origins_of(self.world)),
            "seen": Array(ti.u64, self.world.num_envs * -(-max(map(len, spots)) // WORD)),
            "counts": Array(ti.i32, self.world.num_envs),
        }
        self.spots = [
            self.world.config.step * each + np.asarray(lattice.origin, np.float32)
            for each, lattice in zip(spots, self.world.lattices, strict=True)
        ]
        self._total = np.array([len(each) for each in spots])
        self._rooms = np.full((len(spots), max(len(shape.rooms) for shape in self._shapes), 4), np.nan)
        for house, shape in enumerate(self._shapes):
            self._rooms[house, : len(shape.rooms)] = shape.rooms
        self._been = np.zeros((self.world.num_envs, self._rooms.shape[1]), bool)
        kernel = _kernels(start(), self.world.kernels.episodes)
        self._launch = Launch(kernel, self.world.arrays | self.arrays)

    def begin(self) -> None:
        """Discard everything seen, and look from the bodies' current poses."""
        self.arrays["seen"].view()[:], self._been[:] = 0, False
        self.look()

    @property
    def seen(self) -> np.ndarray:
        """Spots that each environment has looked at, (E, W) uint64.

        Bit k % 64 of word k // 64 is for the house's k-th spot. Each look changes the same memory.
        """
        seen = self.arrays["seen"].view().reshape(self.world.num_envs, -1)
        seen.flags.writeable = False
        return seen

    def forget(self, chosen: np.ndarray) -> None:
        """Discard the seen spots of the chosen (E,) bool environments, but not their rooms."""
        seen, counts = (self.arrays[name].view() for name in ("seen", "counts"))
        seen.reshape(self.world.num_envs, -1)[chosen], counts[chosen] = 0, 0

    def look(self) -> None:
        """Look from the bodies' current poses."""
        self._launch()
        pose, _, house = self.world.describe()
        rooms = self._rooms[house]
        self._been |= (np.abs(pose[:, None, :2] - rooms[..., :2]) < rooms[..., 2:]).all(axis=-1)

    def counts(self) -> np.ndarray:
        """Return the number of spots that each environment has looked at, (E,) int32."""
        return self.arrays["counts"].numpy()

    def totals(self) -> np.ndarray:
        """Return the number of spots of each environment's house, (E,) int64."""
        return self._total[self._houses]

    def share(self) -> np.ndarray:
        """Return the fraction of its house's spots that each environment has looked at, (E,) float64."""
        return self.counts() / self.totals()

    def rooms(self) -> np.ndarray:
        """Return the number of secondary rooms that each environment's eye has been in, (E,) int64."""
        return self._been.sum(axis=1)

    @property
    def _houses(self) -> np.ndarray:
        return self.world.state["wholes"][:, HOUSE]

    @property
    def _shapes(self) -> list[Geometry]:
        return self.world.bank.geometries


def origins_of(world: World) -> np.ndarray:
    """Return the origin of each house's lattice, (2 H,) float32, metres."""
    return np.concatenate([lattice.origin for lattice in world.lattices]).astype(np.float32)


def in_steps(length: float, world: World) -> int:
    """Return a length in metres as a number of steps, at least one."""
    return max(1, round(length / world.config.step))


@cache
def _kernels(program: Any, episodes: Episodes) -> Any:
    sight = FreeLineOfSight(episodes) if episodes.config.drives else LineOfSight(episodes)

    @kernel
    def look(world: episodes.Arrays, spots: Floats, starts: Ints, origins: Floats, seen: Words, counts: Ints):
        """Record the spots that each environment sees, and count the seen spots."""
        for e in range(world.reals.shape[0]):
            state, words = loaded(world, e), seen.shape[0] // world.reals.shape[0]
            reach = sight.distances(world, state.house, state.origin, state.cell)
            first, end = starts[state.house], starts[state.house + 1]
            corner = ti.Vector([origins[2 * state.house], origins[2 * state.house + 1]])
            window, count = sight.window(reach, corner, state.origin, state.cell), 0
            for k in range(end - first):
                word = e * words + k // ti.static(WORD)
                if not (seen[word] & bit(k)):
                    i, j = spots[2 * (first + k)], spots[2 * (first + k) + 1]
                    # Nested, because Taichi's ``and`` computes both sides.
                    if window[0] <= i <= window[1] and window[2] <= j <= window[3]:  # noqa: SIM102
                        if sight.meets(reach, state.origin, state.cell, sight.spot(corner, i, j)):
                            seen[word] |= bit(k)
                count += ti.cast((seen[word] & bit(k)) != 0, ti.i32)
            counts[e] = count

    return look
