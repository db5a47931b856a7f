"""Promises of a grammar's houses, from its facts and lengths. The promises travel with the houses."""

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping
from typing import Any

import msgspec
from clingo import Symbol

from vitruvius.logic.house.parts import OUTSIDE
from vitruvius.logic.house.promises import Promises, Relation, Sizes, Thickness
from vitruvius.logic.layout.program import Program
from vitruvius.logic.request.own_plan import OwnPlan


def promises_of(
    program: Program,
    extremes: Mapping[str, Any],
    metres: Mapping[str, Any],
    shares_walls: bool,
    stated: bool = False,
) -> Promises:
    """Return the promises of the houses of a program, by its facts.

    ``extremes`` are the extreme sizes on the houses' grid (``logic.placement.lengths.stated_lengths``);
    ``metres`` are lengths and areas as the grammar states them (``logic.placement.lengths.metres``).
    ``stated`` is True if a brief or a plan may state doors.
    """
    lengths = dict(metres["lengths"])
    opens = _pairs(program, "opens") if shares_walls else {}
    for one, other in [*_atoms(program, "loops", 2), *(_atoms(program, "may_lead", 2) if stated else ())]:
        opens.setdefault(one, []).append(other)
    oblong = _required(program, "oblong")
    companions = [*_atoms(program, "beside", 4), *_atoms(program, "around", 4)]
    public = _required(program, "public")
    at_wall, turning = _at_wall(program), _atoms(program, "turns", 2)
    turns = _named(each for each in turning if each[1] != "middle")
    by_wall = {*at_wall} - {*turns}
    by_room = {*_only(program, "middle")} - {*_named(turning)}
    own = _own(program)
    return Promises(
        door_width=lengths["door_width"],
        door_widths=_widths(metres["doors"]),
        door_clearance=lengths["door_clearance"],
        # Furniture stands a clearance away from a door, even if a passage is wider.
        passage=min(lengths["passage"], lengths["door_clearance"]),
        front=lengths["passage"],
        room_gap=None if shares_walls else lengths["room_gap"],
        basic=own["basic"],
        a_side=next(iter(own["a_side"]), None),
        room_size={name: _sizes(sizes) for name, sizes in sorted(extremes["rooms"].items())},
        room_relations={name: tuple(_relations(rows)) for name, rows in metres["rooms"]},
        room_area={name: (float(least), float(most)) for name, least, most in metres["areas"]},
        whole_area={name: (float(least), float(most)) for name, least, most in metres["wholes"]},
        house_area=(float(metres["total"][0]), float(metres["total"][1])) if metres["total"] else None,
        house_size=tuple(_relations(metres["house"])) if shares_walls else (),
        same_size={name: name in oblong for name in _required(program, "same_size")} if shares_walls else {},
        wall_thickness=Thickness(*metres["walls"]) if metres["walls"] else None,
        opens={name: tuple(sorted({*others})) for name, others in sorted(opens.items()) if others},
        degree=_degrees(program, public) if shares_walls else {},
        openings={one: tuple(others) for one, others in sorted(_pairs(program, "opening").items())},
        parts={one: tuple(others) for one, others in sorted(_pairs(program, "part").items())},
        entrance=bool(opens.get(OUTSIDE)),
        public=public,
        courts=len(_atoms(program, "void", 1)),
        lit=_required(program, "lit"),
        outdoor=_required(program, "outdoor") if shares_walls else (),
        turning={name: float(side) for name, side in metres["turning"]},
        even_rows=_even_rows(program),
        hides=_required(program, "hides"),
        empty=_named(_atoms(program, "empty", 1)),
        piece_size=_piece_sizes(extremes["pieces"]),
        piece_relations={name: tuple(_relations(rows)) for name, rows in metres["pieces"]},
        counts=_counts(_atoms(program, "may", 4), sorted(extremes["rooms"])),
        companions=_counts(companions, ()),
        at_head=_named(_atoms(program, "at_head", 2)),
        at_wall=at_wall,
        turns=turns,
        free_foot=own["free_foot"],
        clear_front=_required(program, "clear_front"),
        spans={name: _ends(along) for name, along, _ in metres["shares"] if along and name in by_wall},
        shares={name: _ends(a) for name, a, b in metres["shares"] if a and a == b and name in by_room},
        meet=own["meet"],
    )


def labelled(promises: Promises, labels: Iterable[str]) -> Promises:
    """Return the promises of houses in which some rooms have labels, which promise nothing, as types."""
    empty = (*promises.empty, *sorted(labels))
    counts = promises.counts | {label: {} for label in sorted(labels)}
    return msgspec.structs.replace(promises, opens={}, empty=tuple(dict.fromkeys(empty)), counts=counts)


def with_openings(promises: Promises, plan: OwnPlan) -> Promises:
    """Return the promises together with the openings of a plan, which stay between rooms of any types."""
    every, openings = tuple(promises.counts), dict(promises.openings)
    types = {room.name: (room.type,) if room.type else every for room in plan.rooms} | {OUTSIDE: (OUTSIDE,)}
    for one, other in (door.between for door in plan.doors if door.opening):
        for each in types[one]:
            openings[each] = tuple(dict.fromkeys((*openings.get(each, ()), *types[other])))
    return msgspec.structs.replace(promises, openings=openings)


def _degrees(program: Program, public: Container[str]) -> dict[str, tuple[int, int]]:
    """Return the least and greatest number of doors of each room type that states them.

    Public rooms are left out: rules do not count their doors.
    """
    stated = [tuple[Any, ...](map(_plain, fact.arguments)) for fact in sorted(program.facts("degree", 3))]
    return {type_: (least, most) for type_, least, most in stated if type_ not in public}


def _relations(rows: Iterable[tuple[list[tuple[int, float]], float, str]]) -> Iterator[Relation]:
    """Yield the relations of variables 0 and 1 in rows of ``rules/linear/linear.pl``, the lesser factor 1."""
    for pairs, constant, relation in rows:
        unit = min(abs(factor) for _, factor in pairs)
        a, b, c = (
            round(each / unit, 9) + 0.0 for each in (*(dict(pairs).get(k, 0.0) for k in (0, 1)), -constant)
        )
        yield a, b, c
        if relation == "=":
            yield -a, -b, -c


def _widths(doors: Iterable[tuple[str, str, float]]) -> dict[str, dict[str, float]]:
    """Return the widths of doors by the types of both ends."""
    found: dict[str, dict[str, float]] = {}
    for one, other, width in doors:
        found.setdefault(one, {})[other] = float(width)
    return found


def _atoms(program: Program, name: str, arity: int) -> list[tuple[Any, ...]]:
    """Return the arguments of the atoms of a name that may hold: words and whole numbers."""
    return [tuple(map(_plain, atom.arguments)) for atom in sorted(program.atoms(name, arity))]


def _plain(term: Symbol) -> str | int:
    return term.number if term.type.name == "Number" else str(term)


def _required(program: Program, name: str) -> tuple[str, ...]:
    """Return the first arguments of the facts of a property."""
    return tuple(sorted(str(fact.arguments[0]) for fact in program.facts(name, 1)))


def _named(atoms: Iterable[tuple[Any, ...]]) -> tuple[str, ...]:
    """Return the first arguments."""
    return tuple(sorted({first for first, *_ in atoms}))


def _pairs(program: Program, name: str) -> dict[str, list[str]]:
    """Return for each first argument all second arguments."""
    found = defaultdict[str, list[str]](list)
    for one, other in _atoms(program, name, 2):
        found[one].append(other)
    return dict(found)


def _counts(facts: Iterable[tuple[Any, ...]], names: Iterable[str]) -> dict[str, dict[str, tuple[int, int]]]:
    """Return for each of these names, and each first argument, the bounds of each second argument."""
    found: dict[str, dict[str, tuple[int, int]]] = {name: {} for name in names}
    for owner, thing, least, most in facts:
        low, high = found.setdefault(owner, {}).get(thing, (least, most))
        found[owner][thing] = min(low, least), max(high, most)
    return found


def _piece_sizes(rooms: Mapping[str, Mapping[str, Any]]) -> dict[str, Sizes]:
    """Return the bounds of each piece in all rooms together."""
    found: dict[str, list[list[float]]] = {}
    for pieces in rooms.values():
        for piece, sizes in pieces.items():
            found.setdefault(piece, []).append(sizes)
    bounds = (min, max, min, max)
    return {
        piece: _sizes([bound(some) for bound, some in zip(bounds, zip(*each, strict=True), strict=True)])
        for piece, each in sorted(found.items())
    }


def _sizes(extremes: Iterable[float]) -> Sizes:
    """Return extremes to the micrometre, so that house files stay short."""
    a, b, c, d = (round(float(each), 6) for each in extremes)
    return a, b, c, d


def _even_rows(program: Program) -> dict[str, tuple[str, ...]]:
    """Return the pieces of even rows by room type, without types whose pieces may also stand at a wall."""
    stands, found = _pairs(program, "stands"), {}
    for type_ in _required(program, "even_rows"):
        pieces = [piece for owner, piece, *_ in _atoms(program, "may", 4) if owner == type_]
        rows = tuple(piece for piece in pieces if "middle" in stands[piece])
        if all(stands[piece] == ["middle"] for piece in rows):
            found[type_] = rows
    return found


def _own(program: Program) -> Mapping[str, tuple[Any, ...]]:
    """Return the promises that the grammar itself states by ``promise/2``: values by name."""
    found = defaultdict[str, tuple[Any, ...]](tuple)
    for name, value in sorted(tuple(map(_plain, fact.arguments)) for fact in program.facts("promise", 2)):
        found[str(name)] += (value,)
    return found


def _ends(range_: Iterable[float]) -> tuple[float, float]:
    """Return the least and greatest value, without the noise of the solver."""
    least, most = (round(float(each), 9) for each in range_)
    return least, most


def _only(program: Program, place: str) -> tuple[str, ...]:
    """Return the piece types that stand only at this place."""
    return tuple(piece for piece, places in sorted(_pairs(program, "stands").items()) if places == [place])


def _at_wall(program: Program) -> tuple[str, ...]:
    """Return the piece types that stand only at walls."""
    stands = _pairs(program, "stands")
    return tuple(piece for piece, places in sorted(stands.items()) if "middle" not in places)
