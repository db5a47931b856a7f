"""Binary glTF 2.0, by trimesh: a node with the name of each solid. x east, y up, z south; metres."""

from pathlib import Path

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from vitruvius.logic.exports.solids import solids
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House


def write(house: House, path: Path) -> None:
    """Write the solids of a house as one ``.glb`` file."""
    scene = trimesh.Scene()
    for solid in solids(house):
        west, north, east, south = solid.box
        low, high = np.array([west, solid.bottom, north]), np.array([east, solid.top, south])
        box = trimesh.creation.box(high - low)
        opacity = 96 if solid.kind == "window" else 255
        material = PBRMaterial(
            baseColorFactor=[*_linear(solid.colour), opacity],
            metallicFactor=0.0,
            roughnessFactor=0.9,
            alphaMode="BLEND" if opacity < 255 else "OPAQUE",
        )
        box.visual = TextureVisuals(material=material)
        transform = np.array(trimesh.transformations.rotation_matrix(solid.turn, [0, 1, 0]))
        transform[:3, 3] = (low + high) / 2
        scene.add_geometry(box, node_name=solid.name, geom_name=solid.name, transform=transform)
    write_whole(path.with_suffix(".glb"), export_glb(scene))


def _linear(colour: str) -> list[int]:
    """Return a colour of CSS in the linear values of glTF."""
    values = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return [round(255 * value) for value in linear.tolist()]
