"""A step of all maps: move, see, remember, choose a goal, advise, describe."""

from functools import cache
from typing import Any, NamedTuple

from agent.planner.advice import Advice
from agent.planner.belief import Belief
from agent.planner.cells import TILE, Bytes, Cells, Floats, Grid, Longs, Wholes
from agent.planner.counts import (
    AGE,
    ALIGNED,
    COUNTS,
    FOUND,
    GOAL,
    HEADING,
    HERE,
    KIND,
    KNOWN,
    LAST_NEW,
    LOOK,
    NEW,
    NONE,
    PROGRESS,
    QUEUED,
    SEARCH,
    SEEN,
    SINCE,
    STALE,
    STRAIGHT,
    TARGET,
    THINK,
    TIME,
    WAY,
    X,
    Y,
)
from agent.planner.features import describe
from agent.planner.flood import Words
from agent.planner.sight import Sight
from agent.planner.sweep import Sweep
from agent.planner.views import THOUGHT, Views
from agent.planner.ways import DETOUR, FAR, Ways
from sim.runtime import ti

TOUCH = 0.1
"""Cells that the body goes further than to where it touches the target."""

PATIENCE = 8
"""Steps between two searches for no other reason than that more is known to be occupied."""

FIRM = 32
"""Half cells to a target for each node that it may turn out to lie aside before its way is searched anew."""

ABOUT, ABOUT_TOUCHING = 2.5, 1.5
"""Cells from a goal at which a way may end that could not be had, or not any more, to the goal itself: not
beyond a wall, and where bodies touch a wall it is as thin as a line.
"""

TOUCHED = 5.0
"""Cells from a target, along both axes, at which it was picked up if it is gone."""


class Body(NamedTuple):
    """What a map must know of the body and its rays."""

    rays: int
    channels: int
    distance: int  # the channel that has it
    step: int  # half cells
    touching: bool  # whether it fills a cell of the house
    target: float  # half its side, cells
    reach: float  # of rays, parts of a cell
    bits: int


@cache
def step_kernel(program: Any, body: Body) -> Any:
    """The kernel for a running Taichi. Arguments are named for the map's arrays."""
    grid = Grid(body.bits, body.step, body.touching)
    ways = Ways(grid)
    views = Views(grid)
    sight = Sight(body.target)
    belief = Belief(grid)
    sweep = Sweep(grid, body.rays, body.reach)
    adviser = Advice(grid, ways)
    rays, channels, distance_at, step_by = body[:4]
    half, reach_by = body.target, body.reach
    hinders = step_by // 2 if grid.touching else step_by
    about = ABOUT_TOUCHING if grid.touching else ABOUT

    @ti.func
    def diagonal(observation: ti.template(), directions: ti.template(), o):
        """Whether the heading lies at 45 degrees to the walls, -1 where no wall tells. Where two neighbouring
        rays end on one wall, the line through both ends runs along an axis in one of the two cases: the pairs
        vote.
        """
        votes = ti.Vector([0, 0])
        for r in range(rays - 1):
            one, other = (
                observation[o + r * channels + distance_at],
                observation[o + (r + 1) * channels + distance_at],
            )
            if (one < 1.0) & (other < 1.0):
                for h in ti.static(range(2)):
                    for axis in ti.static(range(2)):
                        j = 2 * (h * rays + r) + axis
                        votes[h] += ti.cast(
                            ti.abs(one * directions[j] - other * directions[j + 2]) < 1e-3, ti.i32
                        )
        return ti.select(votes[0] == votes[1], -1, ti.cast(votes[1] > votes[0], ti.i32))

    @ti.kernel
    def step(
        observation: Floats,
        blocked: Bytes,
        begun: Bytes,
        action: Longs,
        directions: Floats,
        clear: Floats,
        starts: Wholes,
        skips: Wholes,
        fan: Wholes,
        cells: Cells,
        field: Cells,
        queue: Cells,
        news: Bytes,
        swept: Wholes,
        tiles: Words,
        guesses: Bytes,
        hidden: Bytes,
        shown: Cells,
        looks: Wholes,
        counts: Wholes,
        target: Floats,
        advice: Longs,
        features: Floats,
    ):
        ti.loop_config(block_dim=8)
        for e in range(blocked.shape[0]):
            base, w, o = e * grid.area, e * COUNTS, e * rays * channels
            # move
            fresh, slant = ti.cast(begun[e], ti.i32), -1
            if fresh == 0:
                if action[e] < 2:
                    counts[w + HEADING] = (counts[w + HEADING] + ti.select(action[e] == 0, 1, 7)) & 7
                    counts[w + STRAIGHT] = -1
                elif blocked[e] == 0:
                    way = ways.ahead(counts[w + HEADING])
                    if counts[w + STRAIGHT] >= 0:
                        counts[w + STRAIGHT] += step_by
                    counts[w + X] += step_by * way[0]
                    counts[w + Y] += step_by * way[1]
            if (fresh == 1) | (counts[w + ALIGNED] == 0):
                slant = diagonal(observation, directions, o)
                if (slant >= 0) & (slant != counts[w + HEADING] & 1):
                    # All that was seen, before the first wall, was taken for what lies 45 degrees aside.
                    fresh = 1
            if fresh:
                ways.forget(field, queue, base, counts[w + QUEUED])
                for k in range(grid.area):
                    cells[base + k] = ti.cast(0, ti.u16)
                for k in range(COUNTS):
                    counts[w + k] = 0
                for k in range(ti.static(grid.area >> 2 * TILE)):
                    news[(base >> 2 * TILE) + k] = ti.cast(1, ti.u8)
                views.retry(hidden, shown, e)
                counts[w + SINCE], counts[w + STRAIGHT] = 1, -1
                counts[w + HEADING] = ti.max(slant, 0)
            if slant >= 0:
                counts[w + ALIGNED] = 1
            counts[w + TIME] += 1
            time, px, py, heading = counts[w + TIME], counts[w + X], counts[w + Y], counts[w + HEADING]
            x, y = 0.5 * ti.cast(px, ti.f32), 0.5 * ti.cast(py, ti.f32)

            # see
            new, hits, spotted, missed, forward = grid.see_body(cells, news, base, px, py, time), 0, 0, 0, 1
            low, high, side = ti.Vector([1e9, 1e9]), ti.Vector([-1e9, -1e9]), ti.Vector([0.0, 0.0])
            known, off = counts[w + KNOWN], ti.Vector([target[2 * e] - x, target[2 * e + 1] - y])
            straight, eye = counts[w + STRAIGHT], ti.Vector([x, y])
            due = sweep.due(time, counts[w + NEW], known, straight)
            before, last_kind, last_far, last_swept = ti.Vector([0.0, 0.0]), -1, 0, 0
            corner, pose = grid.at(px >> 1, py >> 1), (heading * 4) | (px & 1) | ((py & 1) << 1)
            for r in range(rays):
                d, j = observation[o + r * channels + distance_at], 2 * (heading * rays + r)
                reach = ti.Vector([directions[j], directions[j + 1]])
                kind = ti.cast(d < 1.0, ti.i32)
                if observation[o + r * channels + channels - 1] > 0:
                    kind = 2
                end = d * reach
                if (kind != 2) & (d < clear[(heading & 1) * rays + r]):
                    forward = 0
                if due:
                    far = ti.cast(d * reach_by, ti.i32)
                    unseen, swept_before = sweep.floor(
                        cells, news, starts, skips, fan, swept, e, corner, pose, r, far, last_far, last_swept,
                        straight, time,
                    )  # fmt: skip
                    new += unseen
                    if kind == 1:
                        hits += sweep.wall(cells, news, base, eye, end, before, last_kind == 1, time)
                    before, last_kind, last_far, last_swept = end, kind, far, swept_before
                if kind == 2:
                    spotted += 1
                    side += reach / reach.norm()
                    low, high = ti.min(low, end), ti.max(high, end)
                elif known:
                    along, aside = off.dot(reach) / reach.norm(), ti.abs(off.cross(reach)) / reach.norm()
                    missed |= ti.cast((along > 0) & (aside < 0.5) & (d * reach.norm() > along + 1.0), ti.i32)

            if due:
                counts[w + STRAIGHT] = 0

            # remember
            picked = 0
            if spotted > 0:
                there = sight.centre(spotted, low, high, side, known, off)
                picked = known & sight.other(there, off)
                target[2 * e], target[2 * e + 1] = x + there[0], y + there[1]
                known = 1
            elif known & sight.gone(off, missed):
                known = 0
                picked = ti.cast(ti.abs(off).max() < TOUCHED, ti.i32)
            if picked:
                counts[w + SINCE], counts[w + STRAIGHT] = time, -1
                counts[w + FOUND] += 1
                views.retry(hidden, shown, e)
                spot = ti.cast(ti.floor(ti.Vector([x, y]) + off + 0.5), ti.i32)
                counts[w + HERE] += belief.within(belief.home(cells, base), spot[0], spot[1])
            counts[w + KNOWN], counts[w + NEW] = known, new
            counts[w + SEEN] += new
            if new > 0:
                counts[w + LAST_NEW] = time
            if blocked[e] != 0:
                forward = 0
            if (px | py) & 1 == 0:
                # It may stand nearer to a wall than the map would have let it go.
                grid.clear(cells, news, base, px >> 1, py >> 1)
            way = ways.ahead(heading)
            noted = due | ti.cast(blocked[e], ti.i32)
            if (forward == 0) & noted & grid.passes(cells, base, px, py, way[0], way[1], step_by):
                # It cannot go where the map says it can: what hinders it lies between two rays.
                qx, qy = px + hinders * way[0], py + hinders * way[1]
                grid.close(cells, news, base, (qx + (way[0] > 0)) >> 1, (qy + (way[1] > 0)) >> 1)
                hits += 1

            # choose
            far = ways.far(field, base, px, py)
            counts[w + PROGRESS] = 0
            if (fresh == 0) & (far < FAR) & (counts[w + WAY] < FAR):
                counts[w + PROGRESS] = counts[w + WAY] - far
            kind, goal, since = counts[w + KIND], counts[w + GOAL], counts[w + SINCE]
            stale, age, tail, anew = counts[w + STALE] + hits, counts[w + AGE] + 1, counts[w + QUEUED], 0
            within, look = 0, counts[w + LOOK]
            again = ti.cast(((stale > 0) & (age > PATIENCE)) | (far == FAR), ti.i32)
            counts[w + THINK] += 1
            if known:
                there = grid.at(
                    ti.cast(ti.floor(target[2 * e] + 0.5), ti.i32),
                    ti.cast(ti.floor(target[2 * e + 1] + 0.5), ti.i32),
                )
                moved = ti.max(
                    ti.abs(grid.apart(grid.across(goal), grid.across(there))),
                    ti.abs(grid.apart(grid.down(goal), grid.down(there))),
                )
                # From far away, a node more or less on this side or on that makes no other way.
                anew = again | ti.cast((kind != TARGET) | (FIRM * moved > far), ti.i32)
                kind, goal = TARGET, ti.select(anew, there, goal)
                # Mostly it is in sight: no way is tried first that is a quarter longer than the straight one.
                away = ti.max(ti.abs(target[2 * e] - x), ti.abs(target[2 * e + 1] - y))
                within = ti.cast(1.25 * away, ti.i32) + DETOUR
            elif kind == SEARCH:
                gx, gy = grid.across(goal), grid.down(goal)
                done = ti.cast((look == heading) & (far == 0), ti.i32)
                if look < 0:
                    done = 1 - grid.hides(cells, base, gx, gy, since)
                done |= ti.cast(counts[w + THINK] > THOUGHT, ti.i32)
                if done | grid.solid(cells, base, gx, gy):
                    kind = NONE
            else:
                kind = NONE
            if again:
                anew = 1
                if (kind == SEARCH) & (far == FAR):
                    kind = NONE
            while kind == NONE:
                ways.forget(field, queue, base, tail)
                tail = 0
                goal, look, within = views.choose(
                    cells, queue, news, tiles, guesses, hidden, shown, looks, counts, e
                )
                counts[w + LOOK], counts[w + THINK] = look, 0
                anew = 1
                if goal >= 0:
                    kind = SEARCH
                elif since >= time:
                    break
                else:
                    # All is seen: look again where it has not looked for longest.
                    since += ti.max(1, (time - since) // 2)
                    counts[w + SINCE], counts[w + STRAIGHT] = since, -1
                    views.retry(hidden, shown, e)
            if (anew > 0) & (kind != NONE):
                ways.forget(field, queue, base, tail)
                tail, off, radius = 0, ti.Vector([0.0, 0.0]), 0.5
                if kind == TARGET:
                    # As near as the body must come to touch it.
                    off, radius = ti.Vector([target[2 * e], target[2 * e + 1]]), 1.0 + half - TOUCH
                    off -= ti.floor(off + 0.5)
                if within > 0:
                    tail = ways.measure(cells, field, queue, base, goal, off, radius, within, px, py)
                if ways.far(field, base, px, py) == FAR:
                    # A view was chosen when less was known to be in its way: now a place near it will do.
                    ways.forget(field, queue, base, tail)
                    tail = ways.measure(cells, field, queue, base, goal, off, about, FAR, px, py)
                stale, age = 0, 0
            far = ways.far(field, base, px, py)
            counts[w + KIND], counts[w + GOAL], counts[w + QUEUED], counts[w + AGE] = kind, goal, tail, age
            counts[w + STALE], counts[w + WAY] = stale, far

            # advise
            free, gains = adviser.steps(cells, field, base, px, py, heading, forward)
            turn = adviser.turn(cells, field, base, px, py, heading, gains)
            if (kind == SEARCH) & (look >= 0) & (far == 0):
                turn = (look - heading) & 7
            act = adviser.action(turn)
            advice[e] = act

            # describe
            gx, gy = grid.across(goal), grid.down(goal)
            bearing = ti.Vector(
                [ti.cast(grid.apart(gx, px >> 1), ti.f32), ti.cast(grid.apart(gy, py >> 1), ti.f32)]
            )
            if known:
                bearing = ti.Vector([target[2 * e] - x, target[2 * e + 1] - y])
            ahead = 2 * (heading * rays + rays // 2)
            nose = ti.Vector([directions[ahead], directions[ahead + 1]])
            describe(features, counts, e, forward, free, gains, turn, act, bearing, nose)

    return step
