"""Numbers as text, with enough digits to tell a length apart from the bounds in the same sentence."""

from collections.abc import Callable

MAX_DECIMALS = 9
"""Largest number of decimals. Values that differ by less look alike in every text."""

SAME_M = 1e-7
"""Distance from a bound within which a value is on neither side of it."""


def number(value: float, digits: int = 0) -> str:
    """Return a bound as it was stated, with at least ``digits`` decimals."""
    whole, _, decimals = f"{value:.7f}".rstrip("0").partition(".")
    decimals = decimals.ljust(digits, "0")
    return f"{whole}.{decimals}" if decimals else whole


def figure(value: float, *bounds: float, digits: int = 2) -> str:
    """Return a value with the fewest decimals, at least ``digits``, that show it correctly.

    The text is not zero, and lies on the true side of each bound, as ``number`` writes the bounds.
    """
    if abs(value) < SAME_M:
        return "0"
    read = [float(number(bound)) for bound in bounds if abs(value - bound) > SAME_M]

    def holds(shown: float) -> bool:
        sides = ((shown < bound, shown > bound) == (value < bound, value > bound) for bound in read)
        return bool(shown) and all(sides)

    return apart(value, digits=digits, holds=holds)[0]


def percent(share: float, *bounds: float) -> str:
    """Return a fraction in percent, as ``figure`` writes it."""
    return f"{figure(100 * share, *(100 * bound for bound in bounds), digits=0)}%"


def apart(*values: float, holds: Callable[..., bool], digits: int = 2) -> list[str]:
    """Return values with the fewest decimals, at least ``digits``, whose texts satisfy ``holds``."""
    for decimals in range(digits, MAX_DECIMALS + 1):
        texts = [f"{value:.{decimals}f}" for value in values]
        if holds(*map(float, texts)):
            return texts
    return [f"{value:.{digits}f}" for value in values]
