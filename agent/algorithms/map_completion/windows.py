"""Windows of planners' maps: read for the network, and written back as the planner's ``prior``.

A block is the four cells about every other node. Window block (0, 0) of an environment lies ``WINDOW / 2``
blocks north and west of the body's block; block (i, j) is i south and j east of it.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.agent.algorithms.map_completion.network import WINDOW
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.mapping.occupancy import FLAGS, NEAR, OCCUPIED, TILE
from vitruvius.agent.planner.viewpoints.belief import PATH
from vitruvius.agent.planner.viewpoints.candidates import NOT_COMPUTED
from vitruvius.sim.runtime import Array, Bytes, Ints, Launch, Shorts, start, ti

OCCUPIED_CELLS = 7
"""Bits of a window's block with the number of its four cells that are occupied."""

SEEN = 3
"""Least number of seen cells for a block to count as seen."""

LOOKED = 1 << 6
"""Bit of a window's block, set if at least ``SEEN`` of its cells were seen since the last pick-up."""


def seen(windows: Any) -> Any:
    """Return a mask of the blocks of windows (n, W, W) uint8, array or tensor, that count as seen."""
    return (windows >> 3 & 7) >= SEEN


class Windows:
    """Windows of E environments' maps."""

    def __init__(self, planner: Planner) -> None:
        self.planner, count = planner, len(planner.advice)
        own = {
            "asked": Array(ti.i32, count),
            "corners": Array(ti.i32, 2 * count),
            "windows": Array(ti.u8, count * WINDOW**2),
            "given": Array(ti.u16, count * WINDOW**2),
            "since": Array(ti.i32, count),
        }
        self.arrays = {name: planner.arrays[name] for name in ("cells", "dirty", "gains", "prior")} | own
        kernels = _kernels(start(), planner.config.map_bits, planner.config.viewpoint_pitch)
        self._read, self._write = (Launch(kernel, self.arrays) for kernel in kernels)

    def ask(self, environments: np.ndarray) -> np.ndarray:
        """Select the windows of these environments (n,) int; return their north-west corners (n, 2) int32.

        Corners are in blocks south and east of where the episodes began.
        """
        asked, corners = self.arrays["asked"].view(), self.arrays["corners"].view().reshape(-1, 2)
        asked[:] = -1
        asked[: len(environments)] = environments
        for k, name in enumerate(("y", "x")):
            # The body's place is in half cells; a block is four half cells wide.
            block = (self.planner.read(name).numpy()[environments] + 2) // 4
            corners[: len(environments), k] = block - WINDOW // 2
        return corners[: len(environments)].copy()

    def read(self, environments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the windows (n, W, W) uint8 of these environments, and their corners, see ``ask``.

        A block's value is the number of its occupied cells, plus eight times the number of those seen, plus
        ``LOOKED``.
        """
        corners = self.ask(environments)
        self.arrays["since"].view()[:] = self.planner.read("since").numpy()
        self._read()
        return self.arrays["windows"].view().reshape(-1, WINDOW, WINDOW)[: len(environments)].copy(), corners

    def write(self, environments: np.ndarray, given: np.ndarray) -> None:
        """Write the beliefs about blocks (n, W, W) uint16 into the planners of these environments.

        See ``Foresight.given`` for the values.
        """
        self.ask(environments)
        self.arrays["given"].view()[: given.size] = given.ravel()
        self._write()


@cache
def _kernels(program: Any, bits: int, pitch: int) -> tuple[Any, Any]:
    """Return the kernels for a running Taichi. Their arguments have the names of the planner's arrays."""
    mask, area = (1 << bits) - 1, 1 << 2 * bits

    @ti.func
    def node(corner_y, corner_x, k):
        """Return the node in the middle of a window's k-th block."""
        y, x = 2 * (corner_y + k // WINDOW) & mask, 2 * (corner_x + k % WINDOW) & mask
        return y, x

    @ti.kernel
    def read(cells: Shorts, asked: Ints, corners: Ints, since: Ints, windows: Bytes):
        for n in range(asked.shape[0]):
            e = asked[n]
            if e >= 0:
                for k in range(WINDOW * WINDOW):
                    y, x = node(corners[2 * n], corners[2 * n + 1], k)
                    count, looked = 0, 0
                    for j, i in ti.static(ti.ndrange((-1, 1), (-1, 1))):
                        at = (((y + j) & mask) << bits) | ((x + i) & mask)
                        cell = ti.cast(cells[e * area + at], ti.i32)
                        count += ti.cast(cell >= OCCUPIED, ti.i32)
                        last = (cell & (OCCUPIED - 1)) >> FLAGS
                        count += 8 * ti.cast(last > 0, ti.i32)
                        looked += ti.cast((last > 0) & (last >= since[e]), ti.i32)
                    count += ti.select(looked >= SEEN, LOOKED, 0)
                    windows[n * WINDOW * WINDOW + k] = ti.cast(count, ti.u8)

    @ti.kernel
    def write(
        cells: Shorts, dirty: Bytes, gains: Shorts, prior: Shorts,
        asked: Ints, corners: Ints, given: Shorts,
    ):  # fmt: skip
        for n in range(asked.shape[0]):
            e = asked[n]
            if e >= 0:
                for spot in range(area // pitch**2):  # a view may show any block
                    gains[e * (area // pitch**2) + spot] = ti.cast(NOT_COMPUTED, ti.u16)
                for k in range(WINDOW * WINDOW):
                    y, x = node(corners[2 * n], corners[2 * n + 1], k)
                    value = ti.cast(given[n * WINDOW * WINDOW + k], ti.i32)
                    place = e * (area >> 2) + ((y >> 1 << bits - 1) | (x >> 1))
                    if ti.cast(prior[place], ti.i32) != value:
                        prior[place] = ti.cast(value, ti.u16)
                        tile = ((y >> TILE) << bits - TILE) | (x >> TILE)
                        dirty[(e * area >> 2 * TILE) + tile] = ti.cast(1, ti.u8)
                    if value & PATH:
                        for j, i in ti.static(ti.ndrange((-1, 1), (-1, 1))):
                            there = e * area + ((((y + j) & mask) << bits) | ((x + i) & mask))
                            cells[there] = cells[there] | ti.cast(NEAR, ti.u16)

    return read, write
