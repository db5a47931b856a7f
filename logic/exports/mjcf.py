"""MJCF, the XML of MuJoCo (mujoco.readthedocs.io): a house that contains a robot with range finders.

z up; x east, y north; metres. MuJoCo's range finders ignore boxes that are wholly transparent. Therefore a
wall without thickness is two boxes: a visible one, nearly a plane, where rays end as the simulator's do, and
a transparent one that the robot touches.
"""

from math import cos, radians, sin
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import shapely

from vitruvius.logic.errors import RequestError
from vitruvius.logic.exports.floor import floor, outline
from vitruvius.logic.exports.solids import Solid, solids
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import BODY

RAYS, FIRST_RAY, RAY_SPACING_DEG = 40, 58.5, 3.0
"""The simulator's rays: their number, the angle from the heading to ray 0 and the angle between rays.

Angles are in degrees, counter-clockwise.
"""

EYE_HEIGHT_M = 0.3
"""Height of the range finders above the floor, metres: lower than any piece of ``looks.json``."""

TOUCHED_THICKNESS_M = 0.01
"""Thickness of walls for the robot, metres, enough that it does not pass through in one step of MuJoCo."""

SEEN_THICKNESS_M = 2e-6
"""Thickness of walls for rays, metres."""

ROBOT_HEIGHT_M = 0.4
"""Height of the robot, metres."""


def write(house: House, path: Path) -> None:
    """Write a house as ``.xml``."""
    root = to_mjcf(house, path.name)
    indent(root)
    write_whole(path.with_suffix(".xml"), tostring(root, encoding="utf-8", xml_declaration=True) + b"\n")


def to_mjcf(house: House, name: str = "house") -> Element:
    """Return a house as the element ``mujoco``.

    The robot stands in the middle of the largest free place of the room where episodes start. It slides along
    ``x`` and ``y`` and turns about ``heading`` (radians, counter-clockwise from east). A velocity drives each
    of these joints. Sensor ``ray_i`` is the distance along ray i, metres, or -1 if the ray hits nothing.
    Raises ``RequestError`` if no room has a free place for the robot.
    """
    root = Element("mujoco", model=name)
    SubElement(root, "compiler", angle="radian")
    SubElement(root, "option", timestep="0.005", integrator="implicitfast")
    world = SubElement(root, "worldbody")
    SubElement(world, "light", pos="0 0 20", dir="0 0 -1", directional="true")
    touched = {each.name: each for each in solids(house, TOUCHED_THICKNESS_M)}
    for each in solids(house, SEEN_THICKNESS_M):
        is_whole = touched[each.name] == each and each.kind != "floor"
        seen = {} if is_whole else {"contype": "0", "conaffinity": "0"}
        _box(world, each, _rgba(each), name=each.name, **seen)
        if touched[each.name] != each:  # no dot in this name, since names of other parts have one
            _box(world, touched[each.name], "0 0 0 0", name=f"{each.name}_body")
    _robot(root, world, *_free_place(house))
    return root


def _robot(root: Element, world: Element, x: float, y: float) -> None:
    robot = SubElement(world, "body", name="robot", pos=_numbers(x, -y, 0))
    for joint, kind, axis in (
        ("x", "slide", "1 0 0"),
        ("y", "slide", "0 1 0"),
        ("heading", "hinge", "0 0 1"),
    ):
        SubElement(robot, "joint", name=joint, type=kind, axis=axis)
    size = _numbers(BODY / 2, BODY / 2, ROBOT_HEIGHT_M / 2)
    pos = _numbers(0, 0, ROBOT_HEIGHT_M / 2 + TOUCHED_THICKNESS_M)
    SubElement(robot, "geom", name="robot", type="box", size=size, pos=pos, mass="5", rgba="0.85 0.45 0.3 1")
    actuators, sensors = SubElement(root, "actuator"), SubElement(root, "sensor")
    for joint, gain in (("x", "100"), ("y", "100"), ("heading", "10")):
        SubElement(actuators, "velocity", name=joint, joint=joint, kv=gain)
    for ray in range(RAYS):
        angle = radians(FIRST_RAY - RAY_SPACING_DEG * ray)
        axis = _numbers(cos(angle), sin(angle), 0)
        SubElement(
            robot, "site", name=f"ray_{ray}", pos=_numbers(0, 0, EYE_HEIGHT_M), zaxis=axis, size="0.01"
        )
        SubElement(sensors, "rangefinder", name=f"ray_{ray}", site=f"ray_{ray}")


def _box(world: Element, solid: Solid, rgba: str, **attributes: str) -> None:
    west, north, east, south = solid.box
    middle = _numbers((west + east) / 2, -(north + south) / 2, (solid.bottom + solid.top) / 2)
    size = _numbers((east - west) / 2, (south - north) / 2, (solid.top - solid.bottom) / 2)
    turned = {"euler": _numbers(0, 0, solid.turn)} if solid.turn else {}
    SubElement(
        world, "geom", {"type": "box", "pos": middle, "size": size, "rgba": rgba, **turned, **attributes}
    )


def _rgba(solid: Solid) -> str:
    red, green, blue = (int(solid.colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return f"{red:.3f} {green:.3f} {blue:.3f} {0.4 if solid.kind == 'window' else 1}"


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _free_place(house: House) -> tuple[float, float]:
    """Return the centre of the largest free circle in the room where episodes start.

    If the robot does not fit there, the circle lies in another room. In a map it lies on the largest
    connected floor.
    """
    taken = [shapely.box(*piece.box) for room in house.rooms for piece in room.pieces]
    taken += [outline(wall).buffer(SEEN_THICKNESS_M) for wall in house.free_walls]
    solid = shapely.union_all(taken)
    for room in (house.start, *house.rooms):
        free = floor(house, room) - solid
        if house.occupancy:
            free = max(shapely.get_parts(free), key=shapely.area, default=free)
        if free.is_empty:
            continue
        # A line from the circle's centre outwards.
        line = shapely.maximum_inscribed_circle(free)  # pyright: ignore[reportCallIssue, reportArgumentType]
        if shapely.length(line) > BODY / 2**0.5:
            x, y = shapely.get_coordinates(line)[0].tolist()
            return x, y
    raise RequestError(f"no room has a free place for the robot of mjcf, {BODY} m wide")
