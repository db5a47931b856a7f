"""Exact posterior over a target's places, given the observations of a body.

A spot remains possible until a ray passes it that would have met a target there. The information gain of a
look is estimated with samples of the spots, each with a weight.
"""

import numpy as np

from vitruvius.agent.baselines.coverage import WORD, LineOfSight, bit, origins_of
from vitruvius.agent.baselines.priors import Uniform
from vitruvius.sim.backends.backend import TARGET
from vitruvius.sim.runtime import Array, ti
from vitruvius.sim.world.states import loaded
from vitruvius.sim.world.world import World

Rows = ti.types.ndarray(ti.types.vector(8, ti.i32), 1)
SPOT, SPOTS, SAMPLE, SAMPLED, VIEW = range(5)
"""Indices of a house's row: its first spot, number of spots, first sample, number of samples, first view. A
planner adds three more."""

EPISODE, FOUND, KNOWN, DONE, LENGTH = range(5)
"""Indices of an environment's notes: episode and number of its target, 1 if the target has been seen; and the
plan."""

Notes = ti.types.ndarray(ti.types.vector(5, ti.i32), 1)
Points = ti.types.ndarray(ti.types.vector(2, ti.f32), 1)

MAX_PLANNING = 32
"""Number of environments that plan together; it bounds the memory of their tables."""


def posterior_arrays(world: World, prior: Uniform, views: np.ndarray, more: np.ndarray) -> dict[str, Array]:
    """Return the arrays of a posterior for a world.

    ``views`` (H,) has the number of views of each house, and ``more`` (H, 3) three numbers for the planner.
    The posterior is empty until ``Posterior.watched`` fills it. Raises ``ValueError`` for too many houses.
    """
    spots, samples, count = prior.spots, prior.samples, world.num_envs
    sizes = np.array([[len(places) for places in each] for each in (spots, samples)])
    words = -(-sizes[1].max() // WORD)
    if views.sum() * words >= 1 << 31:
        raise ValueError(f"{len(spots)} houses are too many for one searcher: pass them in smaller groups")
    rows = np.column_stack([starts(sizes[0]), sizes[0], starts(sizes[1]), sizes[1], starts(views), more])
    arrays = {
        "spots": Array.of(np.concatenate(spots).ravel()),
        "samples": Array.of(np.concatenate(samples).astype(np.int32)),
        "rows": Array(ti.i32, len(rows), rows.shape[1]),
        "origins": Array.of(origins_of(world)),
        "shown": Array(ti.u64, int(views.sum() * words)),
        "left": Array(ti.u64, count * -(-int(sizes[0].max()) // WORD)),
        "sampled": Array(ti.u64, int(min(count, MAX_PLANNING) * words)),
        "weights": Array.of(np.ones(count * words, np.float32)),
        "notes": Array(ti.i32, count, 5),
        "last": Array(ti.f32, count, 2),
    }
    arrays["rows"].fill(rows.astype(np.int32))
    return arrays


def starts(counts: np.ndarray) -> np.ndarray:
    """Return the index at which each part begins if parts of these lengths are concatenated."""
    return np.cumsum([0, *counts])[:-1]


@ti.data_oriented
class Posterior:
    """Posterior of one environment's searcher, as functions of its arrays: see ``SearcherArrays``."""

    def __init__(self, sight: LineOfSight) -> None:
        """Take the line of sight of the bodies."""
        self.sight, self.episodes = sight, sight.episodes

    @ti.func
    def first_left(self, search: ti.template(), e):
        """Return the index of an environment's first word in ``left``."""
        return e * (search.left.shape[0] // search.notes.shape[0])

    @ti.func
    def corner(self, search: ti.template(), house):
        """Return the origin of a house's lattice, metres."""
        return ti.Vector([search.origins[2 * house], search.origins[2 * house + 1]])

    @ti.func
    def house_of(self, search: ti.template(), view):
        """Return the house of a view."""
        house, end = 0, search.rows.shape[0] - 1
        while house < end and search.rows[house + 1][VIEW] <= view:
            house += 1
        return house

    @ti.func
    def restart(self, search: ti.template(), e, state, near):
        """Begin with a new target, which may be anywhere except close to the last one.

        The world samples no target there.
        """
        row, first, some = search.rows[state.house], self.first_left(search, e), 0
        corner = self.corner(search, state.house)
        self.fill(search, row, first)
        for k in range(row[SPOTS]):
            at = 2 * (row[SPOT] + k)
            spot = self.sight.spot(corner, search.spots[at], search.spots[at + 1])
            if ti.abs(spot - near).max() < ti.static(self.episodes.apart):  # never where near is NaN
                search.left[first + k // ti.static(WORD)] ^= bit(k)
            else:
                some = 1
        if not some:
            self.fill(search, row, first)

    @ti.func
    def fill(self, search: ti.template(), row, first):
        """Mark all spots as possible; ``first``: see ``first_left``."""
        for word in range(first, first + search.left.shape[0] // search.notes.shape[0]):
            search.left[word] = 0
        for k in range(row[SPOTS]):
            search.left[first + k // ti.static(WORD)] |= bit(k)

    @ti.func
    def watched(self, world: ti.template(), search: ti.template(), e):
        """Look from the body's pose, for a new target after a pick-up. Return the environment's notes."""
        state, note = loaded(world, e), search.notes[e]
        if note[EPISODE] != state.episode or note[FOUND] != state.found:
            near = ti.Vector([ti.math.nan, ti.math.nan])
            if note[EPISODE] == state.episode:
                near = search.last[e]
            self.restart(search, e, state, near)
            note = ti.Vector([state.episode, state.found, 0, 0, 0])
            search.last[e] = state.target
        if not note[KNOWN]:
            known = self.look(world, search, e, state)
            if known:
                note[KNOWN], note[LENGTH] = 1, 0
        return note

    @ti.func
    def look(self, world: ti.template(), search: ti.template(), e, state):
        """Return 1 if a ray meets the target; otherwise exclude the spots where a ray would have met it."""
        distance, kinds = self.sight.backend.see(
            world.numbers, world.indices, state.house, state.origin, state.cell, state.target, 0
        )
        known = 0
        for r in range(ti.static(self.sight.config.rays)):
            known |= ti.cast(kinds[r] == ti.static(TARGET), ti.i32)
        if not known:
            row, left = search.rows[state.house], self.first_left(search, e)
            corner = self.corner(search, state.house)
            window = self.sight.window(distance, corner, state.origin, state.cell)
            for word in range((row[SPOTS] + ti.static(WORD - 1)) // ti.static(WORD)):
                first = row[SPOT] + word * ti.static(WORD)
                end = ti.min(first + ti.static(WORD), row[SPOT] + row[SPOTS])
                # Spots are in the order of their i: most words are completely outside the window.
                if search.left[left + word] != 0 and search.spots[2 * first] <= window[1]:  # noqa: SIM102
                    if search.spots[2 * (end - 1)] >= window[0]:
                        for k in range(first, end):
                            i, j = search.spots[2 * k], search.spots[2 * k + 1]
                            mask = bit(k - row[SPOT])
                            if search.left[left + word] & mask and window[2] <= j <= window[3]:
                                spot = self.sight.spot(corner, i, j)
                                if self.sight.meets(distance, state.origin, state.cell, spot):
                                    search.left[left + word] ^= mask
        return known

    @ti.func
    def sample(self, search: ti.template(), row, e, slot, words):
        """Record the samples that remain possible, and return their total weight."""
        left, total = self.first_left(search, e), ti.f32(0.0)
        for word in range(words):
            search.sampled[slot * words + word] = 0
        for k in range(row[SAMPLED]):
            spot = search.samples[row[SAMPLE] + k]
            if search.left[left + spot // ti.static(WORD)] & bit(spot):
                search.sampled[slot * words + k // ti.static(WORD)] |= bit(k)
                total += search.weights[e * words + k // ti.static(WORD)]
        return total

    @ti.func
    def weighed(self, search: ti.template(), row, e, slot, words, view):
        """Return the weight of the samples that remain possible and that a view shows."""
        gain = ti.f32(0.0)
        for word in range((row[SAMPLED] + ti.static(WORD - 1)) // ti.static(WORD)):
            both = search.shown[view * words + word] & search.sampled[slot * words + word]
            gain += search.weights[e * words + word] * ti.cast(ti.math.popcnt(both), ti.f32)
        return gain

    @ti.func
    def turned(self, world: ti.template(), search: ti.template(), base, weight, state, cell):
        """Return the weight of the samples that remain possible and that a look from a cell would show."""
        row, corner = search.rows[state.house], self.corner(search, state.house)
        distance = self.sight.distances(world, state.house, state.origin, cell)
        window, gain = self.sight.window(distance, corner, state.origin, cell), ti.f32(0.0)
        for k in range(row[SAMPLED]):
            at = 2 * (row[SPOT] + search.samples[row[SAMPLE] + k])
            i, j = search.spots[at], search.spots[at + 1]
            inside = window[0] <= i <= window[1] and window[2] <= j <= window[3]
            if inside and search.sampled[base + k // ti.static(WORD)] & bit(k):
                met = self.sight.meets(distance, state.origin, cell, self.sight.spot(corner, i, j))
                gain += search.weights[weight + k // ti.static(WORD)] * ti.cast(met, ti.f32)
        return gain

    @ti.func
    def show(self, world: ti.template(), search: ti.template(), house, origin, cell, view, words):
        """Record the samples that a view of a house shows, from an origin and a cell."""
        row, corner = search.rows[house], self.corner(search, house)
        distance = self.sight.distances(world, house, origin, cell)
        window = self.sight.window(distance, corner, origin, cell)
        for k in range(row[SAMPLED]):
            at = 2 * (row[SPOT] + search.samples[row[SAMPLE] + k])
            i, j = search.spots[at], search.spots[at + 1]
            # Nested, because Taichi's ``and`` computes both sides.
            if window[0] <= i <= window[1] and window[2] <= j <= window[3]:  # noqa: SIM102
                if self.sight.meets(distance, origin, cell, self.sight.spot(corner, i, j)):
                    search.shown[view * words + k // ti.static(WORD)] |= bit(k)
