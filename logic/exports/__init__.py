"""Houses in the formats of other tools, for ``vitruvius convert --to``.

A format is a function that writes a house to a file: ``write(house, path)``, with a path without an ending.
Its libraries are imported when it is used.
"""

from collections.abc import Callable, Iterable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from vitruvius.logic.errors import RequestError
from vitruvius.logic.installation import required_by
from vitruvius.logic.spelling import unknown

if TYPE_CHECKING:
    from vitruvius.logic.house.house import House


class Format(NamedTuple):
    """Format: the module that writes it, and a description."""

    module: str
    endings: tuple[str, ...]
    """Endings of the files for one house, the first of which is named in messages."""
    words: str
    """Description in the command's help."""


FORMATS = {
    "geojson": Format("geojson", (".geojson",), "in metres: rooms, doors, windows, furniture"),
    "gltf": Format("gltf", (".glb",), "binary glTF 2.0, walls 2.5 m high, furniture as boxes"),
    "mjcf": Format("mjcf", (".xml",), "MuJoCo's XML, with a robot and its range finders"),
    "ros": Format("ros", (".yaml", ".png"), "an occupancy map for map_server of ROS and ROS 2"),
    "usd": Format("usd", (".usda",), "OpenUSD, the same solids as gltf"),
}
"""Formats by the name that ``--to`` takes."""


def export(houses: Iterable["House"], out: str | Path, format: str) -> list[Path]:
    """Write each house into the folder ``out`` in a format of ``FORMATS``.

    Return the first file of each house.

    House 0 is ``house-0``. Each file appears whole or not at all. Raises ``ValueError`` for another format
    and for no house, ``RequestError`` for a house that the format cannot hold, and ``ImportError`` if its
    library is missing.
    """
    if format not in FORMATS:
        raise ValueError(unknown("format", format, FORMATS))
    houses, out = list(houses), Path(out)
    if not houses:
        raise ValueError(f"no house to write to {out}")
    module, endings, _ = FORMATS[format]
    with required_by(format):
        write: Callable[[House, Path], None] = import_module(f"vitruvius.logic.exports.{module}").write
    digits = len(str(len(houses) - 1))
    paths = []
    for index, house in enumerate(houses):
        path = out / f"house-{index:0{digits}}"
        try:
            write(house, path)
        except RequestError as error:
            raise RequestError(f"house {index}: {error}") from None
        paths.append(path.with_suffix(endings[0]))
    return paths
