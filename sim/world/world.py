"""State of E environments over a bank of houses: the arrays that their kernels read and write."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.arrays import ArrayRow
from vitruvius.sim.backends.backend import Backend, Bank, Lattice
from vitruvius.sim.backends.piece_kinds import check_kinds
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import check_lengths
from vitruvius.sim.runtime import Array, Launch, start, ti
from vitruvius.sim.tasks.places import Places, places
from vitruvius.sim.tasks.survey import survey
from vitruvius.sim.tasks.tasks import AnyTask, FixedTask, Targets, at_once, task
from vitruvius.sim.tasks.terms import terms_of
from vitruvius.sim.world.arrays import FOUND, HOUSE, NEXT_STEP, NUMBER, OVER, SEED, STATE, TIME
from vitruvius.sim.world.geodesic import Distances
from vitruvius.sim.world.kernels import kernels
from vitruvius.sim.world.kind import WorldKind
from vitruvius.sim.world.overlays import overlays_of
from vitruvius.sim.world.phases import SAMPLE
from vitruvius.sim.world.place_table import place_table
from vitruvius.sim.world.surroundings import surroundings

GUIDE = [row for row in STATE if row.name in ("next_wholes", "next_reals")]
"""Arrays of options for episodes that begin automatically."""

TABLES = "numbers", "indices", "places"
"""Arrays of the bank."""

MAX_SERIAL_ENVS = 64
"""Largest number of environments that one thread steps faster than several threads."""

MOST_PLACES, MOST_ALONG = 1 << 26, 1 << 16
"""Largest number of places of a house's lattice: a survey keeps all places in memory. Largest number of
places along an axis: a place's number along an axis has 16 bits."""

BATCH = 256
"""Number of houses that are surveyed together; it bounds the memory of packing."""


class PackedHouses(NamedTuple):
    """A bank of houses for a task, packed and surveyed."""

    houses: list[House]
    bank: Bank
    task: AnyTask
    lattices: list[Lattice]
    places: list[Places]
    arrays: dict[str, Array]


class World:
    """E environments over H houses, with everything that their steps read and write."""

    def __init__(
        self,
        config: Config,
        backend: type[Backend],
        houses: Sequence[House],
        targets: Targets,
        num_envs: int,
        mode: int = NEXT_STEP,
        by_ray: bool = False,
    ) -> None:
        """Pack the houses and find their starts and targets (``ValueError`` if there are none).

        ``by_ray``: the loop has one task for each ray of each environment, as a GPU needs, instead of one
        task for each environment. The results are the same, bit for bit.
        """
        self.task, self.num_envs = task(targets), num_envs
        check_lengths(houses)
        self.config = backend.fit(config, houses)
        self.kind = WorldKind(
            replace(self.config, steps=1),  # kernels of all lengths of episodes are the same
            mode=mode,
            by_ray=by_ray,
            serial=num_envs <= MAX_SERIAL_ENVS and not by_ray,
            ends_on_pick_up=bool(self.task.ends_on_pick_up),
            terms=terms_of(self.task),
            at_once=at_once(self.task),
            overlays=overlays_of(self.config),
        )
        self._check_distance()
        self.kernels = kernels(start(), self.kind, backend)
        self.backend: Backend = self.kernels.backend
        self.arrays = {row.name: self._made(row) for row in self.kind.rows if "n" not in row.shape}
        self.arrays["limit"].fill(np.array([self.config.steps], np.int32))
        self.launches: dict[str, Launch] = {}
        self.distances = Distances(self) if self.kind.knows_distance else None
        self.load(houses)

    def _check_distance(self) -> None:
        """Raise ``ValueError`` if the distance to the target is asked for and impossible."""
        knows, config = self.kind.knows_distance, self.config
        for overlay in self.kind.overlays:
            overlay.check(knows)
        if knows and config.varies("width"):
            raise ValueError("the distance to the target needs a body of fixed width")
        if self.kind.at_once > 1 and (knows or config.latency):
            raise ValueError("several targets at once support neither the distance to the target nor latency")

    def _made(self, row: ArrayRow) -> Array:
        """Return a new array for a row of the table, filled with zeros."""
        return row.array(self.kind, self.kind.sizes(self.num_envs))

    def load(self, houses: Sequence[House], targets: Targets | None = None) -> None:
        """Load another bank, and another task if ``targets`` names one. Nothing is compiled.

        Reset all environments before the next step. Raises ``ValueError``, and keeps the current bank, if a
        house cannot be used.
        """
        self.take(self.packed(houses, targets))

    def packed(self, houses: Sequence[House], targets: Targets | None = None) -> PackedHouses:
        """Return a packed bank and task for ``take``. Any thread may pack while other threads step.

        Raises ``ValueError`` if a house cannot be used.
        """
        check_lengths(houses)
        wanted = self.task if targets is None else task(targets)
        if wanted.ends_on_pick_up != self.task.ends_on_pick_up:
            raise ValueError("episodes of that task end differently: make a new environment for it")
        if at_once(wanted) != self.kind.at_once:
            raise ValueError("that task has another number of targets at once: make a new environment for it")
        if terms_of(wanted) != terms_of(self.task):
            raise ValueError("that task has other terms: make a new environment for it")
        if self.backend.fit(self.config, houses) != self.config:
            raise ValueError("these houses need another body size and step: make a new environment for them")
        check_kinds(houses, self.config.kinds)
        getattr(wanted, "check", lambda houses: None)(houses)
        bank = self.backend.pack(houses)
        arrays = {"numbers": bank.numbers, "indices": bank.indices}
        if self.kind.surveys:
            arrays["surroundings"] = surroundings(houses, bank, self.config, terms_of(wanted))
        return PackedHouses(list(houses), bank, wanted, *self._places(houses, bank, wanted), arrays)

    def take(self, loaded: PackedHouses) -> None:
        """Continue with the houses and the task that ``packed`` returned. Nothing is compiled."""
        self.houses, self.bank, self.task, self.lattices, self.places, arrays = loaded
        self.arrays |= arrays | {"places": place_table(self.lattices, self.places)}
        for overlay in self.kind.overlays:
            self.arrays |= overlay.arrays(self.bank.geometries, self.num_envs)
        if self.distances:
            self.distances.forget()
        self._bind()
        if self.kind.guided:
            self.guide(*self.unguided())

    def _bind(self) -> None:
        for launch in self.launches.values():
            launch.bind(self.arrays)

    def replace_array(self, name: str, array: Array) -> None:
        """Replace an array that kernels read by another array of the same kind."""
        self.arrays[name] = array
        self._bind()

    def _places(
        self, houses: Sequence[House], bank: Bank, task: AnyTask
    ) -> tuple[list[Lattice], list[Places]]:
        lattices: list[Lattice] = []
        cells: list[np.ndarray | None] = []
        found: list[Places] = []
        count = index = len(bank.geometries)
        try:
            for index in range(count):
                lattice, cell = self._lattice(houses[index], bank, index, task)
                _require_countable(lattice)
                lattices.append(lattice)
                cells.append(cell)
            for first in range(0, count, BATCH):
                some = list(range(first, min(first + BATCH, count)))
                tables = survey(self.backend, bank, some, lattices[first : first + BATCH])
                for index, table in zip(some, tables, strict=True):
                    house, shape, lattice = houses[index], bank.geometries[index], lattices[index]
                    found.append(places(house, shape, lattice, table, self.config, task, cells[index]))
        except ValueError as error:
            raise ValueError(f"house {index} of {count}: {error}") from None
        return lattices, found

    def _lattice(
        self, house: House, bank: Bank, index: int, task: AnyTask
    ) -> tuple[Lattice, np.ndarray | None]:
        """Return the lattice over house ``index`` of a bank, and the start cell (i, j, heading)."""
        shape, pose = bank.geometries[index], task.pose(house) if isinstance(task, FixedTask) else None
        if pose is None:
            return self.backend.lattice(shape), None
        origin, cell = self.place(np.array([index]), np.array([pose], np.float64), bank)
        through = self.backend.lattice(shape, origin[0])
        corner = (through.origin + through.pitch * np.array(through.first)).astype(np.float32)
        return Lattice(corner, through.pitch, through.shape), cell[0] - (*through.first, 0)

    def run(self, name: str) -> None:
        """Run a kernel, ``reset``, ``step`` or ``describe``, on the world's arrays."""
        if name not in self.launches:
            self.launches[name] = Launch(getattr(self.kernels, name), self.arrays)
        self.launches[name]()
        if self.distances and name in ("reset", "step"):
            self.distances.settle()

    def seed(self, seeds: np.ndarray, chosen: np.ndarray) -> None:
        """Set the seeds (E,) uint64 of the ``chosen`` (E,) bool environments.

        Their next episode is number 0.
        """
        wholes = self.arrays["wholes"].numpy()
        wholes[chosen, NUMBER] = -1
        words = np.ascontiguousarray(seeds, "<u8").view("<i4").reshape(-1, 2)
        wholes[chosen, SEED : SEED + 2] = words[chosen]
        self.arrays["wholes"].fill(wholes)

    def reset(self, option_wholes: np.ndarray, option_reals: np.ndarray) -> None:
        """Begin episodes: see the kernel ``reset``."""
        self.arrays["option_wholes"].fill(option_wholes)
        self.arrays["option_reals"].fill(option_reals)
        self.run("reset")

    def guide(self, next_wholes: np.ndarray, next_reals: np.ndarray) -> None:
        """Set the options of episodes that begin automatically, until other houses are loaded.

        The kernel ``reset`` explains the options. The first call compiles the step again.
        """
        if not self.kind.guided:
            self.kind = replace(self.kind, guided=True)
            self.kernels, self.launches = kernels(start(), self.kind, type(self.backend)), {}
            self.arrays |= {row.name: self._made(row) for row in GUIDE}
        self.arrays["next_wholes"].fill(next_wholes)
        self.arrays["next_reals"].fill(next_reals)

    def unguided(self) -> tuple[np.ndarray, np.ndarray]:
        """Return options that sample all values: ``option_wholes`` and ``option_reals``."""
        wholes = np.zeros((self.num_envs, 4), np.int32)
        wholes[:, 0] = SAMPLE
        return wholes, np.full((self.num_envs, self.kind.sizes()["P"]), np.nan, np.float32)

    def place(
        self, house: np.ndarray, pose: np.ndarray, bank: Bank | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return poses (E, 3) in houses (E,) as origins (E, 2) float32 and cells (E, 3) int32.

        Bodies that drive have headings (E,) float32 instead of cells. ``bank``: the bank of the houses,
        by default this world's. Raises ``ValueError`` for a pose where the body cannot be.
        """
        bank = bank or self.bank
        origin, cell = self.backend.place(bank, house, pose)
        stand = np.zeros((len(pose), 3), np.int32) if self.config.drives else cell
        indoors = np.zeros(len(pose), bool)
        for k in np.unique(house):
            indoors[house == k] = bank.geometries[k].holds(pose[house == k, :2])
        arrays = {
            "numbers": bank.numbers,
            "indices": bank.indices,
            "cells": Array.of(np.column_stack([house, stand]).astype(np.int32).ravel()),
            "origins": Array.of(origin.astype(np.float32).ravel()),
            "free": Array(ti.i32, len(pose)),
        }
        Launch(self.kernels.stand, arrays)()
        free = indoors & (arrays["free"].numpy() != 0)
        if not free.all():
            e = int((~free).argmax())
            x, y = pose[e, :2]
            raise ValueError(f"pose {e}: the robot cannot stand at ({x:.3f}, {y:.3f}) m in house {house[e]}")
        return origin, cell

    def describe(
        self, last: bool = False, stepped: bool = False
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return copies of the eyes' poses (E, 3), the targets' centres (E, 2) and the houses (E,).

        ``last``: return the state at the end of the latest episode, if the same step begins the next one.
        ``stepped``: True right after a step. A step of few environments (``FEW``) has already described the
        state, so the kernel ``describe`` does not run again.
        """
        if last:
            self._describe_last()
        elif not (stepped and self.kind.serial):
            self.run("describe")
        pose, target, house = (self.arrays[name].numpy() for name in ("pose", "target", "house"))
        return pose.reshape(-1, 3), target.reshape(-1, 2), house

    @cached_property
    def _describe_last(self) -> Launch:
        """Launch that describes the last states. It reads no array of the bank, so ``_bind`` skips it."""
        last = {"reals": self.arrays["last_reals"], "wholes": self.arrays["last_wholes"]}
        return Launch(self.kernels.describe, self.arrays | last)

    def targets(self, count: int) -> np.ndarray:
        """Return the current and the next targets of each environment, (E, count, 2), metres."""
        arrays = self.arrays | {"targets": Array(ti.f32, self.num_envs * count * 2)}
        Launch(self.kernels.peek, arrays)()
        return arrays["targets"].numpy().reshape(self.num_envs, count, 2)

    def environment(self, e: int) -> dict[str, int]:
        """Return an environment's counters: steps, targets found plus 1, end and number of the episode."""
        whole = self.arrays["wholes"].numpy()[e]
        return {
            "time": int(whole[TIME]),
            "found": int(whole[FOUND]) - self.kind.at_once + 1,
            "over": int(whole[OVER]),
            "episode": int(whole[NUMBER]),
        }

    @property
    def open_doors(self) -> np.ndarray:
        """Mask of the open doors of each environment, (E, D) bool, in the order of ``Geometry.doors``.

        Entries after a house's last door are False.
        """
        counts = np.array([len(shape.doors) for shape in self.bank.geometries])
        doors = np.arange(counts.max()) < counts[self.arrays["wholes"].numpy()[:, HOUSE], None]
        if "pushes" in self.arrays:
            pushes = self.arrays["pushes"].numpy().reshape(self.num_envs, -1)
            doors &= pushes[:, : counts.max()] >= self.config.closed_doors
        return doors

    def drawn(self, e: int) -> np.ndarray:
        """Return boxes (n, 4) of the things of all overlays of an environment: west, north, east, south."""
        house = self.arrays["wholes"].numpy()[e, HOUSE]
        shape, boxes = self.bank.geometries[house], [np.zeros((0, 4))]
        for overlay in self.kind.overlays:
            arrays = {row.name: self.arrays[row.name].numpy() for row in overlay.ROWS}
            boxes.append(overlay.drawn(self.config, arrays, shape, e))
        return np.concatenate(boxes)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Copies of the arrays that the next steps depend on, except the bank's: see ``sim.world.arrays``."""
        return {row.name: self.arrays[row.name].numpy() for row in self.kind.rows if row.saved}

    @state.setter
    def state(self, state: dict[str, np.ndarray]) -> None:
        for row in self.kind.rows:
            if row.saved:
                self.arrays[row.name].fill(state[row.name])
        if self.distances:
            self.distances.wait()
            self.distances.settle()


def _require_countable(lattice: Lattice) -> None:
    """Raise ``ValueError`` for a lattice with too many places."""
    columns, rows = lattice.shape
    if columns * rows > MOST_PLACES or max(columns, rows) > MOST_ALONG:
        raise ValueError(
            f"it has {columns:,} by {rows:,} positions, {lattice.pitch:.3g} m apart: at most "
            f"{MOST_PLACES:,}, and {MOST_ALONG:,} along an axis, are supported"
        )
