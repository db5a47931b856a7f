"""What the check calls the rooms and the pieces of a house."""

from collections import Counter

from logic.house.house import House
from logic.house.parts import Piece, Room


def named(room: Room) -> str:
    """A room by its name and type."""
    return f"{room.name} ({room.type})"


def space_name(house: House, room: Room) -> str:
    """The same, but for a main room."""
    return "the main room" if room is house.main_room else named(room)


def named_pieces(room: Room) -> list[tuple[Piece, str]]:
    """Each piece with its type, numbered where a room has several of it."""
    total = Counter(piece.type for piece in room.pieces)
    seen: Counter[str] = Counter()
    found = []
    for piece in room.pieces:
        seen[piece.type] += 1
        name = f"{piece.type} {seen[piece.type]}" if total[piece.type] > 1 else piece.type
        found.append((piece, name))
    return found
