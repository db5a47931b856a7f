# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""Where a searcher that drives goes: to the view that gains most for the time that it takes.

The information gain of a view is the weight of the places of the target that are left and that a look from
there would show. Its time is that of a shortest path there and of the turns at both ends, and a little more.
"""

from math import pi
from typing import NamedTuple

from sim.baselines.coverage import WORD, LineOfSight, bit
from sim.baselines.path_follower import solid_of
from sim.baselines.posterior import DONE, KNOWN, LENGTH, SPOT, SPOTS, VIEW, Notes, Points, Posterior, Rows
from sim.baselines.roadmap import FAR, graph, point, sees
from sim.runtime import Bytes, Floats, Ints, Words, ti

HEADINGS = 8
"""Of the views at a place: as many as a byte has bits."""

VIEW_TIME = 1.2
"""Seconds added to the time that a view takes when views are compared."""

NEAR, FACING = 0.15, 0.2
"""Metres and radians: a body is at a view that it is no further off."""

MOVED = 0.3
"""Metres after which views from where a body stands are others."""

PATIENCE = 2.0, 3.0
"""A view to which a body has not come in so many times the time that it counted on, and so many seconds, is
given up."""

PLACES, TABLE = VIEW + 1, VIEW + 2
"""Of a house: its places of views, and where its ways from places to corners begin."""


class GoalArrays(NamedTuple):
    """What searchers that drive know of the houses, and keep: see ``SearcherArrays`` for the first ones."""

    spots: Floats
    samples: Ints
    rows: Rows
    origins: Floats
    shown: Words
    left: Words
    sampled: Words
    weights: Floats
    notes: Notes
    last: Points
    corners: Floats
    firsts: Ints
    lengths: Floats
    viewpoints: Floats
    """(x, y) of the places of views, house by house, metres."""
    ways: Floats
    """Metres of the shortest path from each place to each corner of its house."""
    through: Ints
    """The first corner on it."""
    near: Floats
    """Of each slot: metres from the body to each corner that it sees, ``FAR`` to the others."""
    tried: Bytes
    """Of each environment and place of its house, and then of where it stands: a bit for each view at which
    it was, or which it gave up."""
    stood: Points
    """Of each environment: where the views are that it last had where it stood."""
    chosen: Ints
    """Of each environment: its view among those of its house, -1 where it goes to no view."""
    due: Ints
    """Of each environment: steps until it gives its view up."""
    goal: Floats
    half: Floats
    facing: Floats
    """Of each environment: the heading of its view."""


@ti.func
def bearing(way):
    """The direction of a way, radians."""
    return ti.atan2(-way[1], way[0])


@ti.func
def between(one, other):
    """The angle between two directions, radians."""
    off = ti.abs(one - other) * ti.static(0.5 / pi)
    return ti.abs(off - ti.round(off)) * ti.static(2 * pi)


@ti.data_oriented
class ViewGoals(Posterior):
    """Where one environment's searcher goes, as functions of its arrays."""

    def __init__(self, sight: LineOfSight) -> None:
        """For bodies that see so."""
        super().__init__(sight)
        self.config, self.drive, self.body = sight.config, sight.config.drive, sight.episodes.body
        self.solid = solid_of(sight.config.body[0] / 2)
        self.turn_time = 1 / max(self.drive.turn_speed, 1e-3)

    @ti.func
    def first_tried(self, search: ti.template(), e):
        """Where an environment's bytes of ``tried`` begin."""
        return e * (search.tried.shape[0] // search.notes.shape[0])

    @ti.func
    def looking(self, look):
        """The cell of a body with one of the headings of views."""
        return ti.Vector([0, 0, ti.bit_cast(ti.cast(look, ti.f32) * ti.static(2 * pi / HEADINGS), ti.i32)])

    @ti.func
    def join(self, world: ti.template(), search: ti.template(), house, v):
        """Note the ways from a house's place to all corners."""
        row, place = search.rows[house], point(search.viewpoints, search.rows[house][VIEW] // HEADINGS + v)
        first, count, table = graph(search, house)
        at = row[TABLE] + v * count
        for c in range(count):
            corner = point(search.corners, first + c)
            search.ways[at + c], search.through[at + c] = FAR, -1
            if sees(world, house, place, corner, ti.static(self.solid), True):
                search.ways[at + c], search.through[at + c] = (corner - place).norm(), c
        for c in range(count):
            if search.through[at + c] != c:
                for other in range(count):
                    if search.through[at + other] == other:
                        by = search.ways[at + other] + search.lengths[table + other * count + c]
                        if by < search.ways[at + c]:
                            search.ways[at + c], search.through[at + c] = by, other

    @ti.func
    def decide(self, world: ti.template(), search: ti.template(), e, slot, slots, state, note, replan):
        """Set an environment's goal where its plan is at its end; its notes."""
        if note[KNOWN]:
            self.go(search, e, state.target, ti.static(self.config.target / 2))
        else:
            chosen = search.chosen[e]
            if chosen >= 0:
                search.due[e] -= 1
                away = (state.origin - point(search.goal, e)).norm()
                off = between(search.facing[e], self.body.heading(state.cell))
                if (away < NEAR and off < FACING) or search.due[e] <= 0:
                    at = self.first_tried(search, e) + chosen // HEADINGS
                    search.tried[at] |= ti.cast(1 << chosen % HEADINGS, ti.u8)
                    note[LENGTH] = 0
            if note[DONE] >= note[LENGTH]:
                self.plan(world, search, e, slot, slots, state)
                note[DONE], note[LENGTH] = 0, replan
            note[DONE] += 1
        return note

    @ti.func
    def go(self, search: ti.template(), e, place, half):
        """Go to a place, or with a ``half`` to what is picked up there, not for a view."""
        search.goal[2 * e], search.goal[2 * e + 1] = place[0], place[1]
        search.half[e], search.chosen[e] = half, -1

    @ti.func
    def forget(self, search: ti.template(), e):
        """No view was tried."""
        search.chosen[e] = -1
        first = self.first_tried(search, e)
        for k in range(first, self.first_tried(search, e + 1)):
            search.tried[k] = ti.u8(0)

    @ti.func
    def plan(self, world: ti.template(), search: ti.template(), e, slot, slots, state):
        """Choose the best view, or else the nearest spot that is left."""
        row, words = search.rows[state.house], search.sampled.shape[0] // slots
        total = self.sample(search, row, e, slot, words)
        here, heading = state.origin, self.body.heading(state.cell)
        tried, before = self.first_tried(search, e), search.chosen[e]
        chosen, best, time = self.turn(world, search, row, e, slot, words, state)
        end = here
        base = slot * (search.near.shape[0] // slots)
        first, count, _ = graph(search, state.house)
        self.look_out(world, search, state.house, base, here)
        for v in range(row[PLACES]):
            place = point(search.viewpoints, row[VIEW] // HEADINGS + v)
            least = (place - here).norm() * ti.static(1 / self.drive.speed) + VIEW_TIME
            if total > best * least:
                length, leaves, comes = (place - here).norm(), bearing(place - here), bearing(place - here)
                if not sees(world, state.house, here, place, ti.static(self.solid), True):
                    length = FAR
                    for c in range(count):
                        by = search.near[base + c] + search.ways[row[TABLE] + v * count + c]
                        if by < length:
                            length = by
                            leaves = bearing(point(search.corners, first + c) - here)
                            last = search.through[row[TABLE] + v * count + c]
                            comes = bearing(place - point(search.corners, first + last))
                if length < FAR:
                    way = length * ti.static(1 / self.drive.speed)
                    way += between(leaves, heading) * ti.static(self.turn_time)
                    for look in range(HEADINGS):
                        if not (search.tried[tried + v] >> ti.cast(look, ti.u8) & ti.u8(1)):
                            view = HEADINGS * v + look
                            gain = self.weighed(search, row, e, slot, words, row[VIEW] + view)
                            off = between(ti.cast(look, ti.f32) * ti.static(2 * pi / HEADINGS), comes)
                            takes = way + off * ti.static(self.turn_time)
                            if gain > best * (takes + VIEW_TIME):
                                chosen, best, end, time = view, gain / (takes + VIEW_TIME), place, takes
        if chosen >= 0:
            self.go(search, e, end, 0.0)
            search.chosen[e] = chosen
            search.facing[e] = self.body.heading(self.looking(chosen % HEADINGS))
            if chosen != before:
                patient = ti.static(PATIENCE[0]) * time + ti.static(PATIENCE[1])
                search.due[e] = ti.cast(ti.ceil(patient / ti.static(self.drive.time_step)), ti.i32)
        else:
            self.go(search, e, self.nearest(world, search, row, e, base, state), self.sight.half)

    @ti.func
    def turn(self, world: ti.template(), search: ti.template(), row, e, slot, words, state):
        """The best view from where the body stands, -1 for none, what it gains a second, and its seconds."""
        at = self.first_tried(search, e) + row[PLACES]
        if (state.origin - search.stood[e]).norm() > MOVED:
            search.stood[e], search.tried[at] = state.origin, ti.u8(0)
        chosen, best, time = -1, ti.f32(0.0), ti.f32(0.0)
        for look in range(HEADINGS):
            cell = self.looking(look)
            off = between(self.body.heading(cell), self.body.heading(state.cell))
            if off > FACING and not (search.tried[at] >> ti.cast(look, ti.u8) & ti.u8(1)):
                gain = self.turned(world, search, slot * words, e * words, state, cell)
                takes = off * ti.static(self.turn_time)
                if gain > best * (takes + VIEW_TIME):
                    chosen, best, time = HEADINGS * row[PLACES] + look, gain / (takes + VIEW_TIME), takes
        return chosen, best, time

    @ti.func
    def look_out(self, world: ti.template(), search: ti.template(), house, base, here):
        """Note how far each corner is that is in sight."""
        first, count, _ = graph(search, house)
        for c in range(count):
            corner = point(search.corners, first + c)
            search.near[base + c] = FAR
            if sees(world, house, here, corner, ti.static(self.solid), True):
                search.near[base + c] = (corner - here).norm()

    @ti.func
    def nearest(self, world: ti.template(), search: ti.template(), row, e, base, state):
        """The spot that is left with the shortest path to it, where no view shows one; where the body is if
        none is left. One without a path counts as further off than all others.
        """
        left, corner = self.first_left(search, e), self.corner(search, state.house)
        best, place = ti.f32(2 * FAR), state.origin
        for k in range(row[SPOTS]):
            if search.left[left + k // ti.static(WORD)] & bit(k):
                at = 2 * (row[SPOT] + k)
                spot = self.sight.spot(corner, search.spots[at], search.spots[at + 1])
                if (spot - state.origin).norm() < best:
                    length = self.length_to(world, search, state.house, base, state.origin, spot)
                    if length < best:
                        best, place = length, spot
        if best == ti.f32(2 * FAR):
            # A target that rounding hid: look for it again.
            self.fill(search, row, left)
            self.forget(search, e)
        return place

    @ti.func
    def length_to(self, world: ti.template(), search: ti.template(), house, base, here, place):
        """Metres of the shortest path to a place; ``FAR`` more than straight where there is none."""
        straight = (place - here).norm()
        length = FAR + straight
        if sees(world, house, here, place, ti.static(self.solid), True):
            length = straight
        else:
            first, count, table = graph(search, house)
            for c in range(count):
                corner = point(search.corners, first + c)
                if sees(world, house, corner, place, ti.static(self.solid), True):
                    last = (place - corner).norm()
                    for other in range(count):
                        way = search.near[base + other] + search.lengths[table + other * count + c]
                        length = ti.min(length, way + last)
        return length
