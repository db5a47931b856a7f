"""Minimal unsatisfiable cores: minimal sets of statements, of any kind, that are impossible together.

``possible`` returns True if some statements are possible together. ``core`` returns some of impossible
statements that suffice for a contradiction.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

T = TypeVar("T")


def minimal(
    statements: Sequence[T],
    possible: Callable[[Sequence[T]], bool],
    core: Callable[[Sequence[T]], list[T]],
) -> list[T]:
    """Return Ts that are impossible together, and possible with any one of them left out.

    Leave out one after the other, the last one first, since a rule is more readily left out than the facts
    above it, which it may stand in for. After each success leave out twice as many at once.
    """
    needed = core(statements)
    untried, number = needed[::-1], 1
    while untried:
        out = set(map(id, untried[:number]))
        fewer = [each for each in needed if id(each) not in out]
        if possible(fewer):
            untried = untried[number == 1 :]
            number = 1
        else:
            needed = core(fewer)
            kept = set(map(id, needed))
            untried = [each for each in untried if id(each) in kept]
            number *= 2
    return needed


def preferred(
    statements: Sequence[T],
    possible: Callable[[Sequence[T]], bool],
    core: Callable[[Sequence[T]], list[T]],
) -> list[T]:
    """Return a minimal core that prefers the first statements, in few steps if a few statements conflict.

    QuickXplain: Junker, AAAI 2004.
    """

    def needed(before: list[T], new: bool, some: list[T]) -> list[T]:
        if new and not possible(before):
            return []
        if len(some) == 1:
            return some
        first, then = some[: len(some) // 2], some[len(some) // 2 :]
        last = needed([*before, *first], True, then)
        return needed([*before, *last], bool(last), first) + last

    return needed([], False, core(statements))
