"""Words on a plan: its title, the rooms' names, and below it the scale and what marks and colours mean."""

import math
import re
from collections.abc import Iterable, Sequence
from itertools import chain, product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from logic.drawing.canvas import Block, Box, Line, Shape, Text, text_width
from logic.drawing.door_leaves import Leaf
from logic.drawing.frame import Frame
from logic.drawing.furniture import has_mark
from logic.drawing.palettes import Fill, Style, style
from logic.drawing.plan import floor, house_shapes
from logic.house.house import House
from logic.house.looks import spaced
from logic.house.parts import ORIGINAL, Room
from logic.spelling import numbered

LEAST = 6.5
"""CSS pixels: no name is written smaller. A room that is too small for its name so has an abbreviation."""
SWATCH = 14.0
"""CSS pixels: how wide a colour is in the key, and a row high."""
MAX_SWINGS = 512
"""Number of door swings over a room that the room's name avoids."""
SPOTS = np.array(sorted(product([k / 8 for k in range(-8, 9)], repeat=2), key=lambda spot: math.hypot(*spot)))
"""Where a name may stand in a room, from its middle (0, 0) to its walls (1), the middle first."""


UNNAMED = re.compile(r"R?\d+")
"""Names of rooms that nobody named: of generated houses, and numbers in a plan."""


def room_names(
    house: House,
    frame: Frame,
    style: Style,
    short: dict[str, str],
    least: float = LEAST,
    leaves: Sequence[Leaf] = (),
) -> list[tuple[Text, ...]]:
    """The name of each room, or its type where nobody named it, then that of a star's main room, in letters
    of ``least`` CSS pixels or more; where it fits, the room's area below it. Names keep clear of furniture,
    and of the swings of doors as far as they can.

    Where a name does not fit so between the walls: the room's type; or what is ``short`` for that, on
    furniture if need be; without that nothing.
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


def background(house: House, frame: Frame, least: float = LEAST) -> tuple[Shape, ...]:
    """A house with its rooms' names, without the leaves of doors: what is drawn under bodies and rays."""
    look = style([house])
    names = room_names(house, frame, look, {}, least)
    return (*house_shapes(house, frame, look), *(word for name in names for word in name))


def _area(square_metres: float) -> str:
    return f"{square_metres:.1f} m²"


def _shared(one: Box, other: Box) -> float:
    """The area that two boxes have in common."""
    across, along = (min(one[k + 2], other[k + 2]) - max(one[k], other[k]) for k in range(2))
    return max(0.0, across) * max(0.0, along)


def unnamed(house: House, names: Sequence[Sequence[Text]]) -> set[str]:
    """The types of rooms of which neither name nor type is written in full, by ``room_names`` of a house."""
    pairs = zip(house.counted, names, strict=False)
    return {
        room.type
        for room, words in pairs
        if _has_name(house, room) and (not words or words[0].text not in _full(room))
    }


def _full(room: Room) -> list[str]:
    """What a room is called, the best first: by the name that somebody gave it, and by its type."""
    kind = spaced(room.type)
    return [kind] if UNNAMED.fullmatch(room.name) else [*dict.fromkeys((room.name, kind))]


def _has_name(house: House, room: Room) -> bool:
    """Whether a room's name is written: a part has that of another, and all of a map none."""
    return not room.part_of and not (house.occupancy and room is house.rooms[0])


def abbreviations(types: Iterable[str]) -> dict[str, str]:
    """For each type the shortest beginning that no other type has; a type that begins another is whole."""
    listed = sorted(set(types))

    def short(name: str) -> str:
        others = [other for other in listed if other != name]
        lengths = range(1, len(name))
        return next((name[:n] for n in lengths if not any(o.startswith(name[:n]) for o in others)), name)

    return {name: short(name) for name in listed}


def title(house: House, width: float) -> str:
    """Where the house comes from and how large it is; the first words go where there is no room."""
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
    """A bar of one metre, or of more where that is too short to be seen, and what the marks are."""
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
    """What a key says of a type: in words, and as drawings have it."""

    words: str
    short: str
    fill: Fill


def entries(style: Style, short: dict[str, str], numbers: dict[str, str]) -> list[Entry]:
    """Return the entries of these types of rooms, by their abbreviations, and of pieces, by their numbers."""
    rooms = [Entry(spaced(kind), text, style.fill(kind)) for kind, text in short.items()]
    wood = Fill(style.inks.wood)
    return [*rooms, *(Entry(style.looks.name(kind), text, wood) for kind, text in numbers.items())]


def key_rows(listed: Iterable[Entry], width: float) -> list[list[Entry]]:
    """The entries of a key, in rows of at most this many CSS pixels."""
    rows: list[list[Entry]] = [[]]
    for entry in listed:
        if rows[-1] and sum(_key_width(each.words) for each in [*rows[-1], entry]) > width:
            rows.append([])
        rows[-1].append(entry)
    return [row for row in rows if row]


def key(rows: Sequence[Sequence[Entry]], style: Style, left: float, y: float) -> list[Shape]:
    """A colour with its abbreviation or number for each type, the first row at ``y``."""
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
    """The first of these texts, or the ``short`` one, that fits into a room, with the area below it if that
    stands clear of what is there.

    ``taken``: by furniture, which only the short text may hide, and by swings of doors, which any may.
    ``sizes``: the best of its letters, and the least. ``colours``: of the words, and of the floor.
    ``halo``: whether the words have a rim in the floor's colour wherever they stand, and not only where they
    lie on something.
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
    """Where the middle of words is as near to that of a room as keeps clear of what is there, and how much
    they hide there; ``None`` where they do not fit between the walls. ``tall``: half their height; ``taken``:
    boxes (N, 4). All in CSS pixels.
    """
    left, top, right, bottom = room
    half = width / 2 + 0.3 * letter
    # How far the middle of the words may go from the middle of the room.
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
    best = int(hidden.argmin())  # The first of the least: the nearest to the middle.
    return (float(places[0][best]), float(places[1][best])), float(hidden[best])
