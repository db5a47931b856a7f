"""Requirements of a brief, line by line: in words, and as terms of ``rules/brief/brief.lp``."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from vitruvius.logic.request.brief import (
    Brief,
    Entrance,
    Void,
    area_range,
    length_range,
    room_area_range,
    tolerance_of,
)

Where = tuple[str | int, ...]
"""Place in the JSON of a brief: ``("rooms", 0, "area")``."""


class Requirement(NamedTuple):
    """Requirement of a line of a brief, in words and as terms of ``rules/brief/brief.lp``: name, arguments.

    Lengths are whole millimetres, areas square centimetres. Boxes are numbers of rooms, then of voids, or
    ``outline``.
    """

    where: Where
    words: str
    terms: tuple[tuple[Any, ...], ...]

    @property
    def reason(self) -> str:
        """Text of the requirement in a proof."""
        return f"brief: {self.words}"


def requirements(brief: Brief) -> list[Requirement]:
    """Return the requirements of a brief, line by line."""
    return list(_requirements(brief))


def void_numbers(brief: Brief) -> range:
    """Return the numbers of the voids of a brief."""
    return range(len(brief.rooms), len(brief.rooms) + len(brief.outline.voids))


def area_ranges(brief: Brief) -> dict[int | str, tuple[int, int]]:
    """Return the least and the greatest area of each box that has one, square centimetres."""
    found: dict[int | str, tuple[int, int]] = {
        number: room_area_range(room.area, tolerance_of(brief, room))
        for number, room in enumerate(brief.rooms)
        if room.area is not None
    }
    if brief.area is not None:
        least, most = area_range(brief.area, brief.tolerance)
        voids = [_void_area(void) for void in brief.outline.voids]
        found["outline"] = least + sum(low for low, _ in voids), most + sum(high for _, high in voids)
    return found


def _requirements(brief: Brief) -> Iterator[Requirement]:
    places = {name: number for number, name in enumerate(brief.names)}
    areas = area_ranges(brief)
    for number, room in enumerate(brief.rooms):
        for key, words, term in _of_room(brief, number, areas):
            yield Requirement(("rooms", number, *key), f"{room.name} {words}", (term,))
    for key, term, words in (
        ("doors", "door", "a door joins {} and {}"),
        ("no_doors", "no_door", "no door joins {} and {}"),
        ("next_to", "touching", "{} is next to {}"),
        ("apart", "apart", "{} is not next to {}"),
    ):
        for place, (one, other) in enumerate(getattr(brief, key)):
            yield Requirement((key, place), words.format(one, other), ((term, places[one], places[other]),))
    if brief.entrance is not None:
        entrance = Entrance(brief.entrance) if isinstance(brief.entrance, str) else brief.entrance
        place = places[entrance.room]
        if entrance.side:
            words = f"the house is entered by {entrance.room} from the {entrance.side}"
            yield Requirement(("entrance",), words, (("entry", place), ("entry", place, entrance.side)))
        else:
            words = f"the house is entered by {entrance.room}"
            yield Requirement(("entrance",), words, (("entry", place),))
    yield from _outline(brief)
    if brief.area is not None:
        words = f"the house has {_square_metres(area_range(brief.area, brief.tolerance))}"
        yield Requirement(("area",), words, (("area", "outline", *areas["outline"]),))


def _of_room(
    brief: Brief, number: int, areas: Mapping[int | str, tuple[int, int]]
) -> Iterator[tuple[Where, str, tuple[Any, ...]]]:
    """Yield the requirements on a room: place in its JSON, words, and term."""
    room = brief.rooms[number]
    if room.type:
        yield ("type",), f"is of type {room.type}", ("typed", number, room.type)
    if room.area is not None:
        yield ("area",), f"has {_square_metres(areas[number])}", ("area", number, *areas[number])
    if room.size is not None:
        one, other = (length_range(side, tolerance_of(brief, room)) for side in room.size)
        yield ("size",), f"measures {_metres(one)} by {_metres(other)}", ("sides", number, *one, *other)
    if room.outside is True:
        yield ("outside",), "has an outer wall", ("outer", number)
    for place, side in enumerate(room.outside or () if not isinstance(room.outside, bool) else ()):
        yield ("outside", place), f"has an outer wall in the {side}", ("outer", number, side)
    for place, side in enumerate(room.windows):
        yield ("windows", place), f"has a window in the {side}", ("lit", number, side)


def _outline(brief: Brief) -> Iterator[Requirement]:
    outline = brief.outline
    for axis, key, name in (("x", "width", "wide"), ("y", "depth", "deep")):
        if (span := getattr(outline, key)) is not None:
            length = length_range(span, 0)
            words = f"the outline is {_metres(length)} {name}"
            yield Requirement(("outline", key), words, (("extent", "outline", axis, *length),))
    for place, (number, void) in enumerate(zip(void_numbers(brief), outline.voids, strict=True)):
        terms: list[tuple[Any, ...]] = []
        for axis, span in (("x", void.width), ("y", void.depth)):
            if span is not None:
                terms.append(("extent", number, axis, *length_range(span, 0)))
        for axis, span in (("x", void.x), ("y", void.y)):
            if span is not None:
                terms.append(("offset", number, axis, *length_range(span, 0)))
        for side in void.corner.split("-") if void.corner else ():
            terms.append(("rim", number, side))
        if terms:
            yield Requirement(("outline", "voids", place), _void_words(void), tuple(terms))


def _void_words(void: Void) -> str:
    sizes = [
        f"{_metres(length_range(span, 0))} {name}"
        for name, span in (("wide", void.width), ("deep", void.depth))
        if span is not None
    ]
    places = [
        f"{axis} {_metres(length_range(span, 0))}"
        for axis, span in (("x", void.x), ("y", void.y))
        if span is not None
    ]
    what = f"a notch in the {void.corner}" if void.corner else "a void"
    return ", ".join([what, *sizes]) + (f", at {' and '.join(places)}" if places else "")


def _void_area(void: Void) -> tuple[int, int]:
    """Return the area of a void with given width and depth, square centimetres."""
    assert void.width is not None
    assert void.depth is not None
    (w, wide), (d, deep) = length_range(void.width, 0), length_range(void.depth, 0)
    return w * d // 100, -(-wide * deep // 100)


def _square_metres(area: tuple[int, int]) -> str:
    least, most = (f"{each / 1e4:.4g}" for each in area)
    return f"{least} to {most} m²"


def _metres(length: tuple[int, int]) -> str:
    least, most = (f"{each / 1e3:g}" for each in length)
    return f"{least} m" if least == most else f"{least} to {most} m"
