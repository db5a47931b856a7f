"""Plans in plain geometry, independent of the rules: the rooms that share walls, by their boxes alone."""

from itertools import combinations

TOLERANCE = 1e-6

Box = tuple[float, float, float, float]
"""West, north, east, south, metres."""


def shared(one: Box, other: Box) -> float:
    """Return the length of the wall that two rooms share, metres.

    The length is 0 if they are apart or meet in a corner.
    """
    found = 0.0
    for across in (0, 1):
        along = 1 - across
        gap = max(one[across], other[across]) - min(one[across + 2], other[across + 2])
        if abs(gap) <= TOLERANCE:
            found = max(found, min(one[along + 2], other[along + 2]) - max(one[along], other[along]))
    return found if found > TOLERANCE else 0.0


def neighbours(boxes: list[Box]) -> dict[tuple[int, int], float]:
    """Return the lengths of the walls that pairs of rooms share, both ways."""
    found = {(r, q): shared(boxes[r], boxes[q]) for r, q in combinations(range(len(boxes)), 2)}
    return {pair: length for (r, q), length in found.items() if length for pair in ((r, q), (q, r))}
