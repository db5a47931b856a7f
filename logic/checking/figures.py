"""Numbers in words: as many digits as tell a length apart from the bounds that it is beside."""

from collections.abc import Callable

MOST = 9
"""Decimals: what differs by less reads alike in every text."""

SAME = 1e-7
"""A value this near to a bound is on neither side of it."""


def number(value: float, digits: int = 0) -> str:
    """A bound as it was stated, with at least so many decimals."""
    whole, _, decimals = f"{value:.7f}".rstrip("0").partition(".")
    decimals = decimals.ljust(digits, "0")
    return f"{whole}.{decimals}" if decimals else whole


def figure(value: float, *bounds: float, digits: int = 2) -> str:
    """A value in the fewest decimals, from ``digits`` on, in which it is not zero, and is on the side of each
    bound, as ``number`` writes these, on which it is in fact.
    """
    if abs(value) < SAME:
        return "0"
    read = [float(number(bound)) for bound in bounds if abs(value - bound) > SAME]

    def holds(shown: float) -> bool:
        sides = ((shown < bound, shown > bound) == (value < bound, value > bound) for bound in read)
        return bool(shown) and all(sides)

    return apart(value, digits=digits, holds=holds)[0]


def percent(share: float, *bounds: float) -> str:
    """A share as ``figure`` writes it, in hundredths."""
    return f"{figure(100 * share, *(100 * bound for bound in bounds), digits=0)}%"


def apart(*values: float, holds: Callable[..., bool], digits: int = 2) -> list[str]:
    """Values in the fewest decimals, from ``digits`` on, in which something holds of what is read."""
    for decimals in range(digits, MOST + 1):
        texts = [f"{value:.{decimals}f}" for value in values]
        if holds(*map(float, texts)):
            return texts
    return [f"{value:.{digits}f}" for value in values]
