"""Plans with walls at any angle, as houses to simulate: HouseExpo's JSON, and GeoJSON.

Such a house is a map (``House.occupancy``) with one room and no furniture. Its cells mark the outside.
``House.free_walls`` are the exact walls, which stop rays and robots before the cells do.
"""

import json
import warnings
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise
from math import ceil
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import shapely
from shapely import LineString, Point
from shapely.errors import GEOSException

from vitruvius.logic.errors import HouseFileError, PlanWarning, RequestError
from vitruvius.logic.house.house import House
from vitruvius.logic.house.occupancy import FREE, MOST_CELLS, UNKNOWN, OccupancyGrid, too_many
from vitruvius.logic.house.parts import MOST_WALLS, OUTSIDE, FreeWall
from vitruvius.logic.opener import reason
from vitruvius.logic.readers.features import features, from_text, inner_wall, is_geojson
from vitruvius.logic.readers.houseexpo import is_houseexpo, outline, without_bevels
from vitruvius.logic.readers.length_units import degrees_of, is_web_mercator, plane
from vitruvius.logic.readers.sketch import MAX_COORDINATE, MAX_CORNERS, polygons, require_plain
from vitruvius.logic.spelling import numbered

MOST_BYTES = 1 << 24
"""Largest size of a file, in bytes."""

CELL_M = 0.1
"""Side of a cell, metres. A robot must not fit between a wall and the cells behind it."""

BLOCK_CELLS, BLOCK_PARTS, MAX_BLOCKS, MAX_CROSSED = 64, 4, 1 << 21, 1 << 20
"""Cells along a side of a block; parts into which a side is split; number of blocks that are tested; number
of columns and rows that all sides cross.
"""

TOO_LONG = f"its outlines cross more than a million cells of {CELL_M:g} m: keep less of it"

SAME_LINE_M = 1e-3
"""Distance within which lines are one, metres, as files are precise to a millimetre."""

MIN_PLAN_M, MAX_WALL_M, MAX_PLAN_DEG = 1.0, 10.0, 0.02
"""Limits of a plausible plan: least size and greatest thickness of walls, metres; greatest size, degrees."""


def read_world(content: bytes, path: Path) -> House | None:
    """Return the house in a file of HouseExpo or GeoJSON, its middle at (0, 0); None for another file.

    GeoJSON is in metres, with y growing north. Polygons are floor with walls around it. Lines are walls with
    their ``thickness``. By the property ``kind`` polygons are solid (``wall``, ``piece``), and lines and
    polygons are doors. A door is open if it joins two polygons of floor. Windows are shut. Points and
    features without a geometry are ignored.

    Warns (``PlanWarning``) of shut doors, except those of our own files to the outside. Raises
    ``HouseFileError`` if there is no floor or another unit, and for more cells or walls than a house may
    have.
    """
    try:
        record = from_text(content)
    except ValueError:
        return None
    try:
        if is_houseexpo(content, record):
            return _house([without_bevels(outline(record))], [], [])
        return _of_geojson(record) if is_geojson(record) else None
    except (RequestError, ValueError, GEOSException) as error:
        raise HouseFileError(f"{path}: {str(error).removeprefix('plan: ')}") from None


def _of_geojson(record: Mapping[str, Any]) -> House:
    """Return the house of all features of a collection."""
    floor, doors, solids, walls = list[Any](), list[Any](), list[Any](), list[FreeWall]()
    entrances = list[Any]()
    # Doors of our own files with thick walls are lines in the middle of these.
    thick = record.get("wall_thickness")
    deep = inner_wall(thick) / 2 if thick else 0.0
    if len(all_features := features(record)) > MAX_CORNERS:
        raise ValueError(f"it has {len(all_features):,} features: at most {MAX_CORNERS:,} are read")
    shapes = [_shape(feature, f"features[{number}]") for number, feature in enumerate(all_features)]
    # Lines are walls as they are, unless they are doors.
    require_plain(
        [each for each, said in shapes if shapely.get_dimensions(each) > 1 or said.get("kind") == "door"]
    )
    shapes = [(_southward(shape), properties) for shape, properties in shapes]
    if is_web_mercator(record):
        shapes = [(degrees_of(shape), properties) for shape, properties in shapes]
    for number, (shape, properties) in enumerate(_in_metres(shapes)):
        kind, dimensions = properties.get("kind"), shapely.get_dimensions(shape)
        if kind in ("window", "area") or dimensions < 1:
            continue
        if kind == "door":
            between = properties.get("between")
            leads_out = isinstance(between, list) and OUTSIDE in between
            (entrances if leads_out else doors).append(
                shape.buffer(deep, cap_style="flat") if deep and dimensions == 1 else shape
            )
        elif dimensions == 1:
            width = properties.get("thickness", 0.0)
            if type(width) not in (int, float) or not 0 <= width < MAX_WALL_M:
                raise ValueError(
                    f"features[{number}]: thickness is metres, 0 to {MAX_WALL_M:g}, not {str(width)[:40]}"
                )
            walls += _walls(shape, float(width))
        else:
            (solids if kind in ("wall", "piece") else floor).append(shape)
    return _house(floor, solids, walls, doors, entrances)


def _in_metres(shapes: list[tuple[Any, Mapping[str, Any]]]) -> list[tuple[Any, Mapping[str, Any]]]:
    """Return shapes, with their properties, in metres: those that are in degrees are projected."""
    west, north, east, south = shapely.total_bounds([shape for shape, _ in shapes]).tolist()
    if not (max(east - west, south - north) < MAX_PLAN_DEG and abs(west) <= 180 and abs(north) < 89):
        return shapes
    project = plane([shapely.box(west, north, east, south)])
    said = f"plan: degrees of longitude and latitude, made metres around {west:.5f}, {-south:.5f}"
    warnings.warn(said, PlanWarning, stacklevel=6)
    return [(shapely.transform(shape, project), properties) for shape, properties in shapes]


def _shape(feature: Any, where: str) -> tuple[Any, Mapping[str, Any]]:
    """Return a feature's geometry and its properties."""
    geometry = feature.get("geometry", {}) if isinstance(feature, Mapping) else {}
    if geometry is None:  # RFC 7946 uses null for a feature without a place
        return Point(), {}
    if not isinstance(geometry, Mapping) or not geometry:
        raise ValueError(f"{where}: has no geometry")
    try:
        shape = shapely.force_2d(shapely.from_geojson(json.dumps(geometry)))
    except (GEOSException, ValueError) as error:
        raise ValueError(f"{where}: {reason(error)[:80]}") from None
    properties = feature.get("properties")
    if not (np.abs(shapely.get_coordinates(shape)) < MAX_COORDINATE).all():
        raise ValueError(f"{where}: numbers are too large")
    return shape, properties if isinstance(properties, Mapping) else {}


def _southward(shape: Any) -> Any:
    """Return the geometry with y growing south, made valid."""
    valid = shapely.make_valid(shape, method="structure", keep_collapsed=False)
    return shapely.transform(valid, lambda corners: corners * (1, -1))


def _house(
    shapes: Sequence[Any],
    solids: Sequence[Any],
    more: Sequence[FreeWall],
    doors: Sequence[Any] = (),
    entrances: Sequence[Any] = (),
) -> House:
    """Return a house of floor without solids, with walls around its parts, and ``more`` walls.

    The walls are open at doors. Warns (``PlanWarning``) of doors that stay shut. Entrances stay shut if no
    floor is outside.
    """
    require_plain([*shapes, *solids, *doors, *entrances])
    solid = shapely.union_all([part for each in solids for part in polygons(each)])
    floor = [part for shape in shapes for each in polygons(shape) for part in polygons(each - solid)]
    if not floor:
        raise ValueError("it has no polygon of floor")
    all_doors = [*doors, *entrances]
    beside = shapely.STRtree(floor).query(np.array(all_doors, object), "dwithin", SAME_LINE_M)[0]
    opened = [all_doors[k] for k in np.flatnonzero(np.bincount(beside) > 1)]
    ways = shapely.union_all([door.buffer(SAME_LINE_M) for door in opened])
    jambs = [polygon.boundary for door in opened if door.area for polygon in polygons(door)]
    all_floor = shapely.union_all(floor)
    _warn_of_shut({*doors} - {*opened}, all_floor)
    lines = [shapely.union_all([each.boundary for each in floor]) - ways]
    if jambs:
        lines.append(shapely.union_all(jambs) - all_floor.buffer(SAME_LINE_M))
    inside = all_floor | ways
    west, north, east, south = inside.bounds
    x, y = (west + east) / 2, (north + south) / 2
    outlines = shapely.line_merge(shapely.union_all(lines)).simplify(SAME_LINE_M / 10)
    placed = (
        FreeWall(wall.x1 - x, wall.y1 - y, wall.x2 - x, wall.y2 - y, wall.thickness)
        for wall in (*_walls(outlines, 0.0), *more)
    )
    # A point may be repeated, and two points far from the origin may be one here.
    walls = tuple(wall for wall in placed if (wall.x1, wall.y1) != (wall.x2, wall.y2))
    if len(walls) > MOST_WALLS:
        raise ValueError(f"it has {len(walls):,} walls: at most {MOST_WALLS:,} are read")
    return msgspec.structs.replace(House.of_map(_outside(inside, x, y)), free_walls=walls)


def _warn_of_shut(doors: Collection[Any], floor: Any) -> None:
    """Warn of the number of doors that are in no open gap.

    A door in the midst of floor has no wall to open.
    """
    inner = floor.buffer(-SAME_LINE_M) if doors else floor
    if shut := sum(not inner.covers(door.centroid) for door in doors):
        join, are = ("joins", "is") if shut == 1 else ("join", "are")
        said = f"plan: {numbered(shut, 'door')} {join} no two polygons of floor, and {are} shut"
        warnings.warn(said, PlanWarning, stacklevel=7)  # where ``vitruvius.load`` is called


def _walls(shape: Any, thickness: float) -> list[FreeWall]:
    """Return a wall along each segment of lines."""
    lines = [line for line in shapely.get_parts(shape) if isinstance(line, LineString)]
    ends = (pair for line in lines for pair in pairwise(line.coords))
    return [FreeWall(x1, y1, x2, y2, thickness) for (x1, y1), (x2, y2) in ends]


def _outside(inside: Any, x: float, y: float) -> OccupancyGrid:
    """Return the map, its middle at (0, 0), whose free cells contain floor."""
    west, north, east, south = inside.bounds
    if max(east - west, south - north) < MIN_PLAN_M:
        raise ValueError(
            f"it is {east - west:.2g} by {south - north:.2g} m: write it in metres, or in degrees"
        )
    columns, rows = ceil((east - west) / CELL_M), ceil((south - north) / CELL_M)
    if columns * rows > MOST_CELLS:
        raise ValueError(f"in cells of {CELL_M:g} m {too_many(rows, columns)}")
    corner = -columns * CELL_M / 2, -rows * CELL_M / 2
    left, top = x + corner[0] + CELL_M * np.arange(columns), y + corner[1] + CELL_M * np.arange(rows)
    return OccupancyGrid.of(np.where(_free(inside, left, top), FREE, UNKNOWN), CELL_M, corner)


def _free(inside: Any, left: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Return the cells (H, W) bool that contain floor; ``left`` and ``top`` are the edges of cells.

    Large blocks of cells are tested first; blocks that an outline crosses are split into smaller ones.
    """
    corners, ring = shapely.get_coordinates(shapely.get_parts(shapely.boundary(inside)), return_index=True)
    sides = np.stack([corners[:-1], corners[1:]], 1)[ring[:-1] == ring[1:]]
    is_inside = _middles_inside(sides, left, top)
    lines: Any = shapely.linestrings(sides)
    tree = shapely.STRtree(lines)
    free = np.zeros((len(top), len(left)), bool)
    starts = np.mgrid[: len(top) : BLOCK_CELLS, : len(left) : BLOCK_CELLS]
    waiting = [(BLOCK_CELLS, *(each.ravel() for each in starts))]
    asked = 0
    while waiting:
        size, row, column = waiting.pop()
        if len(row) > BLOCK_CELLS**2:
            waiting.append((size, row[BLOCK_CELLS**2 :], column[BLOCK_CELLS**2 :]))
            row, column = row[: BLOCK_CELLS**2], column[: BLOCK_CELLS**2]
        if (asked := asked + len(row)) > MAX_BLOCKS:
            raise ValueError(TOO_LONG)
        south, east = np.minimum(row + size, len(top)), np.minimum(column + size, len(left))
        boxes = shapely.box(left[column], top[row], left[east - 1] + CELL_M, top[south - 1] + CELL_M)
        is_crossed = np.zeros(len(boxes), bool)
        is_crossed[tree.query(boxes, "intersects")[0]] = True
        is_free = np.where(is_crossed, size == 1, is_inside[row, column])
        for block in zip(row[is_free], south[is_free], column[is_free], east[is_free], strict=True):
            free[block[0] : block[1], block[2] : block[3]] = True
        if size > 1:
            inner = np.arange(0, size, size // BLOCK_PARTS)
            rows = (row[is_crossed][:, None, None] + inner[:, None] + 0 * inner).ravel()
            columns = (column[is_crossed][:, None, None] + 0 * inner[:, None] + inner).ravel()
            there = (rows < len(top)) & (columns < len(left))
            waiting.append((size // BLOCK_PARTS, rows[there], columns[there]))
    return free


def _middles_inside(sides: np.ndarray, left: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Return if the middle of each cell (H, W) bool is inside outlines with these sides (S, 2, 2), metres.

    Sides cross the row of such a cell to the west an odd number of times. A middle within rounding of a side
    may be on either side of it.
    """
    start, end = sides[:, 0], sides[:, 1]
    if np.abs(end - start).sum() > MAX_CROSSED * CELL_M:
        raise ValueError(TOO_LONG)
    (x, y), (to_x, to_y) = start.T, end.T
    first, last = (
        np.clip(np.ceil((each - top[0]) / CELL_M - 0.5), 0, len(top)).astype(int)
        for each in (np.minimum(y, to_y), np.maximum(y, to_y))
    )
    rows = last - first
    side = np.repeat(np.arange(len(y)), rows)
    row = np.arange(len(side)) - np.repeat(np.cumsum(rows) - rows, rows) + first[side]
    share = (top[0] + CELL_M * (row + 0.5) - y[side]) / (to_y - y)[side]
    column = np.ceil((x[side] + share * (to_x - x)[side] - left[0]) / CELL_M - 0.5).astype(int)
    crossings = np.zeros((len(top), len(left) + 1), np.uint8)
    np.add.at(crossings, (row, np.clip(column, 0, len(left))), 1)
    return (np.cumsum(crossings, 1, np.uint8)[:, :-1] & 1).astype(bool)
