"""State of E environments over a bank of houses: the arrays that their kernels read and write."""

from collections.abc import Sequence
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Backend, Bank, Lattice
from vitruvius.sim.backends.doors import door_arrays
from vitruvius.sim.backends.kinds import check_kinds
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import check_lengths
from vitruvius.sim.runtime import Array, Launch, start, ti
from vitruvius.sim.tasks.places import Places, places
from vitruvius.sim.tasks.survey import survey
from vitruvius.sim.tasks.tasks import AnyTask, FixedTask, Targets, at_once, task
from vitruvius.sim.tasks.terms import terms_of
from vitruvius.sim.world.episodes import FOUND, HEADER, HOUSE, NUMBER, OVER, SEED, TIME, WHOLES
from vitruvius.sim.world.geodesic import Distances, distance_arrays
from vitruvius.sim.world.kernels import NEXT_STEP, SAME_STEP, SAMPLE, kernels
from vitruvius.sim.world.surroundings import surroundings

STATE = "reals", "wholes"
"""Arrays that a step depends on, without those of the bank. With closed doors there is also ``pushes``, whose
length depends on the doors of the bank."""

GUIDE = "next_wholes", "next_reals"
"""Arrays of options for episodes that begin automatically."""

TABLES = "numbers", "indices", "places"
"""Arrays of the bank."""

FEW = 64
"""Largest number of environments that one thread steps faster than several threads."""

MOST_PLACES, MOST_ALONG = 1 << 26, 1 << 16
"""Largest number of places of a house's lattice, because a survey keeps the places in memory, and largest
number of places along an axis, because it has 16 bits."""

BATCH = 256
"""Number of houses that are surveyed together; it bounds the memory of packing."""


class PackedHouses(NamedTuple):
    """A bank of houses for a task, packed and surveyed."""

    houses: list[House]
    bank: Bank
    task: AnyTask
    lattices: list[Lattice]
    places: list[Places]
    surroundings: Array


def staged(here: Places, at: int) -> np.ndarray:
    """Return the part of the table ``places`` for a house whose task has an order; the part begins at ``at``.

    The part has the index of the first target and the number of targets of each stage, then all targets.
    """
    counts = np.array([len(stage) for stage in here.stages])
    first = at + 2 * len(counts) + 2 * np.cumsum([0, *counts[:-1]])
    targets = here.targets[np.concatenate(here.stages)].view(np.int32)
    return np.concatenate([np.column_stack([first, counts]).ravel(), targets.ravel()]).astype(np.int32)


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

        ``by_ray``: one task for each environment and ray in place of one for each environment, the loop for
        a GPU; the results are the same, bit for bit.
        """
        self.task, self.num_envs, self.mode = task(targets), num_envs, mode
        check_lengths(houses)
        self.config = backend.fit(config, houses)
        ends, terms = bool(self.task.ends_on_pick_up), terms_of(self.task)
        self.serial = num_envs <= FEW and not by_ray
        self.at_once = at_once(self.task)
        self._compile = partial(
            kernels, start(), self.config, backend, mode, by_ray, self.serial, ends, terms, self.at_once
        )
        self.kernels, self.guided = self._compile(), False
        self.backend: Backend = self.kernels.backend
        knows = self.kernels.episodes.knows_distance
        if knows and self.config.closed_doors:
            raise ValueError(
                "the distance to the target needs open doors: for closed doors use vitruvius.sim.Oracle"
            )
        if knows and self.config.varies("width"):
            raise ValueError("the distance to the target needs a body whose width does not vary")
        if self.at_once > 1 and (knows or self.config.latency):
            raise ValueError(
                "several targets at once: neither a distance to the target nor latency is possible"
            )
        self._make_arrays()
        self.distances = Distances(self) if knows else None
        self.load(houses)

    def _make_arrays(self) -> None:
        count, config, mode = self.num_envs, self.config, self.mode
        pairs = config.channels == 2
        numbers = count * config.rays * (1 if pairs else config.channels)
        observation = ti.u64 if pairs else ti.f32
        ended = numbers if mode == SAME_STEP else 1
        self.arrays = {
            "reals": Array(ti.f32, count, 4),
            "wholes": Array(ti.i32, count, WHOLES),
            "action": Array(ti.i64, count),
            "observation": Array(observation, numbers),
            "final": Array(observation, ended),
            "extras": Array(ti.f32, max(1, count * config.extra_numbers)),
            "final_extras": Array(ti.f32, max(1, count * config.extra_numbers)),
            "odometer": Array(ti.f32, count if "odometry" in config.observe else 1, 4),
            "past_reals": Array(ti.f32, count * (config.latency + 1) if config.latency else 1, 4),
            "past_cells": Array(ti.i32, count * (config.latency + 1) if config.latency else 1, 4),
            "reward": Array(ti.f32, count),
            "flags": Array(ti.u8, (4 if mode == SAME_STEP else 3) * count),
            "prefetched": Array(ti.i32, count),
            "option_wholes": Array(ti.i32, count, 4),
            "option_reals": Array(ti.f32, count, 4),
            "next_wholes": Array(ti.i32, 1, 4),
            "next_reals": Array(ti.f32, 1, 4),
            "pose": Array(ti.f32, 3 * count),
            "target": Array(ti.f32, 2 * count),
            "house": Array(ti.i32, count),
            "memory": Array(ti.f32, max(1, count * config.memory)),
            "last_memory": Array(ti.f32, max(1, count * config.memory)),
            "others": Array(ti.f32, max(1, count * 2 * (self.at_once - 1))),
            "last_others": Array(ti.f32, max(1, count * 2 * (self.at_once - 1))),
            "rooms": Array(ti.i32, count if terms_of(self.task).sees_room else 1),
            "last_reals": Array(ti.f32, count if mode == SAME_STEP else 1, 4),
            "last_wholes": Array(ti.i32, count if mode == SAME_STEP else 1, WHOLES),
            **distance_arrays(count, self.kernels.episodes.knows_distance),
        }
        self.launches: dict[str, Launch] = {}

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
            raise ValueError("episodes of that task end otherwise: make a new environment for it")
        if at_once(wanted) != self.at_once:
            raise ValueError("that task has another number of targets at once: make a new environment for it")
        if terms_of(wanted) != terms_of(self.task):
            raise ValueError("that task has other terms: make a new environment for it")
        if self.backend.fit(self.config, houses) != self.config:
            raise ValueError("these houses need another body and step: make a new environment for them")
        check_kinds(houses, self.config.kinds)
        getattr(wanted, "check", lambda houses: None)(houses)
        bank = self.backend.pack(houses)
        about = surroundings(houses, bank, self.config, terms_of(wanted))
        return PackedHouses(list(houses), bank, wanted, *self._places(houses, bank, wanted), about)

    def take(self, loaded: PackedHouses) -> None:
        """Continue with the houses and the task that ``packed`` returned. Nothing is compiled."""
        self.houses, self.bank, self.task, self.lattices, self.places, about = loaded
        bank = self.bank
        self.arrays |= {"numbers": bank.numbers, "indices": bank.indices, "places": self._table()}
        self.arrays["surroundings"] = about
        self.arrays |= door_arrays(self.config, bank.geometries, self.num_envs)
        self._bind()
        if self.guided:
            self.guide(*self.unguided())
        if self.distances:
            self.distances.forget()

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

    def _table(self) -> Array:
        """Return the table ``places`` for kernels.

        It has the number of houses, their headers, then the starts and targets of each house.

        ``HEADER`` explains the headers.
        """
        count = len(self.places)
        header = np.zeros((count, HEADER), np.int32)
        at, rows = 1 + header.size, [np.array([count], np.int32), header.reshape(-1)]
        for k, (lattice, here) in enumerate(zip(self.lattices, self.places, strict=True)):
            starts, targets = len(here.starts), len(here.listed)
            listed = here.listed.view(np.int32).ravel()
            if here.stages:
                targets, listed = -len(here.stages), staged(here, at + starts)
            origin = np.asarray(lattice.origin, np.float32).view(np.int32)
            header[k] = (*origin, at, starts, at + starts, targets, here.heading)
            at += starts + len(listed)
            rows += [here.starts[:, 0] | here.starts[:, 1] << 16, listed]
        return Array.of(np.concatenate(rows))

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
        wholes[chosen, SEED:] = np.ascontiguousarray(seeds, "<u8").view("<i4").reshape(-1, 2)[chosen]
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
        if not self.guided:
            self.kernels, self.guided, self.launches = self._compile(guided=True), True, {}
            self.arrays["next_wholes"] = Array(ti.i32, self.num_envs, 4)
            self.arrays["next_reals"] = Array(ti.f32, self.num_envs, 4)
        self.arrays["next_wholes"].fill(next_wholes)
        self.arrays["next_reals"].fill(next_reals)

    def unguided(self) -> tuple[np.ndarray, np.ndarray]:
        """Return options that sample all values, (E, 4) int32 and float32."""
        wholes = np.zeros((self.num_envs, 4), np.int32)
        wholes[:, 0] = SAMPLE
        return wholes, np.full((self.num_envs, 4), np.nan, np.float32)

    def place(
        self, house: np.ndarray, pose: np.ndarray, bank: Bank | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return poses (E, 3) in houses (E,) as origins (E, 2) float32 and cells (E, 3) int32.

        ``bank``: the bank of the houses, by default this world's. Raises ``ValueError`` for a pose where the
        body cannot be.
        """
        bank = bank or self.bank
        origin, cell = self.backend.place(bank, house, pose)
        indoors = np.zeros(len(pose), bool)
        for k in np.unique(house):
            indoors[house == k] = bank.geometries[k].holds(pose[house == k, :2])
        arrays = {
            "numbers": bank.numbers,
            "indices": bank.indices,
            "cells": Array.of(np.column_stack([house, cell]).astype(np.int32).ravel()),
            "origins": Array.of(origin.astype(np.float32).ravel()),
            "free": Array(ti.i32, len(pose)),
        }
        Launch(self.kernels.stand, arrays)()
        free = indoors & (arrays["free"].numpy() != 0)
        if not free.all():
            e = int((~free).argmax())
            x, y = pose[e, :2]
            raise ValueError(f"pose {e}: the body cannot be at ({x:.3f}, {y:.3f}) m in house {house[e]}")
        return origin, cell

    def describe(
        self, last: bool = False, stepped: bool = False
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return copies of the eyes' poses (E, 3), the targets' centres (E, 2) and the houses (E,).

        ``last``: return the state at the end of the latest episode, if the same step begins the next one.
        ``stepped``: True right after a step; for few environments the step has then described the state
        already.
        """
        if last:
            self._describe_last()
        elif not (stepped and self.serial):
            self.run("describe")
        pose, target, house = (self.arrays[name].numpy() for name in ("pose", "target", "house"))
        return pose.reshape(-1, 3), target.reshape(-1, 2), house

    @cached_property
    def _describe_last(self) -> Launch:
        """Launch that describes the last states. It reads no array of the bank, so it stays bound."""
        last = {"reals": self.arrays["last_reals"], "wholes": self.arrays["last_wholes"]}
        return Launch(self.kernels.describe, self.arrays | last)

    def targets(self, count: int) -> np.ndarray:
        """Return the current and the next targets of each environment, (E, count, 2), metres."""
        arrays = self.arrays | {"targets": Array(ti.f32, self.num_envs * count * 2)}
        Launch(self.kernels.peek, arrays)()
        return arrays["targets"].numpy().reshape(self.num_envs, count, 2)

    def environment(self, e: int) -> dict[str, int]:
        """Return an environment's counters: steps, targets found + 1, end of the episode, its number."""
        whole = self.arrays["wholes"].numpy()[e]
        return {
            "time": int(whole[TIME]),
            "found": int(whole[FOUND]) - self.at_once + 1,
            "over": int(whole[OVER]),
            "episode": int(whole[NUMBER]),
        }

    @property
    def open_doors(self) -> np.ndarray:
        """Mask of the open doors of each environment, (E, D) bool, in the order of ``Geometry.doors``.

        Entries after a house's last door are False.
        """
        house = self.state["wholes"][:, HOUSE]
        count = np.array([len(shape.doors) for shape in self.bank.geometries])[house]
        most = max(len(shape.doors) for shape in self.bank.geometries)
        is_open = np.arange(most) < count[:, None]
        if self.config.closed_doors:
            pushes = self.arrays["pushes"].numpy().reshape(self.num_envs, -1)[:, :most]
            is_open &= pushes >= self.config.closed_doors
        return is_open

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Copies of the arrays that a step depends on, except the bank's: (E, 4) float32, (E, WHOLES) int32.

        With closed doors, also the number of pushes of each door, (E D,) uint8. There are more arrays for
        terms with a memory, for several targets, for latency, and for options of episodes that begin
        automatically.
        """
        return {name: self.arrays[name].numpy() for name in self._state_names}

    @state.setter
    def state(self, state: dict[str, np.ndarray]) -> None:
        for name in self._state_names:
            self.arrays[name].fill(state[name])
        if self.distances:
            self.distances.wait()
            self.distances.settle()

    @property
    def _state_names(self) -> tuple[str, ...]:
        doors = ("pushes",) * bool(self.config.closed_doors)
        extras = ("extras",) * bool(self.config.extras)
        past = ("past_reals", "past_cells") * bool(self.config.latency)
        odometer = ("odometer",) * ("odometry" in self.config.observe)
        memory, guide = ("memory",) * bool(self.config.memory), GUIDE * self.guided
        others = ("others",) * (self.at_once > 1)
        return (*STATE, *doors, *extras, *past, *odometer, *memory, *guide, *others)


def _require_countable(lattice: Lattice) -> None:
    """Raise ``ValueError`` for a lattice with too many places."""
    columns, rows = lattice.shape
    if columns * rows > MOST_PLACES or max(columns, rows) > MOST_ALONG:
        raise ValueError(
            f"it has {columns:,} by {rows:,} places, {lattice.pitch:.3g} m apart: {MOST_PLACES:,} at most, "
            f"and {MOST_ALONG:,} along an axis"
        )
