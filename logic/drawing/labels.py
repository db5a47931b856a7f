"""Words on a plan: the title, the rooms' names, and below the plan the scale and the key."""

import math
import re
from collections.abc import Iterable, Sequence
from itertools import chain, product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vitruvius.logic.drawing.canvas import Block, Box, Line, Shape, Text, text_width
from vitruvius.logic.drawing.door_leaves import Leaf
from vitruvius.logic.drawing.frame import Frame
from vitruvius.logic.drawing.furniture import has_mark
from vitruvius.logic.drawing.palettes import Fill, Style, style
from vitruvius.logic.drawing.plan import floor, house_shapes
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import ORIGINAL, Room
from vitruvius.logic.looks.looks import spaced
from vitruvius.logic.spelling import numbered

MIN_FONT_PX = 6.5
"""Smallest font size of a name, CSS pixels. A room that is too small for its name has an abbreviation."""
SWATCH = 14.0
"""Width of a colour in the key, and height of a row, CSS pixels."""
MAX_SWINGS = 512
"""Number of door swings over a room that the room's name avoids."""
SPOTS = np.array(sorted(product([k / 8 for k in range(-8, 9)], repeat=2), key=lambda spot: math.hypot(*spot)))
"""Candidate places of a name in a room, from the middle (0, 0) to the walls (1), the middle first."""


UNNAMED = re.compile(r"R?\d+")
"""Automatic names of rooms: those of generated houses, such as ``R3``, and numbers in a plan."""


def room_names(
    house: House,
    frame: Frame,
    style: Style,
    short: dict[str, str],
    least: float = MIN_FONT_PX,
    leaves: Sequence[Leaf] = (),
) -> list[tuple[Text, ...]]:
    """Return the label of each room, then that of a star's main room.

    A label is the room's name, or its type if the name is automatic, with the area below it if that fits.
    The font size is at least ``least`` CSS pixels. Labels avoid furniture, and the swings of doors if
    possible. If the name does not fit, the label is the type; if the type does not fit, its abbreviation in
    ``short``, on furniture if necessary. A room whose type has no abbreviation then has no label.
    """
    size = min(max(0.3 * frame.scale, 8.5, least), 15.0)
    swings = [frame.place(leaf.swing) for leaf in leaves]
    ends = np.array(swings).reshape(-1, 4)
    sizes = size, least
    names = []
    for room in house.counted:
        if not _has_name(house, room):
            names.append(())
            continue
        fill, box = style.fill(room.type), frame.box(room)
        pieces = [frame.box(piece) for piece in room.pieces]
        area = sum(part.area for part in house.parts(room))
        over = (np.minimum(ends[:, 2:], box[2:]) - np.maximum(ends[:, :2], box[:2]) > 0).all(axis=1)
        taken = pieces, [swings[index] for index in np.flatnonzero(over)[:MAX_SWINGS]]
        texts = _full(room), short.get(room.type, "")
        names.append(
            _name(*texts, _area(area), box, taken, sizes, (style.inks.ink, fill.colour), bool(fill.hatch))
        )
    if main := house.main_room:
        taken = [frame.box(room) for room in house.cut_from(main)], swings
        free = main.area - sum(_shared(main.box, room.box) for room in house.cut_from(main))
        colours = style.inks.edge, style.inks.paper
        names.append(_name(["main room"], "", _area(free), frame.box(main), taken, sizes, colours, False))
    return names


def background(house: House, frame: Frame, least: float = MIN_FONT_PX) -> tuple[Shape, ...]:
    """Return the shapes of a house and its rooms' names, without door leaves, as a background for robots."""
    look = style([house])
    names = room_names(house, frame, look, {}, least)
    return (*house_shapes(house, frame, look), *(word for name in names for word in name))


def _area(square_metres: float) -> str:
    return f"{square_metres:.1f} m²"


def _shared(one: Box, other: Box) -> float:
    """Return the common area of two boxes."""
    across, along = (min(one[k + 2], other[k + 2]) - max(one[k], other[k]) for k in range(2))
    return max(0.0, across) * max(0.0, along)


def unnamed(house: House, names: Sequence[Sequence[Text]]) -> set[str]:
    """Return the types of rooms that show neither their name nor their type in full.

    ``names`` are the labels that ``room_names`` returned for the house.
    """
    pairs = zip(house.counted, names, strict=False)
    return {
        room.type
        for room, words in pairs
        if _has_name(house, room) and (not words or words[0].text not in _full(room))
    }


def _full(room: Room) -> list[str]:
    """Return the texts that name a room, best first: the name that a user gave it, and its type."""
    kind = spaced(room.type)
    return [kind] if UNNAMED.fullmatch(room.name) else [*dict.fromkeys((room.name, kind))]


def _has_name(house: House, room: Room) -> bool:
    """Return True if the room has a label: a part of another room and the floor of a map have none."""
    return not room.part_of and not (house.occupancy and room is house.rooms[0])


def abbreviations(types: Iterable[str]) -> dict[str, str]:
    """Return for each type its shortest unique beginning; a type that begins another one stays whole."""
    listed = sorted(set(types))

    def short(name: str) -> str:
        others = [other for other in listed if other != name]
        lengths = range(1, len(name))
        return next((name[:n] for n in lengths if not any(o.startswith(name[:n]) for o in others)), name)

    return {name: short(name) for name in listed}


def title(house: House, width: float) -> str:
    """Return the title of a plan: origin and size of the house. A wide title loses its first parts."""
    if house.occupancy:
        rows, columns = house.occupancy.shape
        return f"map of {columns} by {rows} cells of {house.occupancy.cell:g} m"
    area = sum(room.area for room in house.rooms if room.type not in house.outdoor)
    parts = [numbered(len(house.counted), "room")]
    parts = ["original", *parts] if house.topology == ORIGINAL else [*parts, f"{area:.0f} m²"]
    if house.provenance is not None:
        source = house.provenance
        parts = [Path(source.grammar).name, f"seed {source.seed}", f"house {source.index}", *parts]
    while len(parts) > 1 and text_width(" · ".join(parts), 11.5) > width:
        parts = parts[1:]
    return " · ".join(parts)


def legend(house: House, style: Style, scale: float, left: float, y: float) -> list[Shape]:
    """Draw the scale bar, longer than one metre if one is too short to see, and the meaning of the marks."""
    metres = next((metres for metres in (1, 2, 5, 10, 20) if metres * scale >= 18), 50)
    right, ink, mark = left + metres * scale, style.inks.ink, style.inks.mark
    ends = [Line(((x, y - 3), (x, y + 3)), ink, 1.2) for x in (left, right)]
    words = Text((right + 6, y), f"{metres} m", 10, ink, "start")
    shapes: list[Shape] = [Line(((left, y), (right, y)), ink, 1.2), *ends, words]
    start = right + 6 + text_width(words.text, 10) + 16
    fronts = any(has_mark(house, piece, style) for room in house.rooms for piece in room.pieces)
    entered = any(door.is_entrance for door in house.doors)
    for meaning in ["front of furniture"] * fronts + ["entrance"] * entered:
        end = start + SWATCH
        if meaning == "entrance":
            end = start + 8
            shapes.append(Line(((start, y - 5), (end, y), (start, y + 5)), mark, 1.8))
        else:
            shapes.append(Line(((start, y), (end, y)), mark, 2.4))
        shapes.append(Text((end + 5, y), meaning, 10, ink, "start"))
        start = end + 5 + text_width(meaning, 10) + 16
    return shapes


class Entry(NamedTuple):
    """An entry of the key: a type in words, its abbreviation or number, and its colour."""

    words: str
    short: str
    fill: Fill


def entries(style: Style, short: dict[str, str], numbers: dict[str, str]) -> list[Entry]:
    """Return the key's entries for room types, with abbreviations, and for piece types, with numbers."""
    rooms = [Entry(spaced(kind), text, style.fill(kind)) for kind, text in short.items()]
    wood = Fill(style.inks.wood)
    return [*rooms, *(Entry(style.looks.name(kind), text, wood) for kind, text in numbers.items())]


def key_rows(listed: Iterable[Entry], width: float) -> list[list[Entry]]:
    """Return the entries of a key in rows of at most ``width`` CSS pixels."""
    rows: list[list[Entry]] = [[]]
    for entry in listed:
        if rows[-1] and sum(_key_width(each.words) for each in [*rows[-1], entry]) > width:
            rows.append([])
        rows[-1].append(entry)
    return [row for row in rows if row]


def key(rows: Sequence[Sequence[Entry]], style: Style, left: float, y: float) -> list[Shape]:
    """Draw the key: each type's colour, its abbreviation or number, and its words. Row 0 is at ``y``."""
    shapes: list[Shape] = []
    for number, row in enumerate(rows):
        x, middle = left, y + number * SWATCH
        for words, short, fill in row:
            box = x, middle - 5.5, x + SWATCH, middle + 5.5
            shapes += [*floor(box, fill, style.inks), Block(box, "", style.inks.wall, 0.8)]
            size = min(7.5, (SWATCH - 2) / text_width(short, 1))
            halo = fill.colour if fill.hatch else ""
            shapes.append(Text((x + SWATCH / 2, middle), short, size, style.inks.ink, halo=halo))
            shapes.append(Text((x + SWATCH + 4, middle), words, 10, style.inks.ink, "start"))
            x += _key_width(words)
    return shapes


def _key_width(words: str) -> float:
    return SWATCH + 14 + text_width(words, 10)


def _name(
    texts: Sequence[str],
    short: str,
    area: str,
    room: Box,
    taken: tuple[Sequence[Box], Sequence[Box]],
    sizes: tuple[float, float],
    colours: tuple[str, str],
    halo: bool,
) -> tuple[Text, ...]:
    """Return the first text that fits into a room, else the ``short`` one, with the area below if that fits.

    ``taken`` are the boxes of furniture, which only the short text may cover, and of door swings, which any
    text may cover. ``sizes`` are the preferred and the least font size. ``colours`` are those of the words
    and of the floor. With ``halo`` the words have a rim in the floor's colour everywhere; without it, only
    where they cover something.
    """
    ink, floor_colour = colours
    rim = floor_colour if halo else ""
    size, least = sizes
    pieces, both = (np.array([*boxes], dtype=float).reshape(-1, 4) for boxes in (taken[0], chain(*taken)))
    if 0.8 * size >= least:
        wide = max(text_width(texts[0], size), text_width(area, 0.8 * size))
        if place := _spot(wide, 1.15 * size, room, both, size):
            (x, y), hidden = place
            if not hidden:
                return (
                    Text((x, y - 0.5 * size), texts[0], round(size, 1), ink, halo=rim),
                    Text((x, y + 0.62 * size), area, round(0.8 * size, 1), ink, halo=rim),
                )
    found: tuple[float, Text] | None = None
    for text, boxes in product([*texts, short] if short else texts, (both, pieces)):
        for letter in (size, max(least, 0.85 * size), max(least, 0.7 * size), least):
            place = _spot(text_width(text, letter), 0.75 * letter, room, boxes, letter)
            if place is None:
                continue
            (x, y), hidden = place
            if not hidden:
                edge = rim if boxes is both else floor_colour
                return (Text((x, y), text, round(letter, 1), ink, halo=edge),)
            if boxes is pieces and text == short and (found is None or hidden < found[0]):
                found = hidden, Text((x, y), text, round(letter, 1), ink, halo=floor_colour)
    return (found[1],) if found else ()


def _spot(
    width: float, tall: float, room: Box, taken: np.ndarray, letter: float
) -> tuple[tuple[float, float], float] | None:
    """Return the place for the middle of the words that covers least, and how much the words cover there.

    Of several such places, the one nearest to the room's middle. Return None if the words do not fit between
    the walls. ``tall`` is half the height of the words; ``taken`` are boxes (N, 4). All in CSS pixels.
    """
    left, top, right, bottom = room
    half = width / 2 + 0.3 * letter
    # Greatest distances from the middle of the room to the middle of the words.
    wide, high = (right - left) / 2 - half - 1.5, (bottom - top) / 2 - tall - 1.5
    if wide < 0 or high < 0:
        return None
    places = (left + right) / 2 + SPOTS[:, 0] * wide, (top + bottom) / 2 + SPOTS[:, 1] * high
    if not len(taken):
        return (float(places[0][0]), float(places[1][0])), 0.0
    deep = [
        np.minimum.outer(middle + reach, taken[:, axis + 2])
        - np.maximum.outer(middle - reach, taken[:, axis])
        for axis, (middle, reach) in enumerate(zip(places, (half, tall), strict=True))
    ]
    hidden = np.minimum(*deep).clip(0).sum(axis=1)
    best = int(hidden.argmin())  # the first minimum: the nearest to the middle
    return (float(places[0][best]), float(places[1][best])), float(hidden[best])
