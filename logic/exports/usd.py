"""OpenUSD, by usd-core: a cube with collisions for each solid, under a scope for each kind.

z up; x east, y north; metres.
"""

# usd-core has no type stubs.
# pyright: reportAttributeAccessIssue=false

import secrets
from collections import Counter
from math import degrees
from pathlib import Path

from pxr import Gf, Tf, Usd, UsdGeom, UsdPhysics

from vitruvius.logic.exports.solids import solids
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House


def write(house: House, path: Path) -> None:
    """Write the solids of a house as one ``.usda`` file."""
    stage = Usd.Stage.CreateInMemory(f"{secrets.token_hex(8)}.usda")
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, "/house")
    stage.SetDefaultPrim(root.GetPrim())
    taken = Counter[str]()
    for solid in solids(house):
        west, north, east, south = solid.box
        cube = UsdGeom.Cube.Define(stage, f"/house/{solid.kind}s/{_identifier(solid.name, taken)}")
        cube.GetPrim().SetDisplayName(solid.name)
        UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
        cube.CreateSizeAttr(1.0)
        cube.CreateExtentAttr([(-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)])
        middle = (west + east) / 2, -(north + south) / 2, (solid.bottom + solid.top) / 2
        cube.AddTranslateOp().Set(Gf.Vec3d(*middle))
        if solid.turn:
            cube.AddRotateZOp().Set(degrees(solid.turn))
        cube.AddScaleOp().Set(Gf.Vec3f(east - west, south - north, solid.top - solid.bottom))
        red, green, blue = (int(solid.colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
        cube.CreateDisplayColorAttr([Gf.Vec3f(red, green, blue)])
        if solid.kind == "window":
            cube.CreateDisplayOpacityAttr([0.4])
    write_whole(path.with_suffix(".usda"), stage.GetRootLayer().ExportToString().encode())


def _identifier(name: str, taken: Counter[str]) -> str:
    """Return an unused identifier for a name, in ASCII, which all versions of OpenUSD read."""
    found = own = Tf.MakeValidIdentifier(name)
    while found in taken:
        taken[own] += 1
        found = f"{own}_{taken[own]}"
    taken[found] = 0
    return found
