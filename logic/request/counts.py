"""Counts and ranges in requests: how many rooms of a type, how many pieces."""

import operator
from collections.abc import Iterable, Mapping
from typing import Any

from vitruvius.logic.errors import RequestError
from vitruvius.logic.plain import plain
from vitruvius.logic.spelling import unknown

Range = tuple[int, int | None]
"""Least and greatest number; None for no bound."""

Count = int | tuple[int, int | None]
"""Exact number, or a range."""

MOST_ROOMS = 128
MAX_COUNT = 2**31 - 1
"""Largest number of clingo, which stands for no bound."""


def whole(name: str, value: Any, least: int, most: int = MAX_COUNT) -> int:
    """Return a whole number of any library as an ``int``.

    Raises ``RequestError`` for another value, and for a number outside ``least`` to ``most``.
    """
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise RequestError(f"{name} must be a whole number, {least} or more, not {value!r}") from None
    if not least <= number <= most:
        bounds = f"a whole number, {least} or more" if number < least else f"at most {most}"
        raise RequestError(f"{name} must be {bounds}, not {number}")
    return number


def real(name: str, value: Any) -> float:
    """Return a number of any library as Python's ``float``. Raises ``RequestError`` for another value."""
    number = plain(value)
    try:
        if isinstance(number, bool | str):
            raise TypeError
        return float(number)
    except (TypeError, OverflowError):
        raise RequestError(f"{name} must be a number, not {value!r}") from None


def as_range(name: str, count: Any) -> Range:
    """Return a count as a range. Raises ``RequestError`` for an invalid count."""
    count = plain(count)
    least, most = (count, count) if isinstance(count, int) else (*count,) if _is_pair(count) else (None, None)
    if type(least) is not int or not (most is None or type(most) is int):
        raise RequestError(f"{name}: a count is a whole number or a pair of them, not {count!r}")
    if not 0 <= least <= (MAX_COUNT if most is None else most) <= MAX_COUNT:
        raise RequestError(f"{name}: give two whole numbers from 0, the smaller first, not {count!r}")
    return least, most


def ranges_of(noun: str, counts: Mapping[str, Any] | None) -> dict[str, Range]:
    """Return counts as ranges. Raises ``RequestError`` for an invalid count, and for counts without names."""
    counts = {} if counts is None else counts
    if not isinstance(counts, Mapping):
        raise RequestError(f"{noun} counts: give them by name, not as {counts!r}")
    return {name: as_range(f"{noun} {name}", count) for name, count in counts.items()}


def range_of(rooms: Any) -> tuple[int, int | None]:
    """Return the least and the greatest number of rooms, or None instead of an equal one.

    Raises ``RequestError`` for numbers that no house has.
    """
    least, most = rooms if _is_pair(rooms) else (rooms, rooms)
    least, most = whole("rooms", least, 1, MOST_ROOMS), whole("rooms", most, 1, MOST_ROOMS)
    if most < least:
        raise RequestError(f"rooms: {least} to {most}: the smaller number comes first")
    return least, None if most == least else most


def in_words(wanted: Range) -> str:
    """Return a range in words, as in ``2``, ``1 to 3``, ``2 or more``."""
    least, most = wanted
    return f"{least}" if most == least else f"{least} or more" if most is None else f"{least} to {most}"


def as_option(wanted: Range) -> str:
    """Return a range as on the command line: ``2``, ``1..3``, ``2..``."""
    least, most = wanted
    return f"{least}" if most == least else f"{least}..{'' if most is None else most}"


def from_option(text: str) -> Count:
    """Return the count in a text of ``as_option``, or in ``..3``. Raises ``ValueError`` for another text."""
    if ".." not in text:
        return int(text)
    least, _, most = text.partition("..")
    return int(least or 0), int(most) if most else None


def known(what: str, name: str, names: Iterable[str]) -> None:
    """Raise ``RequestError`` for a name that is not one of these."""
    names = sorted(names)
    if name not in names:
        raise RequestError(unknown(what, name, names))


def _is_pair(count: Any) -> bool:
    return isinstance(count, tuple | list) and len(count) == 2


def counts(ranges: Mapping[str, Range]) -> dict[str, Any]:
    """Return ranges in their JSON form: an exact number as a number, any other range as a list."""
    return {name: least if least == most else [least, most] for name, (least, most) in ranges.items()}
