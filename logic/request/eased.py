"""Briefs that ask for less: without some lines, or with wider bounds of lengths."""

import json
from collections.abc import Collection
from typing import Any

import msgspec

from vitruvius.logic.house.house import House
from vitruvius.logic.request.brief import LARGEST, LARGEST_ROOM, LONGEST, Brief, bounds, tolerance_of
from vitruvius.logic.request.brief_lines import Where

LENGTHS = {"area", "size", "width", "depth"}
"""Keys of a brief's areas and lengths."""


def is_length(place: Where) -> bool:
    """Return True if a place in a brief's JSON has an area or a length."""
    return place[-1] in LENGTHS


def without(brief: Brief, places: Collection[Where]) -> Brief:
    """Return the brief without the values at these places of its JSON."""
    record = json.loads(msgspec.json.encode(brief))
    for *way, last in sorted(places, reverse=True):  # the last items of a list first
        part = record
        for key in way:
            part = part[key]
        del part[last]
    return msgspec.convert(record, Brief)


def widened(brief: Brief, place: Where, down: float, up: float) -> Brief:
    """Return the brief with wider bounds of the length or area at a place (see ``is_length``).

    The least value is divided by 1 + ``down``, the greatest multiplied by 1 + ``up``.
    """
    *way, last = place
    record = json.loads(msgspec.json.encode(brief))
    part = record
    for key in way:
        part = part[key]
    largest = LONGEST if last != "area" else LARGEST_ROOM if way else LARGEST
    spans = [(least / (1 + down), min(largest, most * (1 + up))) for least, most in _bounds(brief, place)]
    part[last] = spans if last == "size" else spans[0]
    return msgspec.convert(record, Brief)


def off_by(house: House, brief: Brief, place: Where) -> float:
    """Return the fraction by which the bounds of a length must widen for a house to satisfy them."""
    *way, last = place
    if way[:1] == ["rooms"]:
        room = house.rooms[int(way[1])]
        found = [(room.area,)] if last == "area" else [(room.width, room.height), (room.height, room.width)]
    elif last == "area":
        found = [(sum(room.area for room in house.rooms),)]
    else:
        axis = 0 if last == "width" else 1
        ends = [room.box[end] for room in house.rooms for end in (axis, axis + 2)]
        found = [(max(ends) - min(ends),)]
    wanted = _bounds(brief, place)
    return min(
        max(max(least / one, one / most) - 1 for one, (least, most) in zip(sizes, wanted, strict=True))
        for sizes in found
    )


def _bounds(brief: Brief, place: Where) -> list[tuple[float, float]]:
    """Return the least and the greatest value of the lengths at a place."""
    *way, last = place
    part: Any = brief
    for key in way:
        part = part[key] if isinstance(key, int) else getattr(part, key)
    tolerance = 0.0 if way == ["outline"] else tolerance_of(brief, part) if way else brief.tolerance
    span = getattr(part, str(last))
    return [bounds(each, tolerance) for each in (span if last == "size" else [span])]
