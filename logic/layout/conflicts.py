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
    """Return statements that are impossible together, and possible with any one of them left out."""
    needed = core(statements)
    # Rules are left out more readily than the facts above them, which they may replace.
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
