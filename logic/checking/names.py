"""Names of rooms and pieces in the texts of the check."""

from collections import Counter

from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Room


def named(room: Room) -> str:
    """Return the name and type of a room."""
    return f"{room.name} ({room.type})"


def space_name(house: House, room: Room) -> str:
    """Return the name and type of a room, or ``the main room``."""
    return "the main room" if room is house.main_room else named(room)


def named_pieces(room: Room) -> list[tuple[Piece, str]]:
    """Return each piece with its type, numbered if the room has several pieces of the type."""
    total = Counter(piece.type for piece in room.pieces)
    seen: Counter[str] = Counter()
    found = []
    for piece in room.pieces:
        seen[piece.type] += 1
        name = f"{piece.type} {seen[piece.type]}" if total[piece.type] > 1 else piece.type
        found.append((piece, name))
    return found
