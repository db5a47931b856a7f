"""Outlines of IFC's spaces, doors and windows from above, by IfcOpenShell in a separate process.

A damaged file may end the process. ``ifc.py`` writes the file to it, and reads the answer.
"""

import re
import sys
from collections import Counter
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import shapely
from shapely import Polygon

from vitruvius.logic.errors import RequestError
from vitruvius.logic.readers.sketch import chosen

try:
    import resource
except ModuleNotFoundError:  # on Windows
    resource = None  # pyright: ignore[reportAssignmentType]

MAX_MEMORY_BYTES, MAX_CPU_SECONDS = 4 << 30, 60
"""Largest address space, bytes, and processor time, seconds, of this process, as for a solver process."""

SCHEMA = re.compile(rb"FILE_SCHEMA\s*\(\s*\(\s*'([^']{1,40})'", re.IGNORECASE)

STEP, MAX_LEVELS = 1.2, 64
"""Greatest step between floors of one storey, metres; number of levels that may contain a space."""

Triangles = np.ndarray
"""Corners of triangles: (N, 3, 3) float64, metres, z up."""


class Solids(msgspec.Struct):
    """Spaces, each with its words and its shape, doors, and windows. Shapes are WKT, in metres."""

    spaces: list[tuple[list[str], str]]
    doors: list[str]
    windows: list[str]
    error: str = ""
    """Error message; if set, the lists are empty."""


def solids(content: bytes, named: str | None = None) -> Solids:
    """Return the spaces, doors and windows of a storey or a flat. Raises ``RequestError`` if it has none."""
    model = _model(content)
    spaces, doors, windows = (list(model.by_type(each)) for each in ("IfcSpace", "IfcDoor", "IfcWindow"))
    spaces = [each for each in spaces if not _is_whole(each)]
    if not spaces:
        raise RequestError("plan: the IFC file has no IfcSpace, one for each room: export it with spaces")
    solids = [_solid(each) for each in spaces]
    floors = [_floor(model, *each) for each in zip(spaces, solids, strict=True)]
    places = _of_storey(spaces, floors, named)
    found = [(spaces[place], _required(spaces[place], solids[place])) for place in places]
    floor, ceiling = (edge([each[:, :, 2].min() for _, each in found]) for edge in (min, max))
    # Doors and windows of other storeys are in the file, too.
    low, high = floor - 1.0, ceiling + max(np.ptp(each[:, :, 2]) for _, each in found)
    of_doors, of_windows = (
        [
            shapely.to_wkt(_outline(each))
            for each in (_required(product, _solid(product)) for product in some if product.Representation)
            if low < each[:, :, 2].mean() < high
        ]
        for some in (doors, windows)
    )
    rooms = [(_words(each), shapely.to_wkt(_above(solid))) for each, solid in found]
    return Solids(rooms, of_doors, of_windows)


def _model(content: bytes) -> Any:
    """Return the file as IfcOpenShell opens it. Raises ``RequestError`` if IfcOpenShell cannot read it."""
    import ifcopenshell
    from ifcopenshell.ifcopenshell_wrapper import schema_names

    if not content.rstrip().endswith(b"END-ISO-10303-21;"):
        raise RequestError("plan: IFC that is damaged: its end is missing")
    schema = SCHEMA.search(content[:65536])
    name = schema[1].decode("ascii", "replace") if schema else ""
    if schema and name.upper() not in schema_names():
        raise RequestError(f"plan: its schema is {name}, which IfcOpenShell does not read: export it as IFC4")
    try:
        model = ifcopenshell.file.from_string(content.decode("utf-8", errors="replace"))
        model.by_type("IfcSpace")
        return model
    except (RuntimeError, ValueError, TypeError) as error:
        raise RequestError(f"plan: IFC that is damaged: {error}") from None


def _is_whole(space: Any) -> bool:
    """Return True if a space is no room: it consists of spaces, as a flat does, or is a gross floor area."""
    parts = [part for each in space.IsDecomposedBy or () for part in each.RelatedObjects]
    return any(part.is_a("IfcSpace") for part in parts) or getattr(space, "PredefinedType", None) == "GFA"


def _of_storey(spaces: list[Any], floors: list[float], named: str | None) -> list[int]:
    """Return the indices of the spaces of one storey, or of one flat if ``named`` is a flat.

    Floors at most ``STEP`` apart are one storey.
    """
    wholes = [list(_wholes(each)) for each in spaces]
    if named is not None:
        flats = [
            [name for whole in each if whole.is_a("IfcSpace") for name in _named(whole)] for each in wholes
        ]
        wanted = named.strip().casefold()
        if flat := [place for place, names in enumerate(flats) if wanted in map(str.casefold, names)]:
            return flat
    storeys: list[list[int]] = []
    for place in sorted(range(len(spaces)), key=lambda place: floors[place]):
        if not storeys or floors[place] - floors[storeys[-1][-1]] > STEP:
            storeys.append([])
        storeys[-1].append(place)
    names = []
    for some in storeys:
        above = [whole for place in some for whole in wholes[place] if whole.is_a("IfcBuildingStorey")]
        names.append(Counter(name for whole in above for name in _named(whole)[:1]).most_common(1))
    labels, heights = [some[0][0] if some else "" for some in names], [floors[some[0]] for some in storeys]
    return sorted(storeys[chosen(labels, named, heights)])


def _wholes(space: Any) -> Iterator[Any]:
    """Yield all products that contain a space, from the inside out."""
    for _ in range(MAX_LEVELS):
        space = next((each.RelatingObject for each in getattr(space, "Decomposes", None) or ()), None)
        if space is None:
            return
        yield space


def _named(whole: Any) -> list[str]:
    return [str(each) for each in (whole.Name, getattr(whole, "LongName", None)) if each]


def _floor(model: Any, space: Any, solid: Triangles) -> float:
    """Return the height of a space's floor, metres; without a solid, the height of its placement."""
    from ifcopenshell.util.placement import get_local_placement
    from ifcopenshell.util.unit import calculate_unit_scale

    if len(solid):
        return float(solid[:, :, 2].min())
    return float(get_local_placement(space.ObjectPlacement)[2][3]) * calculate_unit_scale(model)


def _words(space: Any) -> list[str]:
    said = (space.LongName, space.Name, space.ObjectType, getattr(space, "PredefinedType", None))
    return [str(each) for each in said if each] or ["room"]


def _solid(product: Any) -> Triangles:
    """Return the surface of a product, in metres; empty if it has no surface."""
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    try:
        mesh: Any = ifcopenshell.geom.create_shape(settings, product)
        corners = np.array(mesh.geometry.verts).reshape(-1, 3)
        return corners[np.array(mesh.geometry.faces, dtype=int).reshape(-1, 3)]
    except (RuntimeError, ValueError, TypeError):
        return np.empty((0, 3, 3))


def _required(product: Any, solid: Triangles) -> Triangles:
    if not len(solid):
        what = f"{product.is_a()} {getattr(product, 'LongName', None) or product.Name or product.GlobalId}"
        raise RequestError(f"plan: {what} has no readable solid: give it one, or leave it out")
    return solid


def _above(solid: Triangles) -> shapely.Geometry:
    """Return the area that a solid covers, seen from above."""
    flat = [each for each in map(Polygon, solid[:, :, :2]) if each.area > 1e-6]
    return shapely.union_all(flat, grid_size=1e-4)


def _outline(solid: Triangles) -> shapely.Geometry:
    """Return the convex outline of a door or window, seen from above."""
    return shapely.convex_hull(shapely.MultiPoint(solid[:, :, :2].reshape(-1, 2)))


def main() -> None:
    """Read a file from the standard input and write its solids, within the limits of this process."""
    if resource is not None:
        resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY_BYTES, MAX_MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (MAX_CPU_SECONDS, MAX_CPU_SECONDS))
    try:
        found = solids(sys.stdin.buffer.read(), *sys.argv[1:])
    except RequestError as error:
        found = Solids([], [], [], str(error))
    sys.stdout.buffer.write(msgspec.json.encode(found))
