"""Maps of ROS, read as its map_server and nav2_map_server read them: a description in YAML and a picture of
cells, ``trinary``, ``scale`` or ``raw``.

By ``src/map_io.cpp`` of nav2_map_server: of a pixel's lightness and the file's thresholds each cell is a
number from 0, free, to 100, occupied, or unknown. A house has free floor where that is 0, and in a ``raw``
map below ``free_thresh``; what is neither free nor occupied is unknown, and solid.
"""

import math
import stat
import warnings
from pathlib import Path
from reprlib import Repr
from typing import Any, NamedTuple, NoReturn

import numpy as np
import yaml
from PIL import Image

from logic.errors import HouseFileError
from logic.house.occupancy import FREE, MOST_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid, too_many
from logic.spelling import unknown

DESCRIPTIONS, PICTURES = (".yaml", ".yml"), (".pgm", ".png", ".bmp")
"""How the names of a map's files end."""

FORMATS = ("PNG", "PPM", "BMP")
"""Those of Pillow that are read; PGM is one of PPM's."""

MODES = ("trinary", "scale", "raw")

SHORT = Repr()
SHORT.maxlevel, SHORT.maxstring = 1, 60
"""Writes what a file says in an error's line: YAML's aliases make lists longer than any memory."""

BAND = 256
"""Rows that are read at once."""

MOST_TEXT, MOST_PICTURE = 1 << 16, 1 << 28
"""Bytes that are read of a description, and of a picture."""


class Description(NamedTuple):
    """What a map's YAML file says."""

    image: Path
    resolution: float
    """Metres of a cell."""
    origin: tuple[float, float]
    """Where the south-west corner is: x east, y north, metres."""
    occupied: float
    free: float
    """Thresholds, from 0 to 1."""
    negate: bool
    """Whether lighter is more occupied."""
    mode: str


def read_map(path: Path) -> OccupancyGrid:
    """The map that a YAML file describes; its y is turned over, as ours grows south.

    Raises ``HouseFileError``, in a line, for a file that is wrong, a picture that is absent, none or of more
    than ``MOST_CELLS`` pixels, and a map without a free cell; ``OSError`` for a file that cannot be read.
    """
    said = _described(path)
    cells = _cells(said, path)
    west, north = said.origin[0], -(said.origin[1] + said.resolution * len(cells))
    try:
        return OccupancyGrid.of(cells, said.resolution, (west, north))
    except ValueError as error:
        raise HouseFileError(f"{path}: {said.image.name}: {error}") from None


def _described(path: Path) -> Description:
    """Read a YAML file."""

    def wrong(what: str) -> NoReturn:
        raise HouseFileError(f"{path}: no map of ROS: {what}")

    with path.open("rb") as file:
        content = file.read(MOST_TEXT + 1)
    if len(content) > MOST_TEXT:
        wrong(f"more than {MOST_TEXT >> 10} KiB")
    try:
        found: Any = yaml.safe_load(content)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        wrong(f"it is no YAML{f', in line {mark.line + 1}' if mark else ''}")
    if not isinstance(found, dict):
        wrong("it says nothing by name, as in image: map.png")

    def numbers(name: str, value: Any) -> list[float]:
        try:
            # YAML 1.1 takes 5e-2 for a word.
            given = [float(each) for each in (value if isinstance(value, list) else [value])]
        except (TypeError, ValueError, OverflowError):
            given = [math.nan]
        if not all(map(math.isfinite, given)):
            wrong(f"{name} is {SHORT.repr(value)}: it must be of numbers")
        return given

    for name in ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"):
        if found.get(name) is None:
            wrong(f"it lacks {name}, as in image: map.png" if name == "image" else f"it lacks {name}")
    if not isinstance(found["image"], str) or not found["image"]:
        wrong(f"image is {SHORT.repr(found['image'])}: it must be a file's name")
    (resolution, *more), origin = (
        numbers("resolution", found["resolution"]),
        numbers("origin", found["origin"]),
    )
    if more or resolution <= 0:
        wrong(f"resolution is {SHORT.repr(found['resolution'])}: it must be metres of a cell, more than 0")
    if len(origin) != 3:
        wrong(f"origin has {len(origin)} numbers: it must have x, y and yaw")
    if origin[2]:
        wrong(f"origin turns it by {origin[2]:g}: turn the picture, and say 0")
    (occupied, *others), (free, *rest) = (
        numbers(name, found[name]) for name in ("occupied_thresh", "free_thresh")
    )
    if others or rest:
        wrong("occupied_thresh and free_thresh must be a number each")
    if found["negate"] not in (0, 1):
        wrong(f"negate is {SHORT.repr(found['negate'])}: it must be 0 or 1")
    mode = found.get("mode", MODES[0])
    if mode not in MODES:
        wrong(unknown("mode", mode if isinstance(mode, str) else SHORT.repr(mode), MODES))
    image = path.parent / found["image"]
    return Description(image, resolution, (origin[0], origin[1]), occupied, free, bool(found["negate"]), mode)


def _cells(said: Description, path: Path) -> np.ndarray:
    """The cells (H, W) int8 of a map's picture, row 0 in the north."""
    pixels = _pixels(said.image, path)
    cells = np.full(pixels.shape[:2], UNKNOWN, np.int8)
    for row in range(0, len(cells), BAND):
        light, clear = _lightness(pixels[row : row + BAND], said.mode)
        occupancy = light if said.negate else 1 - light
        if said.mode == "raw":
            numbers = np.round(light * 255)
            occupancy, clear = numbers / OCCUPIED, numbers > OCCUPIED  # Beyond 100 all is unknown.
        band = cells[row : row + BAND]
        band[occupancy < said.free] = FREE
        band[occupancy > said.occupied] = OCCUPIED
        band[clear] = UNKNOWN
    return cells


def _lightness(pixels: np.ndarray, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """How light pixels are, from 0 to 1, (H, W) float64: the mean of their colours, and in a trinary map of
    how opaque they are, if the picture says so. In others (H, W) bool which are not opaque.
    """
    light = pixels / np.iinfo(pixels.dtype).max
    clear = np.zeros(light.shape[:2], bool)
    if light.ndim == 2:
        return light, clear
    if light.shape[2] == 4 and mode != "trinary":
        light, clear = light[..., :3], light[..., 3] < 1
    return light.mean(axis=-1), clear


def _pixels(image: Path, path: Path) -> np.ndarray:
    """A picture as whole numbers: (H, W), grey of 8 or 16 bits, or (H, W, 3 or 4)."""

    def wrong(what: str) -> NoReturn:
        raise HouseFileError(f"{path}: its picture {image}: {what}")

    try:
        about = image.stat()
        if not stat.S_ISREG(about.st_mode):
            wrong("is no file")
        if about.st_size > MOST_PICTURE:
            wrong(f"more than {MOST_PICTURE >> 20} MiB")
        with warnings.catch_warnings(action="ignore"), Image.open(image, formats=FORMATS) as picture:
            width, height = picture.size
            if width * height > MOST_CELLS:  # By its head alone: nothing is unpacked yet.
                wrong(too_many(height, width))
            if picture.mode in ("I", "I;16", "I;16B"):
                return np.asarray(picture).astype(np.uint16)
            has_alpha = picture.mode in ("LA", "PA", "RGBA") or "transparency" in picture.info
            as_it_is = "L" if picture.mode in ("1", "L") else "RGB"
            return np.asarray(picture.convert("RGBA" if has_alpha else as_it_is))
    except FileNotFoundError:
        wrong("there is no such file")
    except Image.DecompressionBombError:
        wrong(f"it has more than the {MOST_CELLS:,} cells that are read")
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        # Pillow's own words may be of several lines.
        wrong(str(getattr(error, "strerror", None) or "it is no PNG, PGM or BMP that can be read"))
