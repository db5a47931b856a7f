"""Explanations of parts of a building of flats agree with the house."""

from time import monotonic

import pytest

from tests.logic.why.derivations import require_whole
from tests.logic.workers import in_process
from vitruvius.logic import House, RequestError
from vitruvius.logic.house.part_names import doors_by_name, part_names
from vitruvius.logic.placement.bounds import wall_bounds
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import Why
from vitruvius.logic.why.units import UnitsWitness
from vitruvius.logic.why.witnesses import witness_of


@pytest.fixture(scope="module")
def witness() -> UnitsWitness:
    """Return a witness of a building of three flats, two of which have as many rooms and the same program."""
    builder = in_process.builder("apartments")
    house = builder.house(HouseRequest(17, {"bedroom": (3, 3)}), 5, 0)
    found = witness_of(builder, house)
    assert isinstance(found, UnitsWitness)
    return found


def first(witness: UnitsWitness, target: str) -> Why:
    """Return the answer without alternatives."""
    found = witness.parts(target, until=0.0)
    why = next(found)
    for more in found:
        why = why.joined(more)
    return why


def targets(house: House) -> list[str]:
    """Return all rooms and doors, a window of each room that has one, and a piece of each type in each."""
    pieces = {
        (room.type, piece.type): f"{room.name}.{name}"
        for room in house.rooms
        for name, piece in zip(part_names([p.type for p in room.pieces]), room.pieces, strict=True)
    }
    windows = dict.fromkeys(f"{window.room}.window" for window in house.windows)
    return [*(room.name for room in house.rooms), *doors_by_name(house), *windows, *pieces.values()]


@pytest.mark.second_part("a large building")
def test_every_kind_of_part_of_a_building_is_derived_from_facts_and_picks_by_rules_in_files(
    witness: UnitsWitness,
) -> None:
    house = witness._house
    assert len({room.type for room in house.rooms}) > 5
    for target in targets(house):
        nodes = [node for tree in first(witness, target).derivations for node in tree.all()]
        require_whole(nodes, target)


def test_what_is_said_of_a_room_is_so_in_the_house(witness: UnitsWitness) -> None:
    """Answers state its type and size, its flat's number of rooms and depth, and lengths within bounds."""
    house = witness._house
    for room in house.rooms:
        why = first(witness, room.name)
        atoms = {node.atom for node in why.derivations}
        assert why.about.startswith(f"a {room.type}, {room.width:.3f} by {room.height:.3f} m")
        assert any(atom.startswith("room(") and atom.endswith(f",{room.type})") for atom in atoms)
        if room is house.main:
            continue
        flat = next(flat for flat in flats(house) if room.name in flat)
        assert any(atom.startswith("unit(") and atom.endswith(f",{len(flat)})") for atom in atoms)
        boxes = [house.room(name) for name in flat]
        depth = max(box.y + box.height for box in boxes) - min(box.y for box in boxes)
        assert f"{len(flat)} rooms, {depth:.2f} m deep along y" in why.about
        first_of_flat = min(flat, key=lambda name: int(name[1:]))
        assert why.about.endswith(f"from 0, which is {first_of_flat}")
        assert f"room({int(room.name[1:]) - int(first_of_flat[1:])},{room.type})" in atoms
        width, height = why.lengths
        assert [width.value, height.value] == pytest.approx([room.width, room.height], abs=1e-6)
        for length in why.lengths:
            assert length.least - 1e-6 <= length.value <= length.greatest + 1e-6


def flats(house: House) -> list[set[str]]:
    """Return the names of rooms that doors join without the public corridor."""
    found: list[set[str]] = []
    for room in house.rooms:
        if room is not house.main:
            beyond = {name for door in house.doors if room.name in door.between for name in door.between}
            joined = [flat for flat in found if flat & beyond]
            found = [flat for flat in found if flat not in joined] + [{room.name}.union(*joined)]
    return [flat - {house.hub} for flat in found]


def test_a_whole_flat_is_asked_for_by_its_name(witness: UnitsWitness) -> None:
    """Its rooms are those behind its door to a public room, and its choices are derived."""
    house = witness._house
    own = {room.name for room in house.rooms if room.type != "commonCorridor"}
    named = []
    while left := sorted(own, key=lambda name: int(name[1:])):
        flat = {left[0]}
        while (
            more := {name for door in house.doors if flat & {*door.between} for name in {*door.between} & own}
            - flat
        ):
            flat |= more
        own -= flat
        target = f"U{len(named) + 1}"
        why = first(witness, target)
        require_whole([node for tree in why.derivations for node in tree.all()], target)
        last = max(flat, key=lambda name: int(name[1:]))
        assert why.about.startswith(f"the unit of {left[0]} to {last}, {len(flat)} rooms, ")
        (depth,) = why.lengths
        boxes = [house.room(name).box for name in flat]
        sides = [max(box[k + 2] for box in boxes) - min(box[k] for box in boxes) for k in (0, 1)]
        assert min(abs(side - depth.value) for side in sides) < 1e-6
        assert depth.least <= depth.value <= depth.greatest
        assert why.others, "other numbers of rooms or places"
        named.append(target)
    assert len(named) == 3
    with pytest.raises(RequestError, match=r"there is no U4: .*the house has R0, .*U3"):
        first(witness, "U4")


def test_the_outline_of_a_flat_stays_where_it_is(witness: UnitsWitness) -> None:
    """Otherwise the flat would overlap others. Its rooms have less freedom than in a house by themselves."""
    house, narrower = witness._house, 0
    for flat in flats(house):
        unit = witness._unit(witness._firsts.index(min(int(name[1:]) for name in flat)))
        boxes = [house.room(name) for name in flat]
        longest = max(box.x + box.width for box in boxes) - min(box.x for box in boxes)
        for place, room in enumerate(unit._house.rooms):
            width, _ = first(witness, room.name).lengths
            placer, layout = witness._builder.placer, unit._making.layout
            alone, _ = unit._bounds(wall_bounds(placer, layout, unit._house.rooms, place), {})
            assert alone[0].least - 1e-6 <= width.least <= width.greatest <= alone[0].greatest + 1e-6
            assert width.greatest <= longest + 1e-6
            narrower += width.greatest - width.least < alone[0].greatest - alone[0].least - 0.01
    assert narrower


def test_what_could_be_instead_is_asked_of_the_flat_and_of_the_building(witness: UnitsWitness) -> None:
    tried = next(part for part in witness.parts("R1", monotonic() + 60) if part.choices)
    assert (tried.choices[0].name, tried.choices[0].value) == ("type(0)", witness._house.room("R1").type)
    [choice] = witness.why("entrance").choices[:1]
    assert {choice.value, *(each.value for each in choice.instead)} == {"yes", "no"}
