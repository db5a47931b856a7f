# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false, reportOptionalCall=false
"""The continuous backend: exact geometry of axis-aligned boxes, in metres.

A direction is one of few (headings are multiples of 45 degrees, rays a divisor of that apart), so a table
holds them all and the kernel knows no trigonometry. Each box is read once and meets all rays in an inner
loop over local vectors that holds no branch: the compiler makes vector instructions of it.
"""

from collections.abc import Sequence

import numpy as np

from logic import House
from sim.backend import Lattice
from sim.body import SKIN, Body
from sim.config import Config
from sim.geometry import Geometry, geometry
from sim.runtime import ti

FARTHEST = 100.0
"""Metres from the origin that a house may reach: beyond, float32 places are coarser than ``SKIN``."""

SEAM = 2e-5
"""Metres by which a box reaches beyond its corners for a ray, so that none slips through where two meet."""


@ti.data_oriented
class Continuous:
    """A bank of H houses in padded arrays on the device, and one body's motion and sight in them."""

    def __init__(self, config: Config) -> None:
        """Make the table of directions; ``pack`` brings the houses."""
        self.config = config
        self.body = Body(config)
        self.turns_in_place = config.body[0] == config.body[1]
        self.reach = max(config.body) + config.step
        self.vector = ti.types.vector(config.rays, ti.f32)
        self.geometries: list[Geometry] = []
        # Row k is the direction first_ray - k * spacing; heading h looks along rows turn * -h + (0..rays-1).
        self.turn = 45 // config.ray_spacing
        rows = np.arange(8 * self.turn + config.rays)
        angle = np.deg2rad(config.first_ray - config.ray_spacing * rows)
        east, south = np.cos(angle), -np.sin(angle)
        east[np.abs(east) < 1e-12] = 1e-30
        south[np.abs(south) < 1e-12] = 1e-30
        self.directions = ti.Vector.field(4, ti.f32, shape=len(angle))
        table = np.stack([1 / east, 1 / south, south / east, east / south], axis=1)
        self.directions.from_numpy(table.astype(np.float32))

    def pack(self, houses: Sequence[House]) -> list[Geometry]:
        """Upload a bank: boxes (H, B, 4) by their edges, padded, of each house verticals, then horizontals,
        then pieces, and where each kind ends; floor, rooms and doors for the original's collision rule.
        """
        self.geometries = [geometry(house) for house in houses]
        bank, rooms = self.geometries, [np.vstack([g.floor, g.rooms]) for g in self.geometries]
        self.boxes = _padded([_edges(g.solids) for g in bank])
        self.rooms = _padded(rooms)
        self.doors = _padded([g.doors for g in bank])
        ends = np.array([(len(g.verticals), len(g.horizontals), len(g.pieces)) for g in bank]).cumsum(axis=1)
        self.ends = ti.Vector.field(4, ti.i32, shape=len(bank))
        self.ends.from_numpy(np.column_stack([ends, [len(r) for r in rooms]]).astype(np.int32))
        return self.geometries

    def lattice(self, house: int, origin: np.ndarray | None = None) -> Lattice:
        """A house's own lattice lies half a step off its corner, so that no body is flush by construction."""
        west, north, east, south = self.geometries[house].bounds
        if max(abs(west), abs(north), abs(east), abs(south)) > FARTHEST:
            raise ValueError(f"it reaches further than {FARTHEST:.0f} m from the origin")
        corner, step = np.array([west, north]), self.config.step
        if origin is None:
            origin = (corner + step / 2).astype(np.float32)
        i, j = np.ceil((corner - origin) / step).astype(int).tolist()
        columns, rows = (np.floor((np.array([east, south]) - origin) / step).astype(int) + 1).tolist()
        return Lattice(origin, step, (columns - i, rows - j), (i, j))

    def survey(self, house: int, lattice: Lattice) -> np.ndarray:
        """See ``Backend.survey``."""
        table = np.zeros(lattice.shape, np.uint16)
        self._survey(house, ti.math.vec2(lattice.origin), ti.math.ivec2(lattice.first), table)
        return table

    def place(self, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Put origins through the given poses; a heading must be a multiple of 45 degrees."""
        eighths = pose[:, 2] / (np.pi / 4)
        heading = np.round(eighths)
        if not np.isfinite(pose).all() or np.abs(eighths - heading).max() > 1e-3:
            raise ValueError("a pose is (x, y, heading): finite, heading a multiple of pi/4 radians")
        cell = np.zeros((len(pose), 3), np.int32)
        cell[:, 2] = heading.astype(np.int64) % 8
        shift = np.where(cell[:, 2] % 2, self.config.eye[1] - self.config.eye[0], 0.0)
        origin = np.ascontiguousarray(pose[:, :2] - shift[:, None], np.float32)
        blocked = np.zeros(len(pose), np.uint8)
        self._stand(house.astype(np.int32), origin, cell, blocked)
        if blocked.any():
            e = int(blocked.argmax())
            x, y = pose[e, :2]
            raise ValueError(f"pose {e}: the body cannot be at ({x:.3f}, {y:.3f}) m in house {house[e]}")
        return origin, cell

    @ti.kernel
    def _survey(
        self,
        house: ti.i32,
        origin: ti.math.vec2,
        first: ti.math.ivec2,
        table: ti.types.ndarray(ti.u16, 2),
    ):
        for column, row in ti.ndrange(table.shape[0], table.shape[1]):
            i, j = column + first[0], row + first[1]
            ways = 0x3FF
            if ti.static(self.config.collision == "swept"):
                here = self.body.centre(origin, ti.Vector([i, j, 0]))
                reach = ti.static(self.reach)
                for k in range(self.ends[house][2]):
                    # Most boxes are out of reach at any heading: they cost one test, not ten.
                    if self.meets(house, k, here, here, reach):
                        for way in range(10):
                            cell = ti.Vector([i, j, way & 7])
                            new = cell
                            if way < 8:
                                new = self.body.ahead(cell)
                            p, q, half = self.path(origin, cell, new)
                            ways &= ~(self.meets(house, k, p, q, half) << way)
            else:
                for way in range(10):
                    new = ti.Vector([i, j, way & 7])
                    if way < 8:
                        new = self.body.ahead(new)
                    ways &= ~(self.blocked(house, origin, new, new) << way)
            table[column, row] = ti.cast(ways, ti.u16)

    @ti.kernel
    def _stand(
        self,
        house: ti.types.ndarray(ti.i32, 1),
        origin: ti.types.ndarray(ti.f32, 2),
        cell: ti.types.ndarray(ti.i32, 2),
        blocked: ti.types.ndarray(ti.u8, 1),
    ):
        for e in range(house.shape[0]):
            here = ti.Vector([cell[e, 0], cell[e, 1], cell[e, 2]])
            at = ti.Vector([origin[e, 0], origin[e, 1]])
            blocked[e] = ti.cast(self.blocked(house[e], at, here, here), ti.u8)

    @ti.func
    def move(self, house, origin, cell, action):
        """See ``Backend.move``."""
        new = cell
        blocked = 0
        if action == 2:
            new = self.body.ahead(cell)
            blocked = self.blocked(house, origin, cell, new)
        else:
            new[2] = (cell[2] + ti.select(action == 0, 1, 7)) & 7
            # A square that is the same at all headings turns in place.
            if ti.static(not self.turns_in_place):
                blocked = self.blocked(house, origin, new, new)
        return new, blocked

    @ti.func
    def blocked(self, house, origin, cell, new):
        """Whether something is in the way from a cell to a new one (i32)."""
        result = 0
        if ti.static(self.config.collision == "swept"):
            p, q, half = self.path(origin, cell, new)
            for k in range(self.ends[house][2]):
                result |= self.meets(house, k, p, q, half)
        else:
            result = self.original(house, self.body.centre(origin, new), self.body.half(new))
        return result

    @ti.func
    def path(self, origin, cell, new):
        """From where to where the body's centre goes, and half its side, that of the new heading."""
        half = self.body.half(new)
        return (
            self.body.centre(origin, cell) + (half - self.body.half(cell)),
            self.body.centre(origin, new),
            half,
        )

    @ti.func
    def meets(self, house, k, p, q, half):
        """Whether a square that slides from p to q meets box k (i32): three axes to separate them by, x, y
        and across the way. The same bits for p to q as for q to p, so that ways can be searched backwards.
        """
        box = self.boxes[house, k]
        x, y = 0.5 * (p[0] + q[0] - box[0] - box[2]), 0.5 * (p[1] + q[1] - box[1] - box[3])
        dx, dy = ti.abs(q[0] - p[0]), ti.abs(q[1] - p[1])
        width = 0.5 * (box[2] - box[0]) + half - ti.static(SKIN)
        height = 0.5 * (box[3] - box[1]) + half - ti.static(SKIN)
        near = (ti.abs(x) < width + 0.5 * dx) & (ti.abs(y) < height + 0.5 * dy)
        across = ti.abs((q[0] - p[0]) * y - (q[1] - p[1]) * x) <= dx * height + dy * width
        return ti.cast(near & across, ti.i32)

    @ti.func
    def original(self, house, centre, half):
        """The original program's rule at the new place, with its gaps: a body astride a room's boundary must
        be within the span of that room's door, whichever wall the door is in; one inside a room must not
        meet furniture; one in no room must be inside the main room's rectangle.
        """
        ends = self.ends[house]
        met, inside, touched = 0, 0, 0
        for k in range(1, ends[3]):
            room, door = self.rooms[house, k], self.doors[house, k - 1]
            x, y = ti.abs(centre[0] - room[0]), ti.abs(centre[1] - room[1])
            if (x < room[2] + half - ti.static(SKIN)) & (y < room[3] + half - ti.static(SKIN)):
                touched = 1
                if (x <= room[2] - half + ti.static(SKIN)) & (y <= room[3] - half + ti.static(SKIN)):
                    inside = 1
                else:
                    along = ti.select(door[2] == 0, centre[1] - door[1], centre[0] - door[0])
                    met |= ti.cast(ti.abs(along) > ti.max(door[2], door[3]) - half + ti.static(SKIN), ti.i32)
        if inside:
            for k in range(ends[1], ends[2]):
                met |= self.meets(house, k, centre, centre, half)
        if not touched:
            floor = self.rooms[house, 0]
            x, y = ti.abs(centre[0] - floor[0]), ti.abs(centre[1] - floor[1])
            within = (x <= floor[2] - half + ti.static(SKIN)) & (y <= floor[3] - half + ti.static(SKIN))
            met |= ti.cast(not within, ti.i32)
        return met

    @ti.func
    def see(self, house, origin, cell, target):
        """See ``Backend.see``. Of hits at one distance a wall comes before a piece, a piece before the
        target; a box is seen from outside only.
        """
        eye = self.body.eye(origin, cell)
        # Local copies: read from the table in the inner loops they would cost the vector instructions.
        over_x, over_y = self.vector(0.0), self.vector(0.0)
        slope_x, slope_y = self.vector(0.0), self.vector(0.0)
        first = ((8 - cell[2]) & 7) * ti.static(self.turn)
        for r in range(ti.static(self.config.rays)):
            row = self.directions[first + r]
            over_x[r], over_y[r], slope_x[r], slope_y[r] = row[0], row[1], row[2], row[3]
        distance = self.vector(ti.static(self.config.range))
        ends = self.ends[house]
        for k in range(ends[0]):
            box = self.boxes[house, k]
            x = box[0] - eye[0]
            y, reach = extent(box[1], box[3], eye[1])
            for r in range(ti.static(self.config.rays)):
                t = x * over_x[r]
                hit = (ti.abs(x * slope_x[r] - y) <= reach) & (t >= 0) & (t < distance[r])
                distance[r] = ti.select(hit, t, distance[r])
        for k in range(ends[0], ends[1]):
            box = self.boxes[house, k]
            y = box[1] - eye[1]
            x, reach = extent(box[0], box[2], eye[0])
            for r in range(ti.static(self.config.rays)):
                t = y * over_y[r]
                hit = (ti.abs(y * slope_y[r] - x) <= reach) & (t >= 0) & (t < distance[r])
                distance[r] = ti.select(hit, t, distance[r])
        for k in range(ends[1], ends[2]):
            box = self.boxes[house, k]
            face_x, face_y = facing(box[0], box[2], eye[0]), facing(box[1], box[3], eye[1])
            x, reach_x = extent(box[0], box[2], eye[0])
            y, reach_y = extent(box[1], box[3], eye[1])
            for r in range(ti.static(self.config.rays)):
                t = face_x * over_x[r]
                hit = (ti.abs(face_x * slope_x[r] - y) <= reach_y) & (t >= 0) & (t < distance[r])
                nearest = ti.select(hit, t, distance[r])
                u = face_y * over_y[r]
                hit = (ti.abs(face_y * slope_y[r] - x) <= reach_x) & (u >= 0) & (u < nearest)
                distance[r] = ti.select(hit, u, nearest)
        seen = self.vector(0.0)
        low, high = target - ti.static(self.config.target / 2), target + ti.static(self.config.target / 2)
        face_x, face_y = facing(low[0], high[0], eye[0]), facing(low[1], high[1], eye[1])
        x, reach_x = extent(low[0], high[0], eye[0])
        y, reach_y = extent(low[1], high[1], eye[1])
        if (low < eye).all() and (eye < high).all():  # only where somebody put it there
            reach_x, reach_y = -1.0, -1.0
        for r in range(ti.static(self.config.rays)):
            t = face_x * over_x[r]
            hit_x = (ti.abs(face_x * slope_x[r] - y) <= reach_y) & (t >= 0) & (t < distance[r])
            nearest = ti.select(hit_x, t, distance[r])
            u = face_y * over_y[r]
            hit_y = (ti.abs(face_y * slope_y[r] - x) <= reach_x) & (u >= 0) & (u < nearest)
            distance[r] = ti.select(hit_y, u, nearest)
            seen[r] = ti.select(hit_x | hit_y, 1.0, 0.0)
        return distance, seen


@ti.func
def facing(low, high, eye):
    """How far it is, along one axis, to the side of a box that faces the eye."""
    return ti.select(low > eye, low, high) - eye


@ti.func
def extent(low, high, eye):
    """A side's middle as seen from the eye, and how far from it a ray still hits."""
    return 0.5 * (low + high) - eye, 0.5 * (high - low) + ti.static(SEAM)


def _edges(rows: np.ndarray) -> np.ndarray:
    """Rows (x, y, half width, half height) as (west, north, east, south): edges lose nothing in float32."""
    return np.hstack([rows[:, :2] - rows[:, 2:], rows[:, :2] + rows[:, 2:]])


def _padded(rows: list[np.ndarray]) -> ti.MatrixField:
    """Lists of (n, 4) rows as one field (H, max n) of 4-vectors, float32; NaN beyond a list's end."""
    padded = np.full((len(rows), max(1, *(len(r) for r in rows)) if rows else 1, 4), np.nan, np.float32)
    for table, part in zip(padded, rows, strict=True):
        table[: len(part)] = part
    field = ti.Vector.field(4, ti.f32, shape=padded.shape[:2])
    field.from_numpy(padded)
    return field
