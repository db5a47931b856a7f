"""Check of even rows of furniture, by the places of the pieces."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise, product

from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.house.promises import Promises


def uneven_rows(_: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a line for a room whose rows must be even, but are even by none of the pieces' edges."""
    kinds = promises.even_rows.get(room.type, ())
    boxes = [_with_companions(piece) for piece in room.children if piece.type in kinds]
    if not any(_are_even(boxes, x, y) for x, y in product((0, 2), (1, 3))):
        yield "has uneven rows (must have as many pieces in each, in line, at equal distances)"


def _with_companions(piece: Piece) -> Box:
    """Return the box around a piece and its companions."""
    boxes = [each.box for each in (piece, *piece.children)]
    wests, norths, easts, souths = zip(*boxes, strict=True)
    return min(wests), min(norths), max(easts), max(souths)


def _are_even(boxes: Sequence[Box], x: int, y: int) -> bool:
    """Return True if these edges of the boxes form a grid, or one row along x or along y."""
    xs, ys = _distinct(box[x] for box in boxes), _distinct(box[y] for box in boxes)
    if len(xs) * len(ys) == len(boxes):
        return _has_equal_steps(xs) and _has_equal_steps(ys)
    return any(len(each) == len(boxes) and _has_equal_steps(each) for each in (xs, ys))


def _distinct(places: Iterable[float]) -> list[float]:
    """Return the places in order, with places within the tolerance of each other merged."""
    ordered = sorted(places)
    return [*ordered[:1], *(after for before, after in pairwise(ordered) if after - before > TOLERANCE)]


def _has_equal_steps(places: Sequence[float]) -> bool:
    steps = [after - before for before, after in pairwise(places)]
    return not steps or max(steps) - min(steps) <= 2 * TOLERANCE
