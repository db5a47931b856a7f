"""Maps of ROS, read as its map_server and nav2_map_server do: a YAML description and a picture of cells.

The modes are ``trinary``, ``scale`` and ``raw``, as in ``src/map_io.cpp`` of nav2_map_server. A pixel's
lightness and the file's thresholds give each cell a number from 0, free, to 100, occupied, or make it
unknown. A house has free floor where the number is 0, and in a ``raw`` map where it is below ``free_thresh``.
A cell that is neither free nor occupied is unknown, and solid.
"""

import math
import os
import re
import warnings
from contextlib import suppress
from pathlib import Path
from reprlib import Repr
from typing import Any, BinaryIO, NamedTuple, NoReturn

import numpy as np
import yaml
from PIL import Image

from vitruvius.logic.errors import HouseFileError
from vitruvius.logic.house.occupancy import FREE, MOST_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid, too_many
from vitruvius.logic.opener import content_of, opened
from vitruvius.logic.spelling import unknown

FORMATS = ("PNG", "PPM", "BMP")
"""Formats of Pillow that are read. Its format PPM includes PGM."""

MODES = ("trinary", "scale", "raw")

NEGATE = {"0": False, "1": True, "false": False, "true": True, "no": False, "yes": True}
"""Values of the field ``negate``."""

ABBREVIATION = Repr()
ABBREVIATION.maxlevel, ABBREVIATION.maxstring = 1, 60
"""Abbreviation of a file's values in an error message."""

BAND_ROWS = 256
"""Number of rows that are read at once."""

MOST_TEXT, MOST_PICTURE = 1 << 16, 1 << 28
"""Largest sizes of a description and of a picture, in bytes."""

MAX_HEAD, MAX_CHUNKS = 1 << 16, 1 << 16
"""Bytes of a PGM's head; chunks of a PNG."""

PGM = re.compile(
    rb"P(?:[14](?:(?:\s|#[^\r\n]*+[\r\n])++\d{1,9}){2}|[2356](?:(?:\s|#[^\r\n]*+[\r\n])++\d{1,9}){3})\s"
)
"""Head of a PGM: width, height and, unless it is black and white, the greatest value; comments between."""


class Description(NamedTuple):
    """Contents of a map's YAML file."""

    image: Path
    resolution: float
    """Side of a cell, metres."""
    origin: tuple[float, float]
    """Place of the south-west corner: x east, y north, metres."""
    occupied: float
    free: float
    """Thresholds, from 0 to 1."""
    negate: bool
    """True if lighter pixels are more occupied."""
    mode: str


def read_map(path: Path) -> OccupancyGrid:
    """Return the map that a YAML file describes, with y turned over, since y grows south in houses.

    Raises ``HouseFileError``, in one line, for a wrong file, for a picture that is absent, unreadable or of
    more than ``MOST_CELLS`` pixels, and for a map without a free cell. Raises ``OSError`` for a file that
    cannot be read.
    """
    said = _described(path)
    cells = _cells(said, path)
    west, north = said.origin[0], -(said.origin[1] + said.resolution * len(cells))
    try:
        return OccupancyGrid.of(cells, said.resolution, (west, north))
    except ValueError as error:
        raise HouseFileError(f"{path}: {said.image.name}: {error}") from None


def _described(path: Path) -> Description:
    """Return the contents of a YAML file."""

    def wrong(what: str) -> NoReturn:
        raise HouseFileError(f"{path}: not a ROS map: {what}")

    content = content_of(path, MOST_TEXT, unpack=False)
    try:
        _require_plain(content)
        found: Any = yaml.load(content, yaml.BaseLoader)  # texts, and lists of them
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        if re.match(rb"[\w\s]*+:", content) and not re.search(rb"(?m)^image[ \t]*:", content):
            wrong("it lacks image, as in image: map.png")
        mark = getattr(error, "problem_mark", None)
        wrong(f"it is not YAML with plain values{f', in line {mark.line + 1}' if mark else ''}")
    if not isinstance(found, dict):
        wrong("it has no keys, such as image: map.png")
    found = {name: _value(each) for name, each in found.items()}

    def numbers(name: str, value: Any) -> list[float]:
        try:
            given = [float(each) for each in (value if isinstance(value, list) else [value])]
        except (TypeError, ValueError, OverflowError):
            given = [math.nan]
        if not all(map(math.isfinite, given)):
            wrong(f"{name} is {ABBREVIATION.repr(value)}: it must hold numbers")
        return given

    for name in ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"):
        if found.get(name) is None:
            wrong(f"it lacks {name}, as in image: map.png" if name == "image" else f"it lacks {name}")
    if not isinstance(found["image"], str) or not found["image"]:
        wrong(f"image is {ABBREVIATION.repr(found['image'])}: it must be a file's name")
    (resolution, *more), origin = (
        numbers("resolution", found["resolution"]),
        numbers("origin", found["origin"]),
    )
    if more or resolution <= 0:
        wrong(
            f"resolution is {ABBREVIATION.repr(found['resolution'])}: it must be a cell's width in metres, "
            "more than 0"
        )
    if len(origin) != 3:
        wrong(f"origin has {len(origin)} numbers: it must have x, y and yaw")
    if origin[2]:
        wrong(f"origin rotates the map by {origin[2]:g}: rotate the picture, and set yaw to 0")
    (occupied, *others), (free, *rest) = (
        numbers(name, found[name]) for name in ("occupied_thresh", "free_thresh")
    )
    if others or rest:
        wrong("occupied_thresh and free_thresh must be a number each")
    negate = NEGATE.get(str(found["negate"]).lower())
    if negate is None:
        wrong(f"negate is {ABBREVIATION.repr(found['negate'])}: it must be 0 or 1")
    mode = found.get("mode", MODES[0])
    if mode not in MODES:
        wrong(unknown("mode", mode if isinstance(mode, str) else ABBREVIATION.repr(mode), MODES))
    image = path.parent / found["image"]
    if not image.resolve().is_relative_to(path.parent.resolve()):
        wrong(f"image is {ABBREVIATION.repr(found['image'])}: it must lie in the folder of this file")
    return Description(image, resolution, (origin[0], origin[1]), occupied, free, negate, mode)


def _require_plain(content: bytes) -> None:
    """Raise ``YAMLError`` for a tag, an anchor, an alias, or a value that is neither a text nor a list."""
    depth = 0
    for event in yaml.parse(content, yaml.BaseLoader):
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > 2 or getattr(event, "anchor", None) or getattr(event, "tag", None):
            raise yaml.MarkedYAMLError(problem_mark=event.start_mark)


def _value(text: Any) -> Any:
    """Return the number that a text states, else the text, since YAML 1.1 reads 5e-2 as a text."""
    if isinstance(text, list):
        return [*map(_value, text)]
    for kind in (int, float):
        with suppress(ValueError, TypeError):
            return kind(text)
    return text


def _cells(said: Description, path: Path) -> np.ndarray:
    """Return the cells (H, W) int8 of a map's picture, row 0 in the north."""
    pixels = _pixels(said.image, path)
    cells = np.full(pixels.shape[:2], UNKNOWN, np.int8)
    for row in range(0, len(cells), BAND_ROWS):
        light, clear = _lightness(pixels[row : row + BAND_ROWS], said.mode)
        occupancy = light if said.negate else 1 - light
        if said.mode == "raw":
            numbers = np.round(light * 255)
            occupancy, clear = numbers / OCCUPIED, numbers > OCCUPIED  # Beyond 100 all cells are unknown.
        band = cells[row : row + BAND_ROWS]
        band[occupancy < said.free] = FREE
        band[occupancy > said.occupied] = OCCUPIED
        band[clear] = UNKNOWN
    return cells


def _lightness(pixels: np.ndarray, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the lightness of pixels, from 0 to 1, (H, W) float64, and a mask (H, W) of transparent pixels.

    Lightness is the mean of the colours. In a trinary map the mean includes the opacity, if the picture has
    one, and the mask is empty.
    """
    light = pixels / np.iinfo(pixels.dtype).max
    clear = np.zeros(light.shape[:2], bool)
    if light.ndim == 2:
        return light, clear
    if light.shape[2] == 4 and mode != "trinary":
        light, clear = light[..., :3], light[..., 3] < 1
    return light.mean(axis=-1), clear


def _with_plain_head(file: BinaryIO) -> BinaryIO:
    """Return the file of a picture.

    Raises ``ValueError`` for a header that Pillow would take minutes to read: a PGM with long comments, or a
    PNG with very many chunks.
    """
    head = file.read(MAX_HEAD)
    if head.startswith(b"P") and not PGM.match(head):
        raise ValueError
    if head.startswith(b"\x89PNG"):
        file.seek(8)
        for _ in range(MAX_CHUNKS):
            size = file.read(8)[:4]
            if len(size) < 4:
                break
            file.seek(int.from_bytes(size) + 4, os.SEEK_CUR)
        else:
            raise ValueError
    file.seek(0)
    return file


def _pixels(image: Path, path: Path) -> np.ndarray:
    """Return a picture as whole numbers: (H, W), grey of 8 or 16 bits, or (H, W, 3 or 4)."""

    def wrong(what: str) -> NoReturn:
        raise HouseFileError(f"{path}: its picture {image}: {what}")

    try:
        with (
            warnings.catch_warnings(action="ignore"),
            opened(image, MOST_PICTURE, unpack=False) as file,
            Image.open(_with_plain_head(file), formats=FORMATS) as picture,
        ):
            width, height = picture.size
            if width * height > MOST_CELLS:  # By its header alone, before anything is unpacked.
                wrong(too_many(height, width))
            if picture.mode in ("I", "I;16", "I;16B"):
                return np.asarray(picture).astype(np.uint16)
            has_alpha = picture.mode in ("LA", "PA", "RGBA") or "transparency" in picture.info
            as_it_is = "L" if picture.mode in ("1", "L") else "RGB"
            return np.asarray(picture.convert("RGBA" if has_alpha else as_it_is))
    except FileNotFoundError:
        wrong("there is no such file")
    except Image.DecompressionBombError:
        wrong(f"it has more than {MOST_CELLS:,} cells, the limit")
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        # Pillow's own message may have several lines.
        wrong(str(getattr(error, "strerror", None) or "it is not a readable PNG, PGM or BMP"))
