"""``vitruvius bench thousand``: houses of all sizes and grammars, on a grid too, each checked."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from logic import House, check, generate
from logic.grammar import find, shipped

SIZES = dict.fromkeys(range(1, 17), 19) | {32: 4, 64: 2, 128: 1}
"""How many houses of each number of rooms; on a grid a fifth as many."""

PLANS = dict.fromkeys(range(4, 13), 40)
"""The same where rooms share walls; such houses lie on no grid."""


@dataclass(frozen=True)
class Thousand:
    """Make a thousand houses of all grammars and check each: a line for each grammar and violation."""

    grammars: tuple[str, ...] = tuple(shipped())
    """Shipped grammars' names, or directories of rules."""

    cells: tuple[float, ...] = (0.0, 0.3)
    """Sides of a grid's cell in metres; 0 for none."""

    def run(self) -> int:
        """Make, check, count; 1 if there is a violation."""
        total = violations = 0
        for grammar in self.grammars:
            plans = find(grammar).shares_walls
            for cell in self.cells if not plans else (0.0,):
                began, made = time.monotonic(), 0
                for index, house in enumerate(houses(grammar, cell, PLANS if plans else SIZES)):
                    for violation in check(house):
                        violations += 1
                        print(f"{grammar}, {len(house.counted)} rooms, house {index}: {violation}")
                    made = index + 1
                total += made
                where = f"on a grid of {cell} m" if cell else "anywhere"
                seconds = time.monotonic() - began
                print(f"{grammar}, {where}: {made} houses, {seconds:.0f} s with the check", flush=True)
        print(f"{total} houses, {violations} violations")
        return 1 if violations else 0


def houses(grammar: str, cell: float, sizes: Mapping[int, int]) -> Iterator[House]:
    """Houses of every size."""
    for rooms, count in sizes.items():
        some = -(-count // 5) if cell else count
        yield from generate(rooms=rooms, grammar=grammar, cell=cell, seed=rooms, count=some, workers=2)
