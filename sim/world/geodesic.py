"""Fewest actions from a pose to its target, from distance fields that all environments share.

A field has the distances from all poses of a house's lattice to one target. A search backwards from all poses
that pick up the target computes the field when an environment first has the target. Other environments use
the same field. A field is stored in tiles of 8 x 8 places. A tile has its smallest distance and the number of
a profile. A profile has the difference to the smallest distance for each pose. Profiles repeat in a field and
among fields, so a distance takes two look-ups and little memory.

    fields    for each environment: index of its field's first tile, first i and j, tiles in a column, and
              the tile where the body was last
    tiles     fields, one after the other; smallest distance << 20 | number of a profile
    profiles  512 numbers each, by column, row and heading; -1 if no path leads to the target from there
    distance  for each environment, in actions; -1 if no path leads to its target
    pending   1 if an environment has a target without a field; its distance is -2 until ``settle``
    slots     for each house the index of its first place, its columns and its rows; then for each place the
              number of the field of a target there, -1 for none
    known     rows of ``fields`` by these numbers
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.backend import Lattice
from vitruvius.sim.runtime import Array, Ints, Launch, Shorts, Words, constants, kernel, start, ti
from vitruvius.sim.tasks.survey import DIAGONAL, STRAIGHT, survey
from vitruvius.sim.world.arrays import HOUSE
from vitruvius.sim.world.distance_field import (
    MOST_DISTANCE,
    NOT_YET,
    PROFILE,
    PROFILE_BITS,
    TILE,
    TILE_BITS,
    Steps,
)
from vitruvius.sim.world.episodes import Episodes

AT_ONCE = 16
"""Number of searches that run together; each takes 50 bytes per pose."""

MOST_BYTES = 1 << 30
"""Memory beyond which fields and surveys are discarded, except those in use."""

UNREACHED = 1 << 15
"""Distance that is longer than any path, in actions."""

Key = tuple[int, bytes]
"""Key of a field: the house, and the coordinates of its lattice's origin and of its target."""

Searches = ti.types.ndarray(ti.types.vector(4, ti.i32), 1)
Goals = ti.types.ndarray(ti.types.vector(4, ti.f32), 1)


class Distances:
    """Distance fields of a world, and the distances of its environments."""

    def __init__(self, world: Any) -> None:
        """Take a ``World``. Fields are computed when environments need them."""
        self.world, self.kernels = world, _kernels(start(), world.kernels.episodes)
        self._numbers: dict[int, int] = {}
        self._arrays: dict[str, Array] = {}

    def forget(self) -> None:
        """Discard all fields, because the bank has changed, and mark each environment's field as missing."""
        self._known: dict[Key, tuple[int, ...]] = {}
        self._surveys: dict[Key, tuple[Lattice, np.ndarray]] = {}
        self._used = 0
        self._empty_slots()
        self.wait()

    def _empty_slots(self) -> None:
        shapes = np.array([lattice.shape for lattice in self.world.lattices], np.int32)
        sizes = shapes.prod(axis=1, dtype=np.int64)
        begin = 3 * len(shapes) + np.cumsum([0, *sizes])
        slots = np.full(begin[-1], -1, np.int32)
        self._corners = list(zip(begin[:-1].tolist(), shapes[:, 1].tolist(), strict=True))
        slots[: 3 * len(shapes)] = np.column_stack([begin[:-1], shapes]).ravel()
        self.world.replace_array("slots", Array.of(slots))

    def wait(self) -> None:
        """Mark the fields of all environments as missing, because their states have changed."""
        arrays = self.world.arrays
        # As in ``Episodes.aim``: profile 0 exists, and ``touch`` reads it before a field is known.
        nothing = np.array([-1, 0, 0, 0, -1, 0], np.int32)
        arrays["fields"].fill(np.tile(nothing, (len(arrays["distance"].numpy()), 1)))
        arrays["distance"].fill(np.full(arrays["distance"].shape, NOT_YET, np.int32))
        arrays["pending"].fill(np.ones(1, np.int32))

    @property
    def bytes(self) -> int:
        """Memory of fields, profiles and surveys, in bytes."""
        surveyed = sum(table.nbytes for _, table in self._surveys.values())
        return 4 * self._used + 2 * PROFILE * len(self._numbers) + surveyed

    @property
    def fields(self) -> int:
        """Number of fields."""
        return len(self._known)

    def settle(self) -> None:
        """Compute the distances of environments with new targets."""
        arrays = self.world.arrays
        if not arrays["pending"].numpy()[0]:
            return
        arrays["pending"].fill(np.zeros(1, np.int32))
        self._provide()
        self.world.run("settle")

    def _provide(self) -> None:
        """Assign fields to the environments that wait for them."""
        arrays = self.world.arrays
        fields = arrays["fields"].numpy()
        house, reals = arrays["wholes"].numpy()[:, HOUSE], arrays["reals"].numpy()
        waiting = np.flatnonzero(fields[:, 0] < 0)
        if not len(waiting):  # a user's target, whose field is known, replaced the sampled one
            return
        keys = _keys(house[waiting], reals[waiting])
        missing = [key for key in dict.fromkeys(keys) if key not in self._known]
        if missing and self.bytes > MOST_BYTES:
            self._known, self._used, self._numbers, self._surveys = {}, 0, {}, {}
            self._empty_slots()
            waiting = np.arange(len(fields))
            keys = _keys(house, reals)
            missing = list(dict.fromkeys(keys))
        for first in range(0, len(missing), AT_ONCE):
            self._find(missing[first : first + AT_ONCE])
        fields[waiting] = [self._known[key] for key in keys]
        arrays["fields"].fill(fields)

    def _surveyed(self, key: Key) -> tuple[Lattice, np.ndarray]:
        """Return the lattice of a field, and the possible moves at its places.

        The table of moves has whole tiles, with a border in which the body cannot be.
        """
        house, at = key[0], (key[0], key[1][:8])
        if at not in self._surveys:
            world, origin = self.world, np.frombuffer(key[1][:8], np.float32)
            lattice = world.backend.lattice(world.bank.geometries[house], origin)
            (table,) = survey(world.backend, world.bank, [house], [lattice])
            ends = [(1, 1 + (-2 - count) % TILE) for count in lattice.shape]
            self._surveys[at] = lattice, np.pad(table.moves, ends)
        return self._surveys[at]

    def _find(self, keys: Sequence[Key]) -> None:
        """Compute some fields and keep them."""
        surveys = [self._surveyed(key) for key in keys]
        arrays, count = self._scratch(max(moves.size for _, moves in surveys)), len(keys)
        places, tiles = arrays["moves"].shape[0] // AT_ONCE, arrays["least"].shape[0] // AT_ONCE
        moves, rows = np.zeros((AT_ONCE, places), np.uint16), np.zeros((AT_ONCE, 4), np.int32)
        for s, (lattice, table) in enumerate(surveys):
            moves[s, : table.size] = table.ravel()
            rows[s] = (*table.shape, lattice.first[0] - 1, lattice.first[1] - 1)
        goals = np.zeros((AT_ONCE, 4), np.float32)
        goals[:count] = [np.frombuffer(at, np.float32) for _, at in keys]
        for name, values in (("moves", moves.ravel()), ("searches", rows), ("goals", goals)):
            arrays[name].fill(values)
        Launch(self.kernels["spread"], arrays)()
        hashes = arrays["hashes"].numpy().reshape(AT_ONCE, tiles)[:count]
        least = arrays["least"].numpy().reshape(AT_ONCE, tiles)[:count]
        if (far := int(least.max())) > MOST_DISTANCE:
            raise ValueError(
                f"a path of {far:,} actions is too long: distances to targets are stored up to "
                f"{MOST_DISTANCE:,}"
            )
        distinct, first, inverse = np.unique(hashes, return_index=True, return_inverse=True)
        fresh = [k for k, each in enumerate(distinct.tolist()) if each not in self._numbers]
        start_, known = len(self._numbers), self._numbers
        for k in fresh:
            known[int(distinct[k])] = len(known)
        self._keep(arrays, first[fresh].astype(np.int32), start_)
        numbers = np.array([known[each] for each in distinct.tolist()])[inverse.reshape(hashes.shape)]
        entries = (least.astype(np.uint32) << PROFILE_BITS | numbers.astype(np.uint32)).view(np.int32)
        for s, (key, row) in enumerate(zip(keys, rows.tolist(), strict=False)):
            columns, height = row[0] // TILE, row[1] // TILE
            self._take(key, (self._used, row[2], row[3], height, -1, 0))
            self._write("tiles", self._used, entries[s, : columns * height])
            self._used += columns * height

    def _scratch(self, places: int) -> dict[str, Array]:
        """Return the arrays that searches write, for lattices with this number of places."""
        if not self._arrays or self._arrays["moves"].shape[0] < AT_ONCE * places:
            self._arrays = {
                "moves": Array(ti.u16, AT_ONCE * places),
                "steps": Array(ti.i16, AT_ONCE * places * 8),
                "queue": Array(ti.i32, AT_ONCE * places * 8),
                "searches": Array(ti.i32, AT_ONCE, 4),
                "goals": Array(ti.f32, AT_ONCE, 4),
                "least": Array(ti.i32, AT_ONCE * places // TILE**2),
                "hashes": Array(ti.u64, AT_ONCE * places // TILE**2),
            }
        return self._arrays

    def _take(self, key: Key, row: tuple[int, ...]) -> None:
        """Register a field under its key, and for kernels at its target's place if that is on the lattice."""
        number, self._known[key] = len(self._known), row
        self._write("known", number, np.array([row], np.int32))
        lattice = self.world.lattices[key[0]]
        at = np.frombuffer(key[1], np.float32)
        place = np.round((at[2:] - lattice.origin) / np.float32(lattice.pitch)).astype(int)
        if (at[:2] == lattice.origin).all() and (place >= 0).all() and (place < lattice.shape).all():
            begin, rows = self._corners[key[0]]
            self._write("slots", int(begin + place[0] * rows + place[1]), np.array([number], np.int32))

    def _keep(self, found: dict[str, Array], which: np.ndarray, start_: int) -> None:
        """Keep the profiles of some of the tiles that searches found, numbered from ``start_`` on."""
        if len(which) == 0:
            return
        if start_ + len(which) > 1 << PROFILE_BITS:
            raise ValueError(
                f"distances to targets have more than {1 << PROFILE_BITS:,} profiles: use fewer houses"
            )
        made = Array(ti.i16, len(which) * PROFILE)
        arrays = found | {"which": Array.of(which), "made": made}
        Launch(self.kernels["keep"], arrays)()
        self._write("profiles", start_ * PROFILE, made.numpy())

    def _write(self, name: str, at: int, values: np.ndarray) -> None:
        """Write into an array of the world, which doubles its length if necessary."""
        array = self.world.arrays[name]
        if at + len(values) > array.shape[0]:
            length = max(2 * array.shape[0], at + len(values))
            longer = Array(ti.i16 if name == "profiles" else ti.i32, length, *array.shape[1:])
            kept = np.zeros(longer.shape, array.dtype)
            kept[: array.shape[0]] = array.numpy()
            longer.fill(kept)
            self.world.replace_array(name, longer)
            array = longer
        if array.on_gpu:
            whole = array.numpy()
            whole[at : at + len(values)] = values
            array.fill(whole)
        else:
            array.view()[at : at + len(values)] = values


def _keys(house: np.ndarray, reals: np.ndarray) -> list[Key]:
    """Return the keys of fields for houses (n,), with lattices and targets as in the states' reals (n, 4)."""
    rows = np.ascontiguousarray(reals).view("V16").ravel().tolist()
    return list(zip(house.tolist(), rows, strict=True))


@cache
def _kernels(program: Any, episodes: Episodes) -> dict[str, Any]:
    config, anyhow = episodes.config, STRAIGHT | DIAGONAL
    headings = episodes.body.headings
    mixers = constants(np.random.default_rng(0).integers(2**64, size=PROFILE, dtype=np.uint64) | np.uint64(1))
    near = int((config.target / 2 + max(config.body)) / config.step) + 1

    @ti.func
    def found(steps: ti.template(), queue: ti.template(), base, tail, pose, further):
        """Record a pose's distance and queue it, if the body can be there and the pose is new.

        Return the queue's end.
        """
        if steps[base + pose] == -1:
            steps[base + pose] = ti.cast(further, ti.i16)
            queue[base + tail] = pose
            tail += 1
        return tail

    @kernel
    def spread(
        moves: Shorts, steps: Steps, queue: Ints, searches: Searches, goals: Goals, least: Ints, hashes: Words
    ):
        """Compute the distances from all poses to each search's target.

        Also write each tile's smallest distance, and a hash that distinguishes profiles.
        """
        ti.loop_config(block_dim=1)
        for s in range(searches.shape[0]):
            columns, rows = searches[s][0], searches[s][1]
            first = s * (moves.shape[0] // searches.shape[0])
            base = 8 * first
            for place in range(columns * rows):
                open_ = ti.cast(moves[first + place], ti.i32)
                for heading in ti.static(range(8)):
                    bit = ti.static(DIAGONAL if heading % 2 else STRAIGHT)
                    steps[base + 8 * place + heading] = ti.cast(ti.select(open_ & bit, -1, -2), ti.i16)
            origin, target = ti.Vector([goals[s][0], goals[s][1]]), ti.Vector([goals[s][2], goals[s][3]])
            middle = ti.cast(ti.floor((target - origin) / ti.static(config.step)), ti.i32)
            head, tail = 0, 0
            for i in range(middle[0] - near, middle[0] + near + 2):
                for j in range(middle[1] - near, middle[1] + near + 2):
                    column, row = i - searches[s][2], j - searches[s][3]
                    if 0 < column < columns - 1 and 0 < row < rows - 1:
                        place = column * rows + row
                        if ti.cast(moves[first + place], ti.i32) & anyhow == anyhow:
                            for heading in range(8):
                                if episodes.overlaps(origin, ti.Vector([i, j, heading]), target):
                                    tail = found(steps, queue, base, tail, 8 * place + heading, 0)
            while head < tail:
                pose = queue[base + head]
                place, heading = pose >> 3, pose & 7
                further = ti.cast(steps[base + pose], ti.i32) + 1
                tail = found(steps, queue, base, tail, 8 * place + (heading + 1 & 7), further)
                tail = found(steps, queue, base, tail, 8 * place + (heading + 7 & 7), further)
                forward = headings[heading]
                place -= forward[0] * rows + forward[1]
                if place >= 0 and place < columns * rows:  # noqa: SIM102 - ``and`` computes both sides
                    if moves[first + place] >> heading & 1:
                        tail = found(steps, queue, base, tail, 8 * place + heading, further)
                head += 1
            height = rows >> ti.static(TILE_BITS)
            tiles = s * (least.shape[0] // searches.shape[0])
            for tile in range((columns >> ti.static(TILE_BITS)) * height):
                left, top = (tile // height) << ti.static(TILE_BITS), (tile % height) << ti.static(TILE_BITS)
                nearest = UNREACHED
                for column in range(ti.static(TILE)):
                    at = base + 8 * ((left + column) * rows + top)
                    for k in range(ti.static(8 * TILE)):
                        known = ti.cast(steps[at + k], ti.i32)
                        nearest = ti.min(nearest, ti.select(known < 0, UNREACHED, known))
                nearest = ti.select(nearest == UNREACHED, 0, nearest)
                mixed = ti.u64(0)
                for column in range(ti.static(TILE)):
                    at = base + 8 * ((left + column) * rows + top)
                    for k in range(ti.static(8 * TILE)):
                        known = ti.cast(steps[at + k], ti.i32)
                        further = ti.select(known < 0, 0, known - nearest + 1)
                        mixed += ti.cast(further, ti.u64) * mixers[8 * TILE * column + k]
                least[tiles + tile], hashes[tiles + tile] = nearest, mixed

    @kernel
    def keep(steps: Steps, searches: Searches, least: Ints, which: Ints, made: Steps):
        """Write the profiles of the tiles ``which``, numbered among the tiles of all searches."""
        for k in range(which.shape[0]):
            count, places = least.shape[0] // searches.shape[0], steps.shape[0] // searches.shape[0]
            s, tile = which[k] // count, which[k] % count
            rows = searches[s][1]
            height = rows >> ti.static(TILE_BITS)
            left, top = (tile // height) << ti.static(TILE_BITS), (tile % height) << ti.static(TILE_BITS)
            for column in range(ti.static(TILE)):
                at = s * places + 8 * ((left + column) * rows + top)
                to = k * ti.static(PROFILE) + 8 * TILE * column
                for each in range(ti.static(8 * TILE)):
                    known = ti.cast(steps[at + each], ti.i32)
                    made[to + each] = ti.cast(ti.select(known < 0, -1, known - least[which[k]]), ti.i16)

    return {"spread": spread, "keep": keep}
