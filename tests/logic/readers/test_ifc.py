"""The reader of IFC returns the named storey of a building, by the heights of floors, with all flats."""

import io
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import ifcopenshell
import ifcopenshell.guid
import pytest

from vitruvius.logic import RequestError
from vitruvius.logic.readers.ifc_solids import solids
from vitruvius.logic.readers.types import OUTSIDE, meant
from vitruvius.logic.request.given_plan import read_plan

pytestmark = pytest.mark.filterwarnings("ignore::logic.PlanWarning")

Place = tuple[float, float, float, float]
"""West, south, width and depth, metres."""


class Building:
    """Model with spaces, doors and storeys, in metres."""

    def __init__(self) -> None:
        self.model = ifcopenshell.file(schema="IFC4")
        self._origin = self.made("IfcAxis2Placement3D", self._point(0, 0, 0))
        self._context = self.made("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, self._origin)
        unit = self.made("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")
        self.rooted("IfcProject", RepresentationContexts=[self._context],
                    UnitsInContext=self.made("IfcUnitAssignment", [unit]))  # fmt: skip

    def made(self, kind: str, *values: Any, **named: Any) -> Any:
        return self.model.create_entity(kind, *values, **named)

    def rooted(self, kind: str, **named: Any) -> Any:
        return self.made(kind, ifcopenshell.guid.new(), **named)

    def _point(self, *at: float) -> Any:
        return self.made("IfcCartesianPoint", [float(each) for each in at])

    def product(self, kind: str, place: Place, floor: float, height: float = 2.5, **named: Any) -> Any:
        """Add a box that stands on a floor."""
        x, y, width, depth = place
        ring = [(x, y), (x + width, y), (x + width, y + depth), (x, y + depth), (x, y)]
        profile = self.made("IfcArbitraryClosedProfileDef", "AREA", None,
                            self.made("IfcPolyline", [self._point(*each) for each in ring]))  # fmt: skip
        up = self.made("IfcDirection", [0.0, 0.0, 1.0])
        solid = self.made("IfcExtrudedAreaSolid", profile, self._origin, up, height)
        shown = self.made("IfcShapeRepresentation", self._context, "Body", "SweptSolid", [solid])
        at = self.made("IfcLocalPlacement", None, self.made("IfcAxis2Placement3D", self._point(0, 0, floor)))
        body = self.made("IfcProductDefinitionShape", Representations=[shown])
        return self.rooted(kind, ObjectPlacement=at, Representation=body, **named)

    def rooms(self, names: Sequence[str], floor: float, x: float = 0.0) -> list[Any]:
        """Add rooms of 3 by 4 m in a row, with walls of 0.1 m."""
        return [
            self.product("IfcSpace", (x + 3.1 * k, 0, 3, 4), floor, LongName=name)
            for k, name in enumerate(names)
        ]

    def whole(self, kind: str, parts: Sequence[Any], **named: Any) -> Any:
        whole = self.rooted(kind, **named)
        self.rooted("IfcRelAggregates", RelatingObject=whole, RelatedObjects=list(parts))
        return whole

    def rooms_of(self, storey: str | None = None) -> tuple[str, ...]:
        """Return the first words of the rooms that are read, in this process, as another takes a second."""
        return tuple(words[0] for words, _ in solids(self.model.to_string().encode(), storey).spaces)


GROUND, UPPER = ("Diele", "Wohnen", "Küche"), ("Flur", "Bad", "Kind 1", "Schlafen")


@pytest.fixture
def house() -> Building:
    """Return a building of two storeys, each with a door, with the upper storey's name first."""
    building = Building()
    for floor, rooms, name in ((2.8, UPPER, "1. OG"), (0.0, GROUND, "EG")):
        building.whole("IfcBuildingStorey", building.rooms(rooms, floor), Name=name)
        building.product("IfcDoor", (3.0, 1, 0.1, 0.9), floor, 2.0)
    return building


def test_of_several_storeys_the_named_one_is_read_with_its_own_doors(house: Building, tmp_path: Path) -> None:
    with pytest.raises(
        RequestError, match=r"2 storeys with rooms \(EG, 1\. OG\): choose one, as in --storey EG"
    ):
        house.rooms_of()
    assert house.rooms_of("EG") == GROUND
    with pytest.raises(RequestError, match=r"there is no storey 2\. OG: did you mean 1\. OG"):
        house.rooms_of("2. OG")
    (tmp_path / "model.ifc").write_text(house.model.to_string())
    plan = read_plan(tmp_path / "model.ifc", storey="1. og")
    assert tuple(room.name for room in plan.rooms) == UPPER
    assert [door.between for door in plan.doors] == [UPPER[:2]]


@pytest.mark.parametrize(
    ("named", "listed"),
    [(("EG", "EG"), "EG 1, EG 2"), ((None, None), "1, 2"), (("Block", "OG"), "Block, OG")],
)
def test_storeys_are_told_apart_by_their_floors_whatever_their_names(
    named: tuple[str | None, str | None], listed: str
) -> None:
    building = Building()
    for name, floor, rooms in zip(named, (0.0, 2.8), (GROUND, UPPER), strict=True):
        building.whole("IfcBuildingStorey", building.rooms(rooms, floor), Name=name)
    with pytest.raises(RequestError, match=rf"2 storeys with rooms \({listed}\)"):
        building.rooms_of()
    for storey in (listed.split(", ")[1], "2.8", "3 m"):
        assert building.rooms_of(storey) == UPPER


def test_spaces_of_one_floor_are_one_storey_whatever_they_are_parts_of() -> None:
    building = Building()
    first, second, third = building.rooms(GROUND, 0.0)
    building.whole("IfcBuildingStorey", [first], Name="EG")
    building.whole("IfcBuildingStorey", [second], Name="EG links")
    assert third.Decomposes == ()
    assert building.rooms_of() == GROUND


def test_a_flat_that_is_a_space_of_spaces_is_no_room_nor_is_a_gross_floor_area() -> None:
    building = Building()
    outline = building.product("IfcSpace", (0, 0, 9.2, 4), 0.0).Representation
    building.model.remove(building.model.by_type("IfcSpace")[0])
    flat = building.whole("IfcSpace", building.rooms(GROUND, 0.0), Name="WE 1", Representation=outline)
    building.whole("IfcBuildingStorey", [flat], Name="EG")
    building.product("IfcSpace", (-1, -1, 12, 6), 0.0, LongName="Brutto", PredefinedType="GFA")
    assert building.rooms_of() == GROUND


def test_of_several_flats_one_is_read_by_its_name() -> None:
    building = Building()
    flats = [
        building.whole("IfcSpace", building.rooms(rooms, 0.0, x), Name=name)
        for name, rooms, x in (("WE 1", GROUND, 0.0), ("WE 2", UPPER, 9.3))
    ]
    building.whole("IfcBuildingStorey", flats, Name="EG")
    assert building.rooms_of() == (*GROUND, *UPPER)
    assert building.rooms_of("we 2") == UPPER


def test_what_is_outside_is_known_by_its_predefined_type() -> None:
    building = Building()
    building.product("IfcSpace", (0, -2, 3, 2), 0.0, LongName="A 0.4", PredefinedType="EXTERNAL")
    [(words, _)] = solids(building.model.to_string().encode()).spaces
    assert meant(words) == (OUTSIDE, True)


def zipped(files: Mapping[str, str]) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return content.getvalue()


def test_a_zipped_model_is_read_and_one_in_xml_is_refused(house: Building, tmp_path: Path) -> None:
    (tmp_path / "a.ifczip").write_bytes(zipped({"pictures/a.png": "", "model.IFC": house.model.to_string()}))
    assert tuple(room.name for room in read_plan(tmp_path / "a.ifczip", storey="EG").rooms) == GROUND
    (tmp_path / "b.ifczip").write_bytes(zipped({"model.ifcxml": "<ifcXML/>"}))
    with pytest.raises(RequestError, match=r"model\.ifcxml of the archive is not IFC .*: export it as \.ifc"):
        read_plan(tmp_path / "b.ifczip")
