"""Windows of planners' maps about the body, for the network, and the memory of goals taken and finds.

A place is every fourth node along both axes, counted from the episode's start unless a trainer sets another
origin. A block is two by two cells, so a place has four blocks about it. Window place (0, 0) lies ``PLACES /
2`` places north and west of the body's place; place (i, j) is i south and j east of it. The place in the
middle stands for the body's own node.
"""

from functools import cache
from typing import Any

import numpy as np
import torch

from vitruvius.agent.algorithms.search.looks import UNREACHED, ViewLooks
from vitruvius.agent.algorithms.search.windows import HEADINGS, LEVELS, PLACES, ViewMaps
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.core.arrays import PlannerArrays
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import loaded, store
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED
from vitruvius.agent.planner.step import Step
from vitruvius.agent.planner.viewpoints.reachability import OPEN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Bytes, Ints, Launch, Shorts, kernel, start, ti

BLOCKS = 2 * PLACES


class MapReader:
    """Reader of the maps of E planners that are led.

    It also keeps finds and goals taken, which they do not.
    """

    def __init__(self, world: Config, planner: Planner) -> None:
        self.world, self.planner, count = world, planner, len(planner.advice)
        self.pitch = planner.config.viewpoint_pitch
        self.side = (1 << planner.config.map_bits) // self.pitch
        self.phase = np.zeros((count, 2), int)
        """Nodes south and east of the start at which places begin, less than a pitch."""
        self.found, self.since = np.zeros((2, count), np.int32)
        self.finds = np.zeros((count, self.side, self.side), np.uint8)
        self.taken = np.zeros((count, self.side, self.side), np.uint8)
        own = {
            "asked": Array(ti.i32, count),
            "corners": Array(ti.i32, 2 * count),
            "blocks": Array(ti.u8, count * BLOCKS**2),
            "ages": Array(ti.u8, count * BLOCKS**2),
            "ways": Array(ti.u16, count * PLACES**2),
            "here": Array(ti.i32, count),
        }
        self.arrays = planner.arrays | own
        self._read = Launch(_kernel(start(), planner.config, planner.body), self.arrays)
        self.looks = ViewLooks(self.arrays, planner.config, planner.body, count)

    def note(self) -> None:
        """Note pick-ups after a step; forget the finds of episodes that ended."""
        time, found, y, x = (self.planner.read(name).numpy() for name in ("time", "found", "y", "x"))
        begun = time == 1
        self.finds[begun], self.found[begun] = 0, 0
        picked = np.flatnonzero(found > self.found)
        at = picked, self._place(y, 0)[picked], self._place(x, 1)[picked]
        self.finds[at] = np.minimum(self.finds[at], 254) + 1
        self.found[:] = found
        self._forget(begun)

    def read(self, environments: np.ndarray) -> ViewMaps:
        """Return the windows of planners without a goal, in these environments (n,) int.

        A planner that has seen everything within reach since the last pick-up will look again, first at the
        places that it has not seen for longest.
        """
        count, view = len(environments), {name: self.arrays[name].view() for name in OWN_ARRAYS}
        corners = self.corners(environments)
        view["asked"][:], view["corners"][: 2 * count] = -1, corners.ravel()
        view["asked"][:count] = environments
        self._read()
        self._forget(np.zeros(len(self.found), bool))
        rows = (corners - self.phase[environments]) // self.pitch
        axis = np.arange(PLACES)
        south, east = ((rows[:, k, None] + axis) % self.side for k in range(2))
        there = environments[:, None, None], south[:, :, None], east[:, None]
        time, since, found, heading = (
            self.planner.read(name)[environments] for name in ("time", "since", "found", "heading")
        )
        ago = torch.log2(1.0 + time - since) / 10
        ways = view["ways"][: count * PLACES**2].reshape(count, PLACES, PLACES)
        shape = count, BLOCKS, BLOCKS
        return ViewMaps(
            *(
                torch.from_numpy(view[name][: np.prod(shape)].reshape(shape).copy())
                for name in ("blocks", "ages")
            ),
            torch.from_numpy(ways.astype(np.int16)),  # UNREACHED becomes FAR
            torch.from_numpy(self.finds[there]),
            torch.from_numpy(self.taken[there]),
            torch.from_numpy(-rows).float(),
            torch.stack([time / self.world.steps, ago, (found / 10).clamp(max=2)], 1).float(),
            heading.long(),
            *(torch.zeros(count, 0) for _ in ("worth", "foreseen", "shown")),
        )

    def corners(self, environments: np.ndarray) -> np.ndarray:
        """Return the first nodes (n, 2) int of these environments' windows, south and east of the start."""
        nodes = np.stack([self.planner.read(name).numpy()[environments] >> 1 for name in ("y", "x")], 1)
        phase = self.phase[environments]
        return (nodes - phase) // self.pitch * self.pitch + phase - self.pitch * (PLACES // 2)

    def lead(self, environments: np.ndarray, picks: np.ndarray, ways: np.ndarray) -> None:
        """Send planners to views (n,) int of the windows that were read last.

        A view is the flat index of heading, south and east in (8, G, G), -1 for none. ``ways`` (n, G, G) are
        the nodes to each place.
        """
        going = picks >= 0
        here, corners = self.arrays["here"].view()[: len(picks)][going], self.corners(environments)[going]
        environments, picks, ways = environments[going], picks[going], ways[going]
        look, south, east = np.unravel_index(picks, (HEADINGS, PLACES, PLACES))
        nodes = corners + self.pitch * np.stack([south, east], 1)
        bits, mask = self.planner.config.map_bits, (1 << self.planner.config.map_bits) - 1
        middle = (south == PLACES // 2) & (east == PLACES // 2)
        node = np.where(middle, here, (nodes[:, 0] & mask) << bits | nodes[:, 1] & mask)
        within = ways[np.arange(len(picks)), south, east]
        rows = (nodes - self.phase[environments]) // self.pitch % self.side
        self.taken[environments, rows[:, 0], rows[:, 1]] |= (1 << look).astype(np.uint8)
        self.planner.lead(environments, np.stack([node, look, within], 1))

    @property
    def state(self) -> dict[str, torch.Tensor]:
        """Copies of what the reader keeps."""
        return {name: torch.from_numpy(getattr(self, name).copy()) for name in KEPT}

    @state.setter
    def state(self, state: dict[str, torch.Tensor]) -> None:
        for name in KEPT:
            setattr(self, name, state[name].numpy())

    def _place(self, half_cells: np.ndarray, axis: int) -> np.ndarray:
        """Return the rows or columns of the places where the bodies are, (E,)."""
        return ((half_cells >> 1) - self.phase[:, axis]) // self.pitch % self.side

    def _forget(self, begun: np.ndarray) -> None:
        """Forget the goals taken in episodes that have begun (E,) bool, and before a pick-up."""
        since = self.planner.read("since").numpy()
        self.taken[(since != self.since) | begun] = 0
        self.since[:] = since


OWN_ARRAYS = "asked", "corners", "blocks", "ages", "ways"
KEPT = "phase", "found", "since", "finds", "taken"


@cache
def _kernel(program: Any, config: PlannerConfig, body: BodyModel) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    parts = Step(config, body)
    occupancy, candidates = parts.occupancy, parts.viewpoints.candidates
    field, bits, pitch = candidates.field, config.map_bits, config.viewpoint_pitch
    mask = (1 << bits) - 1

    @ti.func
    def describe(memory: ti.template(), blocks: ti.template(), ages: ti.template(), state, base, n, cy, cx):
        """Write the blocks of a window whose first place is a node.

        A block's number counts its four cells in base ``LEVELS``: those occupied, those ever seen, and those
        seen since the last pick-up. Its age is 0 if it was never seen, or else 1 and 16 for each doubling.
        """
        for k in range(ti.static(BLOCKS * BLOCKS)):
            y, x = cy - 2 + 2 * (k // ti.static(BLOCKS)), cx - 2 + 2 * (k % ti.static(BLOCKS))
            count, latest, age = 0, 0, 0
            for j, i in ti.static(ti.ndrange(2, 2)):
                cell = ti.cast(memory.cells[base + occupancy.at(x + i, y + j)], ti.i32)
                when = (cell & (OCCUPIED - 1)) >> FLAGS
                count += ti.cast(cell >= OCCUPIED, ti.i32) + LEVELS * ti.cast(when > 0, ti.i32)
                count += ti.static(LEVELS**2) * ti.cast((when > 0) & (when >= state.since), ti.i32)
                latest = ti.max(latest, when)
            if latest > 0:
                since = ti.cast(1 + state.time - latest, ti.f32)
                age = 1 + ti.cast(16.0 * ti.log(since) / ti.static(float(np.log(2))), ti.i32)
            at = n * ti.static(BLOCKS * BLOCKS) + k
            blocks[at], ages[at] = ti.cast(count, ti.u8), ti.cast(age, ti.u8)

    @ti.func
    def measure(memory: ti.template(), ways: ti.template(), state, base, n, cy, cx):
        """Write the distances of a window's places from the body.

        Returns a node of the body, and 1 (i32) if a block within reach may hide a target. The front of the
        distance field moves by a block with each level; its lists lie as those of ``Candidates.collect``.
        """
        first, hides = n * ti.static(PLACES * PLACES), 0
        for k in range(ti.static(PLACES * PLACES)):
            ways[first + k] = ti.cast(UNREACHED, ti.u16)
        these, those = base + candidates.front, base + candidates.front + field.number
        field.begin(memory, base)
        tail, here = field.source(memory, base, these, state.x, state.y)
        level = 0
        while tail > 0:
            moved = 0
            for k in range(tail):
                tile = ti.cast(memory.queue[these + k], ti.i32)
                latest = field.settle(memory, base, tile)
                if latest != 0:
                    memory.queue[these + moved] = ti.cast(tile, occupancy.number)
                    moved += 1
                    field.connect(memory, base, tile)
                hides |= reach(memory, ways, state, base, first, tile, latest, level, cy, cx)
            tail = 0
            for k in range(moved):
                tail = field.spread(memory, base, those, ti.cast(memory.queue[these + k], ti.i32), tail)
            these, those = those, these
            level += 1
        ways[first + ti.static(PLACES // 2 * PLACES + PLACES // 2)] = ti.u16(0)
        return here, hides

    @ti.func
    def reach(memory: ti.template(), ways: ti.template(), state, base, first, tile, latest, level, cy, cx):
        """Write the distances of places in the blocks (bits) of a tile that the front has just reached.

        Returns 1 (i32) if one of these blocks may hide a target.
        """
        hides, open_ = 0, memory.tiles[field.at(base, OPEN, tile)]
        while latest != 0:
            # The lowest bit that is set: the ones below it count its place, then it is cleared.
            block = ti.cast(ti.math.popcnt((latest & -latest) - ti.u64(1)), ti.i32)
            latest &= latest - ti.u64(1)
            node = field.node(tile, block)
            if open_ >> ti.cast(block, ti.u64) & ti.u64(1) != 0:
                hides |= ti.cast(candidates.odds(memory, base, tile, block, state.since) > 0, ti.i32)
            # The place in this block, if any; if places begin at odd nodes, it is the block's second node.
            x, y = occupancy.across(node) + (cx & 1), occupancy.down(node) + (cy & 1)
            i, j = (x - cx) & mask, (y - cy) & mask
            inside = i < PLACES * pitch and j < PLACES * pitch
            if (i | j) & ti.static(pitch - 1) == 0 and inside:  # noqa: SIM102 - it computes both
                if occupancy.open(memory, base, occupancy.at(x, y)):
                    away = ti.max(
                        ti.abs(occupancy.apart(x, state.x >> 1)), ti.abs(occupancy.apart(y, state.y >> 1))
                    )
                    # A level is a block, two nodes; the first begins within the body.
                    way = ti.max(2 * level - 1, away)
                    ways[first + (j // pitch) * PLACES + i // pitch] = ti.cast(
                        ti.min(way, UNREACHED >> 1), ti.u16
                    )
        return hides

    @kernel
    def read(
        asked: Ints, corners: Ints, blocks: Bytes, ages: Bytes, ways: Shorts, here: Ints,
        memory: PlannerArrays, states: Ints,
    ):  # fmt: skip
        ti.loop_config(block_dim=1)
        for n in range(asked.shape[0]):
            e = asked[n]
            if e >= 0:
                base, state = e * occupancy.area, loaded(states, e)
                cy, cx = corners[2 * n], corners[2 * n + 1]
                body, hides = measure(memory, ways, state, base, n, cy, cx)
                here[n] = body
                while (hides == 0) & (state.since < state.time):
                    state = parts.goal.look_again(memory, state, base)
                    body, hides = measure(memory, ways, state, base, n, cy, cx)
                describe(memory, blocks, ages, state, base, n, cy, cx)
                store(states, e, state)

    return read
