"""Checks of a room by its promises: places, sizes and counts of pieces, their fronts and arrangement.

Each check yields texts without the name of the room.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import combinations

from vitruvius.logic.checking.doors import near_doors
from vitruvius.logic.checking.figures import figure, number, percent
from vitruvius.logic.checking.names import named_pieces
from vitruvius.logic.checking.walk import free_floor
from vitruvius.logic.house.boxes import BACK, TOLERANCE, WALLS, distance, excess, overlap, walls_touched
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.house.promises import Promises, Relation, Sizes


def unfurnished(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for a room without furniture that may not be empty."""
    if not room.pieces and room.type not in promises.empty:
        yield "has no furniture"


def misplaced(house: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each piece that does not suit the room or stands in a wrong place.

    Wrong places are outside the room, too near to a door, and, for some types, away from the walls.
    """
    for piece, name in named_pieces(room):
        if not promises.suits(room.type, piece.type):
            yield f"{name} does not suit the room"
        juts = excess(piece.box, room.box)
        if juts > TOLERANCE:
            yield f"{name} juts {figure(juts)} m out of the room"
        yield from (f"{name} {near}" for near in near_doors(house, room, piece, promises))
        if piece.type in promises.at_wall and not walls_touched(piece, room):
            yield f"{name} stands in the middle of the room (must touch a wall)"


def overlapping(_: House, room: Room, __: Promises) -> Iterator[str]:
    """Yield a text for each two pieces that overlap."""
    for (one, a), (other, b) in combinations(named_pieces(room), 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield f"{a} overlaps {b} by {figure(depth)} m"


def wrong_fronts(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each piece at a wall that faces the wrong way.

    The piece's back must be to the wall, or also a side if pieces of its type may turn.
    """
    for piece, name in named_pieces(room):
        if piece.orientation not in {"", *BACK}:
            yield f"{name} faces {piece.orientation!r} (must be N, E, S, W or empty)"
        elif piece.orientation and piece in room.children:
            walls = walls_touched(piece, room)
            back = BACK[piece.orientation]
            sides = (
                {back, (back + 1) % 4, (back + 3) % 4}
                if promises.turns is None or piece.type in promises.turns
                else {back}
            )
            if walls and not sides & set(walls):
                at = " and ".join(WALLS[wall] for wall in walls)
                yield f"{name} faces {piece.orientation}, not away from its wall ({at})"


def no_turning(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for a room that lacks its promised free square."""
    side = promises.turning.get(room.type, 0.0)
    if side and free_floor(room).buffer(TOLERANCE - side / 2, join_style="mitre").is_empty:
        yield f"has no free square of {number(side)} m"


def wrong_sizes(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each size of a piece out of its bounds. A piece without a front may lie either way."""
    return sizes_of_pieces(room, promises, None)


def sizes_of_pieces(room: Room, promises: Promises, along_x: bool | None) -> Iterator[str]:
    """Yield a text for each size of a piece out of its bounds.

    A piece without a front lies along x if ``along_x`` is True, along y if False, and either way if None.
    """
    for piece, name in named_pieces(room):
        yield from _share_violations(room, piece, name, promises)
        bounds = promises.piece_size.get(piece.type), promises.piece_relations.get(piece.type, ())
        lies_along_x = piece.orientation in {"N", "S"} if piece.orientation else along_x
        sides = piece.width, piece.height
        length, depth = sides if lies_along_x else sides[::-1]
        if lies_along_x is None and not list(out_of(name, depth, length, *bounds)):
            continue
        yield from out_of(name, length, depth, *bounds)
        if piece.type in promises.spans:
            wall = room.width if piece.orientation in {"N", "S"} else room.height
            least, most = promises.spans[piece.type]
            if not least * wall - TOLERANCE <= length <= most * wall + TOLERANCE:
                taken = percent(length / wall, least, most)
                yield f"{name} takes {taken} of its wall ({percent(least)} to {percent(most)})"


def _share_violations(room: Room, piece: Piece, name: str, promises: Promises) -> Iterator[str]:
    if piece.type in promises.shares:
        least, most = promises.shares[piece.type]
        for own, whole in ((piece.width, room.width), (piece.height, room.height)):
            if not least * whole - TOLERANCE <= own <= most * whole + TOLERANCE:
                taken = percent(own / whole, least, most)
                yield f"{name} takes {taken} of the room's side ({percent(least)} to {percent(most)})"
    if piece.type in promises.tops:
        least, most = promises.tops[piece.type]
        slack = TOLERANCE * (piece.width + piece.height)
        if not least - slack <= piece.area <= most + slack:
            yield f"{name} is of {_beside(piece.area, least, most, 'm²')}"


def out_of(
    name: str, length: float, depth: float, sizes: Sizes | None, relations: Iterable[Relation] = ()
) -> Iterator[str]:
    """Yield a line for each length out of its bounds, and for each relation of both that does not hold."""
    if sizes:
        for value, least, most, what in ((length, *sizes[:2], "long"), (depth, *sizes[2:], "deep")):
            if not least - TOLERANCE <= value <= most + TOLERANCE:
                yield f"{name} is {_beside(value, least, most, f'm {what}')}"
    for a, b, c in relations:
        if a * length + b * depth > c + TOLERANCE * (abs(a) + abs(b)):
            yield f"{name} is {length:.3f} m long and {depth:.3f} m deep (must be: {_in_words(a, b, c)})"


def _in_words(a: float, b: float, c: float) -> str:
    """Return a relation as text without negative factors, as in ``length + 0.33 <= depth``."""
    terms = [(a, "length"), (b, "depth"), (-c, "")]
    sides = [
        " + ".join(
            " ".join(filter(None, (number(abs(factor)) if abs(factor) != 1 or not name else "", name)))
            for factor, name in terms
            if sign * factor > 0
        )
        for sign in (1, -1)
    ]
    return " <= ".join(side or "0" for side in sides)


def _beside(value: float, least: float, most: float, unit: str) -> str:
    """Return a value that is out of its bounds, and the bounds, as text."""
    return f"{figure(value, least, most, digits=3)} {unit} ({number(least, 3)} to {number(most, 3)})"


def wrong_counts(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each type with a wrong number of pieces or companions."""
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
    """Return True if a side of a piece, neither its back nor its front, touches a wall."""
    walls = walls_touched(piece, room)
    side = [wall for wall in walls if piece.orientation and wall % 2 != BACK[piece.orientation] % 2]
    return bool(side)


def blocked_fronts(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each piece whose front is too near to another piece or to a wall."""
    passage = promises.passage if promises.front is None else promises.front
    named = named_pieces(room)
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
                away = figure(distance(piece.box, other.box), passage)
                yield f"{name} has {what} {away} m in front of it (at least {number(passage)})"
        beyond = excess(ahead, room.box)
        if beyond > TOLERANCE:
            away = figure(passage - beyond, passage)
            yield f"{name} has a wall {away} m in front of it (at least {number(passage)})"


def wrong_arrangement(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each wrong arrangement of pieces.

    Pieces that meet round corners must do so, and turned pieces must have a free foot.
    """
    tops = [(piece, name) for piece, name in named_pieces(room) if piece in room.children]
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
        if piece.type in promises.free_foot and is_turned(piece, room):
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
    """Return True if another piece touches this piece's side towards a wall."""
    gap = other.box[(wall + 2) % 4] - piece.box[wall]
    across = 1 - wall % 2
    shared = min(piece.box[across + 2], other.box[across + 2]) - max(piece.box[across], other.box[across])
    return abs(gap) <= TOLERANCE and shared > TOLERANCE
