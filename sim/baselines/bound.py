# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What no body that drives can do better, in the backend ``free``: a lower bound on the time to targets.

It is no player. It knows house and targets, and takes the least time in which a body could pick up one
target after the other, by two things that hold for every path:

- distance: the shortest path of the disc's middle among solids that are widened by its radius, at the
  greatest speed, and where an episode begins from the speed that it has;
- turn: between two pick-ups, on a way straight from the one place to the other, no step brings more than its
  heading lets it, which changes at the greatest turn rate at most, and did not turn with nothing in reach.

A pick-up is at a place on the edge of where the disc picks a target up, with a heading in a sector: the least
times of all of them follow from those of the target before. Places are samples, so each way counts as shorter
by their ``spacing`` than it is, and solids as thinner by half of it.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from sim.backends.blocks import HEADER
from sim.backends.body import SKIN
from sim.backends.free.contact import gap
from sim.backends.free.layout import FIRST_SOLID, ROW, SOLIDS
from sim.baselines.roadmap import FAR, Roadmap, Roads, graph, point, sees
from sim.config import Config
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from sim.tasks.terms import terms_of
from sim.world.episodes import HOUSE, TIME
from sim.world.world import World

PLACES, SECTORS = 96, 72
"""Samples of the edge around a target, and of headings."""

STATES = PLACES * SECTORS

ANGLES = 1024
"""Steps of half a turn in a table of what turns cost."""

AT_ONCE = 256
"""Environments whose targets are counted at a time: it bounds memory."""

NEVER = 1e9
"""Seconds."""

ROUNDING = 1e-3
"""Seconds: more than sums of float32 can be off by."""


class Stage(NamedTuple):
    """From the pick-ups of one target to those of the next."""

    house: Ints
    middle: Floats
    """(x, y) of the target."""
    place: Floats
    """(x, y) where the one before is picked up, ``PLACES`` for each environment."""
    time: Floats
    """The least seconds until then, by place and sector of headings."""
    least: Floats
    """The same for any heading."""
    room: Floats
    """Metres from each place in which nothing can be touched."""
    new_place: Floats
    new_time: Floats
    new_least: Floats
    """By distance alone."""
    new_room: Floats
    leaving: Floats
    """The least seconds until a body leaves each place by a straight way, by the sector of its bearing."""
    coming: Floats
    """The least seconds until it comes to each new place by one."""
    hidden: Ints
    """Whether something stands between two places that might be the best."""
    at_corner: Floats
    """The least seconds to each corner of the house, and to where paths go on from there."""
    left: Floats
    """Seconds after which nothing counts."""
    lost: Floats
    """Seconds that the way takes longer, as a body has not its greatest speed yet."""
    slack: Floats
    """Metres that a way counts as shorter than from sample to sample."""
    edge: Floats
    """(x, y) of the samples, from the target's middle."""
    turns: Floats
    """Seconds that a turn takes longer than going straight, by its angle."""


class TimeBound:
    """The least time to targets, for the E environments of a ``HouseVectorEnv`` whose bodies drive."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Ask about these environments; the bank must stay as it is.

        Raises ``ValueError`` where bodies do not drive, where they are so small that samples of places are as
        far apart as they are wide, or where a house has too many corners.
        """
        self.world: World = envs.unwrapped.world
        config = self.world.config
        if not config.drives:
            raise ValueError("a bound is of bodies that drive: take the backend free, or an oracle")
        config.drive.require_heading("a bound")
        self.steps, self.step, task = config.steps, config.drive.time_step, self.world.task
        self.last = 1 if task.ends_on_pick_up else terms_of(task).targets
        self.edge, self.spacing = edge_of(config)
        thinner = config.body[0] / 2 - self.spacing / 2 - 2 * SKIN
        if thinner < 4 * SKIN:
            found = f"{config.body[0]:g} m wide, with targets of {config.target:g} m"
            raise ValueError(f"bodies are {found}: a bound needs wider ones, as it looks at {PLACES} places")
        self.roads = Roadmap(self.world, thinner, cut=True)
        self.kernels = _kernels(start(), config, self.roads.inside, self.spacing)
        self.turns = turns_of(config)

    def first(self) -> np.ndarray:
        """The fewest steps (E,) float64 from each environment's pose to picking its target up, or less than
        that; infinite where no way leads there.
        """
        ever = [next(self._stages(some, np.full(len(some), NEVER))) for some in self._parts()]
        soonest = np.concatenate(ever)
        steps = np.maximum(1, np.ceil(soonest / self.step - 1e-4))
        return np.where(soonest < NEVER, steps, np.inf)

    def most(self) -> np.ndarray:
        """The most targets (E,) int64 that a body can pick up in what is left of each episode, or more."""
        return np.concatenate([self._most(some) for some in self._parts()])

    def _parts(self) -> list[np.ndarray]:
        count = self.world.num_envs
        return [np.arange(first, min(first + AT_ONCE, count)) for first in range(0, count, AT_ONCE)]

    def _most(self, some: np.ndarray) -> np.ndarray:
        steps = self.steps - self.world.state["wholes"][some, TIME]
        left, most = self.step * steps + ROUNDING, np.zeros(len(some), int)
        for number, soonest in enumerate(self._stages(some, left), start=1):
            reached = soonest <= left
            most += reached
            if not reached.any() or number == self.last or number >= steps.max():
                break
        return np.minimum(most, steps)  # a pick-up takes a step

    def _stages(self, some: np.ndarray, left: np.ndarray) -> Iterator[np.ndarray]:
        """The least seconds (n,) to the first target, to the second, and so on, for some environments with so
        many seconds ``left`` (n,).
        """
        state, config, n = self.world.state, self.world.config, len(some)
        pose = self.world.describe()[0][some]
        time = np.full((n, PLACES, SECTORS), NEVER, np.float32)
        sector = np.round(pose[:, 2] * (SECTORS / (2 * np.pi))).astype(int) % SECTORS
        time[np.arange(n), 0, sector] = 0
        straight = self._straight(pose, self.world.targets(1)[some, 0])
        lost = acceleration_loss(state["wholes"][some, 0].view(np.float32), straight, config)
        arrays = {
            "house": Array.of(np.ascontiguousarray(state["wholes"][some, HOUSE])),
            "middle": Array(ti.f32, 2 * n),
            "place": Array.of(np.repeat(pose[:, None, :2], PLACES, axis=1).astype(np.float32).ravel()),
            "time": Array.of(time.ravel()),
            "room": Array(ti.f32, n * PLACES),
            "least": Array(ti.f32, n * PLACES),
            "new_place": Array(ti.f32, 2 * n * PLACES),
            "new_time": Array(ti.f32, n * STATES),
            "new_room": Array(ti.f32, n * PLACES),
            "new_least": Array(ti.f32, n * PLACES),
            "leaving": Array(ti.f32, n * STATES),
            "coming": Array(ti.f32, n * STATES),
            "hidden": Array(ti.i32, n),
            "at_corner": Array(ti.f32, 2 * n * self.roads.most),
            "left": Array.of(left.astype(np.float32)),
            "lost": Array.of(lost.astype(np.float32)),
            "slack": Array.of(np.array([self.spacing / 2], np.float32)),
            "edge": Array.of(self.edge.astype(np.float32).ravel()),
            "turns": Array.of(self.turns.astype(np.float32)),
        }
        launches = [Launch(each, self.roads.arrays | arrays) for each in self.kernels]
        number, middles = 0, self.world.targets(64)[some]
        while True:
            if number == middles.shape[1]:
                middles = self.world.targets(2 * number)[some]
            arrays["middle"].fill(np.ascontiguousarray(middles[:, number], np.float32).ravel())
            for launch in launches:
                launch.bind(self.roads.arrays | arrays)
                launch()
            soonest = arrays["new_time"].numpy().reshape(n, -1).min(axis=1).astype(float)
            if number == 0:
                soonest = np.maximum(soonest, straight / fastest(config) + lost)
            yield soonest
            for name in ("place", "time", "room"):
                arrays[name], arrays[f"new_{name}"] = arrays[f"new_{name}"], arrays[name]
            arrays["lost"].fill(np.zeros(n, np.float32))
            arrays["slack"].fill(np.array([self.spacing], np.float32))
            number += 1

    def _straight(self, pose: np.ndarray, middle: np.ndarray) -> np.ndarray:
        """Metres (n,) straight to where a target is picked up."""
        config = self.world.config
        away = np.maximum(np.abs(pose[:, :2] - middle) - config.target / 2, 0)
        return np.maximum(0, np.hypot(*away.T) - (config.body[0] / 2 - SKIN))


def fastest(config: Config) -> float:
    """Metres a second that a body makes at most. Where it touches something it is put out by a skin more."""
    drive = config.drive
    return (drive.travel + SKIN) / drive.time_step


def acceleration_loss(speed: np.ndarray, way: np.ndarray, config: Config) -> np.ndarray:
    """Seconds (n,) that bodies of some speeds, m/s, lose on a way, metres, until they have their greatest."""
    drive, most = config.drive, max(config.drive.speed, config.drive.reverse)
    speed, gone, lost = np.abs(speed).astype(float), np.zeros(len(speed)), np.zeros(len(speed))
    while (speed < most).any():
        speed = np.minimum(most, speed + drive.acceleration * drive.time_step)
        gone += drive.time_step * speed
        lost += np.where(gone <= way, drive.time_step * (1 - speed / most), 0)
    return lost


def edge_of(config: Config) -> tuple[np.ndarray, float]:
    """Samples (PLACES, 2) of where the middle of a disc is that just picks a target up, from the target's
    middle; and twice the metres by which a place on its way may be off one of them: half of what is between
    two, and what the arc of a step is off its chord.
    """
    half, radius, drive = config.target / 2, config.body[0] / 2, config.drive
    spacing = (8 * half + 2 * np.pi * radius) / PLACES
    along = spacing * (np.arange(PLACES // 4) + 0.5)
    angle = np.maximum(along - 2 * half, 0) / radius
    east = half + radius * np.cos(angle)
    south = np.where(angle > 0, half + radius * np.sin(angle), along - half)
    side = np.column_stack([east, south])
    turned = [side @ np.linalg.matrix_power(np.array([[0, 1], [-1, 0]]), k) for k in range(4)]
    return np.concatenate(turned), spacing + drive.travel * drive.turn_speed * drive.time_step / 4


def turns_of(config: Config) -> np.ndarray:
    """Seconds (ANGLES + 1,) that a turn of some angle takes longer than going straight, at least: as long as
    the heading is an angle off, a step brings no more than its cosine, and none beyond a quarter turn.

    None for a body that can drive backward, or not turn.
    """
    drive, angle = config.drive, np.linspace(0, np.pi, ANGLES + 1)
    if drive.reverse > 0 or drive.turn_speed == 0:
        return np.zeros(ANGLES + 1)
    return (angle - np.sin(np.minimum(angle, np.pi / 2))) / drive.turn_speed


@cache
def _kernels(program: Any, config: Config, wide: float, spacing: float) -> tuple[Any, ...]:
    speed, turn_speed = fastest(config), config.drive.turn_speed
    # From there on a way has room for what is gained in both turns, at its begin and at its end.
    turnable = 2 * speed / turn_speed if turn_speed else FAR
    radius, half, sector = config.body[0] / 2, config.target / 2, 2 * np.pi / SECTORS
    # Heading and bearing are off by half a sector each, and the bearing by what places are.
    off, around = sector + 1.05 * spacing / turnable, 2 * (radius + half * 2**0.5)

    @ti.func
    def clearance(roads: ti.template(), house, place):
        """Metres in which a body there can touch nothing."""
        header, nearest = house * HEADER, ti.f32(FAR)
        at = roads.indices[header + FIRST_SOLID]
        for _ in range(roads.indices[header + SOLIDS]):
            away = gap(ti.Vector([roads.numbers[at + part] for part in range(ROW)]), place)
            nearest, at = ti.min(nearest, away.norm()), at + ROW
        return ti.max(0.0, nearest - ti.static(radius + spacing / 2))

    @ti.func
    def turn(stage: ti.template(), angle, room):
        """Seconds that a turn costs at least of which nothing can be touched for ``room`` metres."""
        free = ti.max(0.0, angle - room * ti.static(turn_speed / speed))
        steps = ti.static(ANGLES / np.pi)
        whole = stage.turns[ti.cast(angle * steps, ti.i32)]
        return ti.max(0.0, whole - stage.turns[ti.min(ANGLES, ti.cast(ti.ceil(free * steps), ti.i32))])

    @ti.func
    def turned(stage: ti.template(), j, b, room):
        """The same, from the heading of a sector to the bearing of another, or back."""
        steps = ti.abs(j - b)
        angle = ti.min(steps, SECTORS - steps) * ti.static(sector) - ti.static(off)
        return turn(stage, ti.max(0.0, angle), room)

    @ti.func
    def sector_of(way):
        """The sector that a way's bearing is in."""
        steps = ti.round(ti.atan2(-way[1], way[0]) * ti.static(1 / sector))
        return (ti.cast(steps, ti.i32) + SECTORS) % SECTORS

    @ti.func
    def inside(place, middle):
        """Whether a body at a place may pick up a target about a middle where it is (i32)."""
        away = ti.max(ti.abs(place - middle) - half, 0.0)
        return ti.cast(away.norm() <= ti.static(radius + spacing), ti.i32)

    @kernel
    def begin(roads: Roads, stage: Stage):
        for k in range(stage.least.shape[0]):
            e, p, soonest = k // ti.static(PLACES), k % ti.static(PLACES), ti.f32(NEVER)
            there = point(stage.middle, e) + point(stage.edge, p)
            stage.new_place[2 * k], stage.new_place[2 * k + 1] = there[0], there[1]
            stage.new_room[k] = clearance(roads, stage.house[e], there)
            stage.room[k] = clearance(roads, stage.house[e], point(stage.place, k))
            for j in range(SECTORS):
                soonest = ti.min(soonest, stage.time[k * ti.static(SECTORS) + j])
            stage.least[k] = ti.select(soonest > stage.left[e], NEVER, soonest)
            if p == 0:
                stage.hidden[e] = 0

    @kernel
    def go_straight(roads: Roads, stage: Stage):
        for k in range(stage.least.shape[0]):
            e, there, soonest, behind = k // ti.static(PLACES), point(stage.new_place, k), ti.f32(NEVER), 0
            for p in range(e * ti.static(PLACES), (e + 1) * ti.static(PLACES)):
                here = point(stage.place, p)
                way = ti.max(0.0, (there - here).norm() - stage.slack[0])
                picked = inside(here, point(stage.middle, e))
                by = stage.least[p] + ti.select(picked, 0.0, way / speed + stage.lost[e])
                if by < soonest:
                    if picked or sees(roads, stage.house[e], here, there, ti.static(wide), True):
                        soonest = by
                    else:
                        behind = 1
            stage.new_least[k] = soonest
            if behind:
                stage.hidden[e] = 1

    @kernel
    def go_by_corners(roads: Roads, stage: Stage):
        for e in range(stage.house.shape[0]):
            if stage.hidden[e]:
                where = stage.house[e]
                first, count, table = graph(roads, where)
                to = e * (stage.at_corner.shape[0] // stage.house.shape[0])
                latest = ti.f32(0.0)
                for k in range(e * ti.static(PLACES), (e + 1) * ti.static(PLACES)):
                    latest = ti.max(latest, stage.new_least[k])
                latest += stage.slack[0] / speed  # ways to new places are shorter by that
                for c in range(count):
                    corner, soonest = point(roads.corners, first + c), ti.f32(NEVER)
                    for p in range(e * ti.static(PLACES), (e + 1) * ti.static(PLACES)):
                        here = point(stage.place, p)
                        by = stage.least[p] + (corner - here).norm() / speed
                        if by < ti.min(soonest, latest):  # noqa: SIM102 - Taichi does both
                            if sees(roads, where, here, corner, ti.static(wide), True):
                                soonest = by
                    stage.at_corner[to + c] = soonest
                for c in range(count):
                    soonest = ti.f32(NEVER)
                    for other in range(count):
                        way = roads.lengths[table + other * count + c]
                        soonest = ti.min(soonest, stage.at_corner[to + other] + way / speed)
                    stage.at_corner[to + count + c] = soonest
                for k in range(e * ti.static(PLACES), (e + 1) * ti.static(PLACES)):
                    there = point(stage.new_place, k)
                    for c in range(count):
                        corner = point(roads.corners, first + c)
                        way = (corner - there).norm() - stage.slack[0]
                        by = stage.at_corner[to + count + c] + way / speed + stage.lost[e]
                        if by < stage.new_least[k]:  # noqa: SIM102 - Taichi does both
                            if sees(roads, where, corner, there, ti.static(wide), True):
                                stage.new_least[k] = by

    @kernel
    def leave(stage: Stage):
        for k in range(stage.least.shape[0]):
            e = k // ti.static(PLACES)
            # Bearings from here to all new places: by how wide what they lie on looks.
            way = point(stage.middle, e) - point(stage.place, k)
            apart, main = way.norm(), sector_of(way)
            spread = ti.cast(SECTORS, ti.i32)
            if apart > ti.static(around):
                spread = 1 + ti.cast(
                    ti.ceil(ti.asin(ti.static(around / 2) / apart) * ti.static(1 / sector)), ti.i32
                )
            for b in range(SECTORS):
                soonest, steps = ti.f32(NEVER), ti.abs(b - main)
                if (stage.least[k] < NEVER) & (ti.min(steps, SECTORS - steps) <= spread):
                    for j in range(SECTORS):
                        before = stage.time[k * ti.static(SECTORS) + j]
                        soonest = ti.min(soonest, before + turned(stage, j, b, stage.room[k]))
                stage.leaving[k * ti.static(SECTORS) + b] = soonest

    @kernel
    def come(stage: Stage):
        for k in range(stage.least.shape[0]):
            e, to, anyhow = k // ti.static(PLACES), k * ti.static(SECTORS), ti.f32(NEVER)
            for b in range(SECTORS):
                stage.coming[to + b] = NEVER
            for p in range(e * ti.static(PLACES), (e + 1) * ti.static(PLACES)):
                if stage.least[p] < NEVER:
                    way = point(stage.new_place, k) - point(stage.place, p)
                    length = ti.max(0.0, way.norm() - stage.slack[0])
                    if inside(point(stage.place, p), point(stage.middle, e)):
                        anyhow = ti.min(anyhow, stage.least[p])
                    elif length < ti.static(turnable):
                        anyhow = ti.min(anyhow, stage.least[p] + length / speed)
                    else:
                        b = sector_of(way)
                        by = stage.leaving[p * ti.static(SECTORS) + b] + length / speed
                        stage.coming[to + b] = ti.min(stage.coming[to + b], by)
            for j in range(SECTORS):
                stage.new_time[to + j] = ti.max(anyhow, stage.new_least[k])
            for b in range(SECTORS):
                if stage.coming[to + b] < ti.min(anyhow, NEVER):
                    for j in range(SECTORS):
                        by = stage.coming[to + b] + turned(stage, j, b, stage.new_room[k])
                        by = ti.max(by, stage.new_least[k])
                        stage.new_time[to + j] = ti.min(stage.new_time[to + j], by)

    return begin, go_straight, go_by_corners, leave, come
