"""Motion in the free backend: speeds within limits, and sliding along obstacles."""

import numpy as np

from vitruvius.sim.backends.backend import Bank, Lattice, lattice_over
from vitruvius.sim.backends.blocks import HEADER, cell_of, end_of
from vitruvius.sim.backends.body import SKIN
from vitruvius.sim.backends.free.body import Disc, cosine_sine, wrapped
from vitruvius.sim.backends.free.contact import NEVER, gap, touches
from vitruvius.sim.backends.free.layout import FIRST_SOLID, ROW, listed
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import ti

CONTACTS = 4
"""Largest number of obstacles that a body slides along in one step; after these contacts it stays where it
is."""


CORNER = 1e-2
"""Fraction of a path along an obstacle. If more than this leads into the previous obstacle, both make a
corner."""


@ti.data_oriented
class Motion:
    """A disc among solids."""

    config: Config
    body: Disc

    @property
    def changes(self) -> tuple[float, ...]:
        """Largest change of each number of a command in a step."""
        drive = self.config.drive
        speed = min(1e9, drive.acceleration * drive.time_step)
        turn = min(1e9, drive.turn_acceleration * drive.time_step)
        return (speed,) * (len(drive.low) - 1) + (turn,)

    def lattice(self, shape: Geometry, origin: np.ndarray | None = None) -> Lattice:
        """Return a lattice of places one step apart, where episodes may start and targets may lie."""
        return lattice_over(shape, self.config.step, origin)

    def place(self, bank: Bank, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return origins (E, 2) and headings (E,) float32 of bodies at the given poses."""
        if not np.isfinite(pose).all():
            raise ValueError("a pose is (x, y, heading), three finite numbers")
        heading = np.mod(pose[:, 2], 2 * np.pi).astype(np.float32)
        heading[heading >= np.float32(2 * np.pi)] = 0
        return np.ascontiguousarray(pose[:, :2], np.float32), heading

    @ti.func
    def stands(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Return 1 if a body can be at a place of a lattice: see ``Backend.stands``."""
        place = self.body.position(origin, ti.Vector([cell[0], cell[1], 0]))
        block, free = cell_of(numbers, indices, house, place), 1
        for k in range(end_of(indices, block, 1)):
            away = gap(self.solid(numbers, indices, house, listed(indices, block, k)), place)
            free &= ti.cast(away.dot(away) >= ti.static((self.body.radius - SKIN) ** 2), ti.i32)
        return free

    @ti.func
    def move(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, action):
        """Return the cell one step forward on a lattice, and ``blocked``: see ``Backend.move``.

        Surveys of houses use this function.
        """
        forward = self.body.headings[cell[2]]
        new = ti.Vector([cell[0] + forward[0], cell[1] + forward[1], cell[2]])
        place = self.body.position(origin, cell)
        way = self.body.position(origin, new) - place
        block = cell_of(numbers, indices, house, place)
        share, _, _ = self.first(numbers, indices, house, block, place, way, 1.0)
        return new, ti.cast(share <= 1.0, ti.i32)

    @ti.func
    def solid(self, numbers: ti.template(), indices: ti.template(), house, k):
        """Return a solid of a house: see ``layout.py``."""
        at = indices[house * HEADER + FIRST_SOLID] + ROW * k
        return ti.Vector([numbers[at + part] for part in range(ROW)])

    @ti.func
    def first(self, numbers: ti.template(), indices: ti.template(), house, block, place, way, width):
        """Return a disc's first contact with the solids of a cell's list on its path: see ``touches``."""
        share, normal, depth = NEVER, ti.Vector([0.0, 0.0]), 0.0
        for k in range(end_of(indices, block, 1)):
            solid = self.solid(numbers, indices, house, listed(indices, block, k))
            at, leaned, inside = touches(
                solid,
                place,
                way,
                width * ti.static(self.body.radius),
                width * ti.static(self.body.radius - SKIN),
                width * ti.static(self.body.radius - SKIN / 2),
            )
            if (at < share) | ((at == share) & (at < ti.static(NEVER)) & (inside > depth)):
                share, normal, depth = at, leaned, inside
        return share, normal, depth

    @ti.func
    def drive(
        self, numbers: ti.template(), indices: ti.template(), house, origin, heading, speeds, action, shares
    ):
        """Return a body's origin, heading and speeds after a command, and 1 (i32) if an obstacle affected it.

        The body moves along the chord of its arc. An obstacle that slows the body also reduces its speed.
        Speeds, accelerations and width are scaled by ``shares`` (3,).
        """
        # speed up
        wanted = shares[0] * self.body.ordered(action)
        limits = ti.Vector([ti.static(self.changes[k]) for k in ti.static(range(len(self.changes)))])
        limits *= shares[1]
        speeds += ti.max(-limits, ti.min(limits, wanted - speeds))
        half = ti.static(0.5 * self.config.drive.time_step) * speeds[ti.static(len(self.changes) - 1)]
        # move: the chord of an arc with angle 2 a is sin(a) / a of its length, about 1 - a^2 / 6 for small a
        cosine, sine = cosine_sine(heading + half)
        _, bent = cosine_sine(half)
        chord = ti.select(ti.abs(half) < 1e-2, 1.0 - half * half / 6.0, bent / half)
        length = ti.static(self.config.drive.time_step) * speeds[0] * chord
        direction = ti.Vector([cosine, -sine])
        if ti.static(self.body.sideways):
            length = ti.static(self.config.drive.time_step) * chord
            direction = ti.Vector(
                [cosine * speeds[0] - sine * speeds[1], -(sine * speeds[0] + cosine * speeds[1])]
            )
        moved = self.slide(numbers, indices, house, origin, length * direction, shares[2])
        # collide
        off = moved - length * direction
        blocked = ti.cast(off.dot(off) > ti.static(SKIN**2), ti.i32)
        if blocked:
            if ti.static(self.body.sideways):
                made = moved / length
                speeds[0], speeds[1] = cosine * made[0] - sine * made[1], -(sine * made[0] + cosine * made[1])
                for k in ti.static(range(2)):
                    speeds[k] = ti.max(
                        ti.static(self.config.drive.low[k]),
                        ti.min(ti.static(self.config.drive.high[k]), speeds[k]),
                    )
            else:
                speeds[0] *= ti.max(0.0, ti.min(1.0, moved.dot(direction) / length))
        return origin + moved, wrapped(heading + 2.0 * half), self.body.in_parts(speeds), blocked

    @ti.func
    def slide(self, numbers: ti.template(), indices: ti.template(), house, origin, way, width):
        """Return the displacement of a body that tries to move by ``way`` (x, y), metres."""
        block = cell_of(numbers, indices, house, origin)
        moved, left, last, turn = ti.Vector([0.0, 0.0]), way, ti.Vector([0.0, 0.0]), 0
        while turn < ti.static(CONTACTS):
            turn += 1
            share, normal, depth = self.first(numbers, indices, house, block, origin + moved, left, width)
            if share > 1.0:
                moved += left
                turn = CONTACTS
            else:
                # Rounding may have left the body slightly inside: move it out again.
                moved += share * left + ti.min(depth, ti.static(SKIN)) * normal
                left = (1.0 - share) * left
                if ti.static(self.config.drive.at_contact == "stop"):
                    turn = CONTACTS
                else:
                    left -= ti.min(0.0, left.dot(normal)) * normal
                    if left.dot(last) < -ti.static(CORNER) * left.norm():  # into the previous obstacle
                        turn = CONTACTS
                    last = normal
        return moved
