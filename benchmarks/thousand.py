"""A thousand houses of all sizes and grammars, on a grid too, each held to its promises.

``python benchmarks/thousand.py`` prints a line for each grammar and what is wrong; ends with 1 if so.
"""

import sys
import time
from collections.abc import Iterator

from logic import House, check, generate
from logic.grammar import shipped

SIZES = dict.fromkeys(range(1, 17), 19) | {32: 4, 64: 2, 128: 1}
CELLS = (0.0, 0.3)


def houses(grammar: str, cell: float) -> Iterator[House]:
    """Houses of every size; of those on a grid a fifth as many."""
    for rooms, count in SIZES.items():
        yield from generate(
            rooms=rooms,
            grammar=grammar,
            cell=cell,
            seed=rooms,
            count=-(-count // 5) if cell else count,
            workers=2,
        )


def main() -> int:
    """Make them, check them, count."""
    total = spoiled = 0
    for grammar in shipped():
        for cell in CELLS:
            began, made = time.monotonic(), 0
            for house in houses(grammar, cell):
                made += 1
                for violation in check(house):
                    spoiled += 1
                    print(f"{grammar}, {len(house.rooms)} rooms, house {made}: {violation}")
            total += made
            where = f"on a grid of {cell} m" if cell else "anywhere"
            print(
                f"{grammar}, {where}: {made} houses, {time.monotonic() - began:.0f} s with the check",
                flush=True,
            )
    print(f"{total} houses, {spoiled} violations")
    return 1 if spoiled else 0


if __name__ == "__main__":
    sys.exit(main())
