"""Minimal conflicts: as few as possible of some statements, of whatever kind, that are impossible together.

``possible`` says whether some of them are, ``core`` gives some of impossible ones that are so by themselves.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

T = TypeVar("T")


def minimal(
    statements: Sequence[T],
    possible: Callable[[Sequence[T]], bool],
    core: Callable[[Sequence[T]], list[T]],
) -> list[T]:
    """Ts that are impossible together, and possible with any one of them left out."""
    needed = core(statements)
    # A rule is more readily left out than the facts above it, which it may stand in for.
    for statement in reversed(list(needed)):
        if statement in needed:
            fewer = [other for other in needed if other is not statement]
            if not possible(fewer):
                needed = core(fewer)
    return needed


def preferred(
    statements: Sequence[T],
    possible: Callable[[Sequence[T]], bool],
    core: Callable[[Sequence[T]], list[T]],
) -> list[T]:
    """The same, of the first statements wherever these do: few steps where many are impossible by a few.

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
