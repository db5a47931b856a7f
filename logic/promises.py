"""What grammars promise beyond what every house keeps, as data, and whether a room keeps it.

Written apart from the rules: a wrong rule shows as a broken promise.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import msgspec

from logic.boxes import BACK, TOLERANCE, distance, excess, overlap, walls_touched
from logic.parts import Piece, Room

CLEARANCE = 0.45
"""Metres: nothing stands nearer to a door, on either side of its wall."""
FRONTAL = 0.4572
"""Metres: the paper's 1.5 feet, which the original's houses keep clear in front of a door and behind it."""
PASSAGE = 0.42
"""Metres: the least width of a passage (the body measures 0.394 m on the diagonal)."""

Sizes = tuple[float, float, float, float]
"""Least and greatest width (or length), least and greatest depth, metres."""


class Promises(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a grammar promises; left empty, it promises nothing more."""

    door: float | None = None
    """Metres: the width of a star's every door (None where it need only be the same throughout a house), the
    least width of others.
    """
    clearance: float = CLEARANCE
    """Metres: nothing stands nearer to a door."""
    room_gap: float | None = None
    """Metres: as near as rooms may come to each other."""
    basic: tuple[str, ...] = ()
    """Room types: from two rooms on two rooms are of these, from ``len(basic)`` on one is of each."""
    a_side: int | None = None
    """From four rooms on at most ``rooms // a_side + 1`` of them are on one side of the main room."""
    rooms: dict[str, Sizes] = {}
    """Of each room type in a star: its width runs along the wall with its door."""
    areas: dict[str, tuple[float, float]] = {}
    """Of each room type in other houses: least and greatest area, square metres."""
    narrowest: dict[str, float] = {}
    """Of each room type in other houses: the least of its shorter side, metres."""
    opens: dict[str, frozenset[str]] = {}
    """For each room type, and for ``outside``, those that it may open into; a door needs one direction."""
    entrance: bool = False
    """Whether a house has a door to the outside."""
    public: frozenset[str] = frozenset()
    """Room types that units are entered from: without such rooms, each part of a house that doors join has
    one door to them, and none to the outside.
    """
    lit: frozenset[str] = frozenset()
    """Room types that have a window."""
    hides: frozenset[str] = frozenset()
    """Piece types that do not stand before a window."""
    empty: frozenset[str] = frozenset()
    """Room types of a star that may have no furniture."""
    pieces: dict[str, Sizes] = {}
    """Of each piece type: its length runs along its back."""
    counts: dict[str, dict[str, tuple[int, int]]] = {}
    """For each room type there is, the pieces that it has: from the first to the second number of each."""
    companions: dict[str, dict[str, tuple[int, int]]] = {}
    """For each piece type with companions, how many it has; turned at a wall none, but for ``at_head``."""
    at_head: frozenset[str] = frozenset()
    """Piece types that have their companions when they are turned too: one, at the head."""
    at_wall: frozenset[str] = frozenset()
    """Piece types that never stand in the middle of a room: they touch a wall."""
    turns: frozenset[str] | None = None
    """Piece types that may stand with a side to a wall, their back to something else; None for all."""
    clear_front: frozenset[str] = frozenset()
    """Piece types that are used from their front: a passage in front of them is free, all along."""
    spans: dict[str, tuple[float, float]] = {}
    """Piece types that take a share of their wall: the least and the greatest."""
    shares: dict[str, tuple[float, float]] = {}
    """Piece types each of whose sides takes a share of the room's: the least and the greatest."""
    tops: dict[str, tuple[float, float]] = {}
    """Of each piece type: least and greatest area, square metres."""
    meet: frozenset[str] = frozenset()
    """Piece types of which one stands at a wall; at neighbouring walls they touch, none is opposite alone."""

    def suits(self, room: str, piece: str) -> bool:
        """Whether a room of this type may have such a piece, by itself or as a companion."""
        if room not in self.counts:
            return True
        tops = self.counts[room]
        return piece in tops or any(piece in self.companions.get(top, {}) for top in tops)


PROMISES = msgspec.json.decode(Path(__file__).with_suffix(".json").read_bytes(), type=dict[str, Promises])
"""Those of the shipped grammars. Other grammars promise nothing more."""


def size_violations(room: Room, side: str | None, names: list[str], promises: Promises) -> Iterator[str]:
    """Sizes out of their bounds: of a room, whose door is towards that side, and of its pieces.

    ``side`` is empty for a room of no star: then a piece without a front may lie either way.
    """
    along_x = side in {"north", "south"}
    if room.type in promises.rooms:
        width, depth = (room.width, room.height) if along_x else (room.height, room.width)
        yield from _out_of("the room", width, depth, promises.rooms[room.type])
    for piece, name in zip(room.pieces, names, strict=True):
        yield from _share_violations(room, piece, name, promises)
        sizes = promises.pieces.get(piece.type)
        if sizes is None:
            continue
        length, depth = (
            (piece.width, piece.height) if piece.orientation in {"N", "S"} else (piece.height, piece.width)
        )
        if not piece.orientation:  # It may lie either way.
            length, depth = (piece.width, piece.height) if along_x else (piece.height, piece.width)
            if side == "" and not list(_out_of(name, depth, length, sizes)):
                continue
        yield from _out_of(name, length, depth, sizes)
        if piece.type in promises.spans:
            wall = room.width if piece.orientation in {"N", "S"} else room.height
            least, most = promises.spans[piece.type]
            if not least * wall - TOLERANCE <= length <= most * wall + TOLERANCE:
                yield f"{name} takes {length / wall:.0%} of its wall ({least:.0%} to {most:.0%})"


def _share_violations(room: Room, piece: Piece, name: str, promises: Promises) -> Iterator[str]:
    if piece.type in promises.shares:
        least, most = promises.shares[piece.type]
        for own, whole in ((piece.width, room.width), (piece.height, room.height)):
            if not least * whole - TOLERANCE <= own <= most * whole + TOLERANCE:
                yield f"{name} takes {own / whole:.0%} of the room's side ({least:.0%} to {most:.0%})"
    if piece.type in promises.tops:
        least, most = promises.tops[piece.type]
        slack = TOLERANCE * (piece.width + piece.height)
        if not least - slack <= piece.area <= most + slack:
            yield f"{name} is of {piece.area:.3f} m² ({least:.3f} to {most:.3f})"


def _out_of(name: str, length: float, depth: float, sizes: Sizes) -> Iterator[str]:
    for value, least, most, what in ((length, *sizes[:2], "long"), (depth, *sizes[2:], "deep")):
        if not least - TOLERANCE <= value <= most + TOLERANCE:
            yield f"{name} is {value:.3f} m {what} ({least:.3f} to {most:.3f})"


def count_violations(room: Room, promises: Promises) -> Iterator[str]:
    """Pieces and companions out of their numbers."""
    yield from _counted("it", room.children, promises.counts.get(room.type, {}))
    for piece in room.children:
        wanted = promises.companions.get(piece.type, {})
        alone = piece.type in (promises.turns or ()) and piece.type not in promises.at_head
        if not (alone and is_turned(piece, room)):
            yield from _counted(f"its {piece.type}", piece.children, wanted)


def _counted(owner: str, pieces: tuple[Piece, ...], wanted: dict[str, tuple[int, int]]) -> Iterator[str]:
    found = Counter(piece.type for piece in pieces)
    for type_, (least, most) in wanted.items():
        if not least <= found[type_] <= most:
            yield f"{owner} has {found[type_]} {type_} ({least} to {most})"


def is_turned(piece: Piece, room: Room) -> bool:
    """Whether a piece stands at a wall with its side, its back not to a wall or to one that ends it."""
    walls = walls_touched(piece, room)
    side = [wall for wall in walls if piece.orientation and wall % 2 != BACK[piece.orientation] % 2]
    return bool(side)


def front_violations(room: Room, names: list[str], promises: Promises, passage: float) -> Iterator[str]:
    """What stands nearer than a passage (metres) in front of a piece that is used from there, or its wall."""
    named = list(zip(room.pieces, names, strict=True))
    for piece, name in named:
        if piece.type not in promises.clear_front or not piece.orientation:
            continue
        back, front = BACK[piece.orientation], (BACK[piece.orientation] + 2) % 4
        zone = list(piece.box)
        zone[back] = piece.box[front]
        zone[front] += passage if front > back else -passage
        ahead = zone[0], zone[1], zone[2], zone[3]
        others = ((other, what) for other, what in named if other not in (piece, *piece.children))
        for other, what in others:
            if overlap(ahead, other.box) > TOLERANCE:
                away = distance(piece.box, other.box)
                yield f"{name} has {what} {away:.2f} m in front of it (at least {passage:g})"
        beyond = excess(ahead, room.box)
        if beyond > TOLERANCE:
            yield f"{name} has a wall {passage - beyond:.2f} m in front of it (at least {passage:g})"


def arrangement_violations(room: Room, names: list[str], promises: Promises) -> Iterator[str]:
    """How pieces stand to each other: those that meet round corners, and turned ones with a free foot."""
    tops = [(piece, name) for piece, name in zip(room.pieces, names, strict=True) if piece in room.children]
    for type_ in promises.meet:
        walls: dict[int, Piece] = {}
        for piece, name in tops:
            if piece.type == type_ and piece.orientation:
                if BACK[piece.orientation] in walls:
                    yield f"{name} shares its wall with another {type_}"
                walls[BACK[piece.orientation]] = piece
        for wall, piece in walls.items():
            after = walls.get((wall + 1) % 4)
            if after is not None and distance(piece.box, after.box) > TOLERANCE:
                yield f"{type_}: those at neighbouring walls do not meet"
        if len(walls) == 2 and not any((wall + 1) % 4 in walls for wall in walls):
            yield f"{type_}: two stand at opposite walls, and none between them"
    for piece, name in tops:
        if piece.type in (promises.turns or ()) and is_turned(piece, room):
            front = (BACK[piece.orientation] + 2) % 4
            touched = walls_touched(piece, room)
            back = BACK[piece.orientation]
            others = [other for other in room.pieces if other is not piece and other not in piece.children]
            heads = piece.children if piece.type in promises.at_head else others
            if back not in touched and not any(_touch(piece, back, other) for other in heads):
                yield f"{name} has its head neither to a wall nor to another piece"
            if front in touched or any(_touch(piece, front, other) for other in others):
                yield f"{name} has something at its foot"


def _touch(piece: Piece, wall: int, other: Piece) -> bool:
    """Whether another piece touches this one's side towards a wall."""
    gap = other.box[(wall + 2) % 4] - piece.box[wall]
    across = 1 - wall % 2
    shared = min(piece.box[across + 2], other.box[across + 2]) - max(piece.box[across], other.box[across])
    return abs(gap) <= TOLERANCE and shared > TOLERANCE
