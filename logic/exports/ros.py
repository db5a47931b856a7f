"""Occupancy map for map_server of ROS (wiki.ros.org/map_server) and ROS 2 (nav2_map_server).

The map is a picture of cells and its description. x east, y north; metres.
"""

from io import BytesIO
from pathlib import Path

import numpy as np
import shapely
from PIL import Image

from vitruvius.logic.drawing.frame import drawn_extent, extent
from vitruvius.logic.exports.floor import outline
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.occupancy import UNKNOWN as UNKNOWN_CELL
from vitruvius.logic.house.occupancy import OccupancyGrid
from vitruvius.logic.house.wall_parts import wall_parts

CELL_M = 0.05
"""Side of a cell, metres, in the map of a house that is not a map itself."""

MARGIN_CELLS = 10
"""Number of cells around the house."""

OCCUPIED, FREE, UNKNOWN = 0, 254, 205
"""Grey values of map_server's mode ``trinary``."""

DESCRIPTION = """\
image: {image}
resolution: {resolution}
origin: [{west}, {south}, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
mode: trinary
"""


def write(house: House, path: Path) -> None:
    """Write the map's picture, then its description, ``.yaml``, which names the picture."""
    if grid := house.occupancy:
        cells, corner, cell = _pixels(grid), (grid.x, -grid.box[3]), grid.cell
    else:
        (cells, corner), cell = occupancy(house), CELL_M
    shapes = [outline(wall) for wall in house.free_walls]
    if house.occupancy:
        shapes += [shapely.box(*piece.box) for room in house.rooms for piece in room.pieces]
    for shape in shapes:
        _fill(cells, shape, corner[0], -corner[1] - cell * len(cells), cell)
    # Rounding leaves y in ROS's axes no more digits than metres can have. Numbers have no exponent, since
    # YAML 1.1, which many readers follow, reads 6e-08 as a word.
    west, south, side = (
        np.format_float_positional(each, trim="0") for each in (*np.round(corner, 9).tolist(), float(cell))
    )
    buffer = BytesIO()
    Image.fromarray(cells).save(buffer, "PNG")
    picture = path.with_suffix(".png")
    write_whole(picture, buffer.getvalue())
    text = DESCRIPTION.format(image=picture.name, resolution=side, west=west, south=south)
    write_whole(path.with_suffix(".yaml"), text.encode())


def _pixels(grid: OccupancyGrid) -> np.ndarray:
    """Return the pixels of a map, as ``UNKNOWN``, ``FREE`` and ``OCCUPIED``."""
    return np.where(grid.values == UNKNOWN_CELL, UNKNOWN, np.where(grid.values, OCCUPIED, FREE)).astype(
        np.uint8
    )


def occupancy(house: House) -> tuple[np.ndarray, tuple[float, float]]:
    """Return the cells (H, W) uint8, row 0 in the north, and the corner of the south-west cell, metres.

    A cell that a wall or a piece touches is occupied, a cell within rooms alone is free, and all others are
    unknown.
    """
    west, north, east, south = drawn_extent(house) if house.wall_thickness else extent(house)
    left, up = west - MARGIN_CELLS * CELL_M, north - MARGIN_CELLS * CELL_M
    columns, rows = (
        int(np.ceil(length / CELL_M)) + 2 * MARGIN_CELLS for length in (east - west, south - north)
    )
    cells = np.full((rows, columns), UNKNOWN, np.uint8)

    def fill(box: Box, value: int) -> None:
        (x0, x1), (y0, y1) = _cells(box[0] - left, box[2] - left), _cells(box[1] - up, box[3] - up)
        cells[y0:y1, x0:x1] = value

    for room in house.rooms:
        fill(room.box, FREE)
    for room in house.rooms:
        for piece in room.pieces:
            fill(piece.box, OCCUPIED)
    for kind, box in wall_parts(house) if house.wall_thickness else ():
        fill(box, FREE if kind in ("door", "opening") else OCCUPIED)
    verticals, horizontals = house.walls
    for x, low, high in verticals:
        fill((x, low, x, high), OCCUPIED)
    for y, low, high in horizontals:
        fill((low, y, high, y), OCCUPIED)
    return cells, (left, -(up + rows * CELL_M))


def _fill(
    cells: np.ndarray, shape: shapely.Polygon | shapely.LineString, west: float, north: float, cell: float
) -> None:
    """Mark the cells (H, W) that a shape touches as occupied; cell (0, 0) begins at ``west``, ``north``."""
    left, top, right, bottom = shape.bounds
    (x0, x1), (y0, y1) = (
        np.clip([int((low - edge) // cell), int((high - edge) // cell) + 1], 0, most)
        for low, high, edge, most in ((left, right, west, cells.shape[1]), (top, bottom, north, len(cells)))
    )
    y, x = np.mgrid[y0:y1, x0:x1]
    xs, ys = west + cell * x, north + cell * y  # A shape that touches a cell only at its edge is not in it.
    boxes = shapely.box(xs + TOLERANCE, ys + TOLERANCE, xs + cell - TOLERANCE, ys + cell - TOLERANCE)
    cells[y0:y1, x0:x1][shapely.intersects(boxes, shape)] = OCCUPIED


def _cells(low: float, high: float) -> tuple[int, int]:
    """Return the first cell that a span touches, and the one after the last."""
    first = int(np.floor((low + TOLERANCE) / CELL_M))
    return first, max(first + 1, int(np.ceil((high - TOLERANCE) / CELL_M)))
