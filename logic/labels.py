"""Words on a plan: its title, the rooms' names, and below it the scale and what marks and colours mean."""

import math
from collections.abc import Iterable, Sequence
from itertools import product
from pathlib import Path

from logic.boxes import overlap
from logic.canvas import Block, Box, Line, Shape, Text, text_width
from logic.house import House
from logic.parts import ORIGINAL
from logic.plan import FAINT, INK, MARK, PAPER, WALL, Frame, has_mark, room_colour

LEAST = 6.5
"""CSS pixels: no name is written smaller. A room that is too small for its name so has an abbreviation."""
SWATCH = 14.0
"""CSS pixels: how wide a colour is in the key, and a row high."""
SPOTS = sorted(product([k / 8 for k in range(-8, 9)], repeat=2), key=lambda spot: math.hypot(*spot))
"""Where a name may stand in a room, from its middle (0, 0) to its walls (1), the middle first."""


def room_names(house: House, frame: Frame, short: dict[str, str], least: float = LEAST) -> list[Text | None]:
    """The name of each room, then that of a star's main room, in letters of ``least`` CSS pixels or more.

    Where a name does not fit between the walls: what is ``short`` for it, else ``None``.
    """
    size = min(max(0.34 * frame.scale, 8.5, least), 15.0)
    names = [
        _name(
            [room.type, short.get(room.type, room.type)],
            frame.box(room),
            [frame.box(piece) for piece in room.pieces],
            (size, least),
            (INK, room_colour(room.type)),
        )
        for room in house.counted
    ]
    if not house.is_star:
        return names
    rooms = [frame.box(room) for room in house.counted]
    return [*names, _name(["main room"], frame.box(house.main), rooms, (size, least), (FAINT, PAPER))]


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
    floor = sum(room.area for room in house.rooms)
    count = len(house.counted)
    parts = [f"{count} room{'s' * (count != 1)}"]
    parts = ["original", *parts] if house.topology == ORIGINAL else [*parts, f"{floor:.0f} m²"]
    if house.provenance is not None:
        source = house.provenance
        parts = [Path(source.grammar).name, f"seed {source.seed}", f"house {source.index}", *parts]
    while len(parts) > 1 and text_width(" · ".join(parts), 11.5) > width:
        parts = parts[1:]
    return " · ".join(parts)


def legend(house: House, scale: float, left: float, y: float) -> list[Shape]:
    """A bar of one metre, or of more where that is too short to be seen, and what the coloured marks are."""
    metres = next((metres for metres in (1, 2, 5, 10, 20) if metres * scale >= 18), 50)
    right = left + metres * scale
    ends = [Line(((x, y - 3), (x, y + 3)), INK, 1.2) for x in (left, right)]
    words = Text((right + 6, y), f"{metres} m", 10, INK, "start")
    shapes: list[Shape] = [Line(((left, y), (right, y)), INK, 1.2), *ends, words]
    start = right + 6 + text_width(words.text, 10) + 16
    fronts = any(has_mark(house, piece) for room in house.rooms for piece in room.pieces)
    entered = any(door.is_entrance for door in house.doors)
    for meaning in ["front of furniture"] * fronts + ["entrance"] * entered:
        end = start + SWATCH
        shapes.append(Line(((start, y), (end, y)), MARK, 2.4))
        if meaning == "entrance":
            shapes.append(Line(((end - 5, y - 4), (end, y), (end - 5, y + 4)), MARK, 2.4))
        shapes.append(Text((end + 5, y), meaning, 10, INK, "start"))
        start = end + 5 + text_width(meaning, 10) + 16
    return shapes


def key_rows(short: dict[str, str], width: float) -> list[list[str]]:
    """The types of a key, in rows of at most this many CSS pixels."""
    rows: list[list[str]] = [[]]
    for kind in short:
        if rows[-1] and sum(map(_key_width, [*rows[-1], kind])) > width:
            rows.append([])
        rows[-1].append(kind)
    return [row for row in rows if row]


def key(rows: Sequence[Sequence[str]], short: dict[str, str], left: float, y: float) -> list[Shape]:
    """A colour with its abbreviation for each type, the first row at ``y``."""
    shapes: list[Shape] = []
    for number, row in enumerate(rows):
        x, middle = left, y + number * SWATCH
        for kind in row:
            box = x, middle - 5.5, x + SWATCH, middle + 5.5
            shapes.append(Block(box, room_colour(kind), WALL, 0.8))
            size = min(7.5, (SWATCH - 2) / text_width(short[kind], 1))
            shapes.append(Text((x + SWATCH / 2, middle), short[kind], size, INK))
            shapes.append(Text((x + SWATCH + 4, middle), kind, 10, INK, "start"))
            x += _key_width(kind)
    return shapes


def _key_width(kind: str) -> float:
    return SWATCH + 14 + text_width(kind, 10)


def _name(
    texts: Sequence[str],
    room: Box,
    taken: Sequence[Box],
    sizes: tuple[float, float],
    colours: tuple[str, str],
) -> Text | None:
    """The first of these texts that fits into a room, as near to its middle as it keeps clear of what is
    there; where it must lie on something, with a rim in the floor's colour.

    ``sizes``: the best of its letters, and the least. ``colours``: of the words, and of the floor.
    """
    left, top, right, bottom = room
    size, least = sizes
    for text in texts:
        found = None
        for letter in (size, max(least, 0.85 * size), max(least, 0.7 * size), least):
            half, tall = text_width(text, letter) / 2 + 0.3 * letter, 0.75 * letter
            # How far the middle of the words may go from the middle of the room.
            wide, high = (right - left) / 2 - half - 1.5, (bottom - top) / 2 - tall - 1.5
            if wide < 0 or high < 0:
                continue
            for u, v in SPOTS:
                x, y = (left + right) / 2 + u * wide, (top + bottom) / 2 + v * high
                box = x - half, y - tall, x + half, y + tall
                hidden = sum(max(0.0, overlap(box, other)) for other in taken)
                if not hidden:
                    return Text((x, y), text, round(letter, 1), colours[0])
                if found is None or hidden < found[0]:
                    found = hidden, Text((x, y), text, round(letter, 1), colours[0], halo=colours[1])
        if found is not None:
            return found[1]
    return None
