"""Plans in plain geometry, apart from the rules: what rooms share walls, by their boxes alone."""

from itertools import combinations

TOLERANCE = 1e-6

Box = tuple[float, float, float, float]
"""West, north, east, south, metres."""


def shared(one: Box, other: Box) -> float:
    """How much of a wall two rooms share, metres: 0 where they lie apart or meet in a corner."""
    found = 0.0
    for across in (0, 1):
        along = 1 - across
        gap = max(one[across], other[across]) - min(one[across + 2], other[across + 2])
        if abs(gap) <= TOLERANCE:
            found = max(found, min(one[along + 2], other[along + 2]) - max(one[along], other[along]))
    return found if found > TOLERANCE else 0.0


def neighbours(boxes: list[Box]) -> dict[tuple[int, int], float]:
    """How much of a wall the rooms share that share one, both ways."""
    found = {(r, q): shared(boxes[r], boxes[q]) for r, q in combinations(range(len(boxes)), 2)}
    return {pair: length for (r, q), length in found.items() if length for pair in ((r, q), (q, r))}
