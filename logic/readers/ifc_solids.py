"""What spaces, doors and windows of IFC look like from above, by IfcOpenShell: a process of its own, which a
damaged file may end. ``ifc.py`` writes it the file, and reads the answer.
"""

import resource
import sys
from typing import Any

import msgspec
import numpy as np
import shapely
from shapely import Polygon

from logic.errors import RequestError

MAX_MEMORY_BYTES, MAX_CPU_SECONDS = 4 << 30, 60
"""Address space and processor time of this process, the same as of a solver process."""

Triangles = np.ndarray
"""(N, 3, 3) float64: corners in metres, z up."""


class Solids(msgspec.Struct):
    """Spaces, each with its words and its shape, doors and windows: shapes in WKT, metres."""

    spaces: list[tuple[list[str], str]]
    doors: list[str]
    windows: list[str]
    error: str = ""
    """In the place of these."""


def solids(content: bytes) -> Solids:
    """What there is of a storey. Raises ``RequestError`` for what is no storey of rooms."""
    import ifcopenshell

    if not content.rstrip().endswith(b"END-ISO-10303-21;"):
        raise RequestError("plan: IFC that is damaged: its end is missing")
    try:
        model = ifcopenshell.file.from_string(content.decode("utf-8", errors="replace"))
        spaces, doors, windows = (list(model.by_type(each)) for each in ("IfcSpace", "IfcDoor", "IfcWindow"))
    except (RuntimeError, ValueError, TypeError) as error:
        raise RequestError(f"plan: IFC that is damaged: {error}") from None
    if not spaces:
        raise RequestError("plan: IFC has an IfcSpace for each room: it has none: export it with spaces")
    storeys = sorted({_storey(each) for each in spaces})
    if len(storeys) > 1:
        raise RequestError(
            f"plan: it has {len(storeys)} storeys with spaces ({', '.join(storeys[:4])}): export one of them"
        )
    found = [(each, _solid(each)) for each in spaces]
    floor, ceiling = (edge([each[:, :, 2].min() for _, each in found]) for edge in (min, max))
    # Doors and windows of other storeys are in the file, too.
    low, high = floor - 1.0, ceiling + max(np.ptp(each[:, :, 2]) for _, each in found)
    outlines = [
        [_outline(each) for each in map(_solid, some) if low < each[:, :, 2].mean() < high]
        for some in (_with_shape(doors), _with_shape(windows))
    ]
    rooms = [(_words(each), shapely.to_wkt(_above(solid))) for each, solid in found]
    doors, windows = ([shapely.to_wkt(each) for each in some] for some in outlines)
    return Solids(rooms, doors, windows)


def _storey(space: Any) -> str:
    """The name of what a space is part of."""
    whole = [each.RelatingObject for each in space.Decomposes or ()]
    return str((whole[0].Name or whole[0].GlobalId) if whole and whole[0] else "no storey")


def _words(space: Any) -> list[str]:
    return [str(each) for each in (space.LongName, space.Name, space.ObjectType) if each] or ["room"]


def _with_shape(products: list[Any]) -> list[Any]:
    return [each for each in products if each.Representation]


def _solid(product: Any) -> Triangles:
    """The surface of a product, in metres."""
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    try:
        mesh: Any = ifcopenshell.geom.create_shape(settings, product)
        corners = np.array(mesh.geometry.verts).reshape(-1, 3)
        triangles = corners[np.array(mesh.geometry.faces, dtype=int).reshape(-1, 3)]
    except (RuntimeError, ValueError, TypeError):
        triangles = np.empty((0, 3, 3))
    if not len(triangles):
        what = f"{product.is_a()} {getattr(product, 'LongName', None) or product.Name or product.GlobalId}"
        raise RequestError(f"plan: {what} has no solid that can be read: give it one, or leave it out")
    return triangles


def _above(solid: Triangles) -> shapely.Geometry:
    """What a solid covers, seen from above."""
    flat = [each for each in map(Polygon, solid[:, :, :2]) if each.area > 1e-6]
    return shapely.union_all(flat, grid_size=1e-4)


def _outline(solid: Triangles) -> shapely.Geometry:
    """Around what a door or window covers."""
    return shapely.convex_hull(shapely.MultiPoint(solid[:, :, :2].reshape(-1, 2)))


def main() -> None:
    """Read a file from the standard input and write its solids, within the limits of this process."""
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY_BYTES, MAX_MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (MAX_CPU_SECONDS, MAX_CPU_SECONDS))
    try:
        found = solids(sys.stdin.buffer.read())
    except RequestError as error:
        found = Solids([], [], [], str(error))
    sys.stdout.buffer.write(msgspec.json.encode(found))
