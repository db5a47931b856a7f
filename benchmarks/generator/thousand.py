"""``vitruvius bench thousand``: houses of all sizes and grammars, on a grid too, each checked."""

import time
from dataclasses import dataclass

from logic import LimitReached, RequestError, Unsatisfiable, check, generate
from logic.grammar import find, shipped

SIZES = dict.fromkeys(range(1, 17), 19) | {32: 4, 64: 2, 128: 1}
"""How many houses of each number of rooms; on a grid a fifth as many."""

PLANS = dict.fromkeys(range(4, 13), 40) | {16: 10, 32: 4, 64: 2}
"""The same where rooms share walls. Sizes of which a grammar has no house are proved and passed over."""


@dataclass(frozen=True)
class Thousand:
    """Make a thousand houses of all grammars and check each: a line for each grammar, violation and limit."""

    grammars: tuple[str, ...] = tuple(shipped())
    """Shipped grammars' names, or directories of rules."""

    cells: tuple[float, ...] = (0.0, 0.3)
    """Sides of a grid's cell in metres; 0 for none."""

    times: int = 1
    """How many times as many houses."""

    def run(self) -> int:
        """Make, check, count; 1 if there is a violation or a house that ends in a limit."""
        total = violations = limits = 0
        for grammar in self.grammars:
            plans = find(grammar).shares_walls
            for cell in self.cells if not plans else (0.0,):
                began, made = time.monotonic(), 0
                for rooms, count in (PLANS if plans else SIZES).items():
                    some = self.times * (-(-count // 5) if cell else count)
                    asked = {"grammar": grammar, "cell": cell, "seed": rooms, "count": some}
                    try:
                        for house in generate(rooms, **asked, workers=2):
                            made += 1
                            for violation in check(house):
                                violations += 1
                                print(f"{grammar}, {rooms} rooms, house {made}: {violation}")
                    except Unsatisfiable:
                        print(f"{grammar}: proved that there is none of {rooms} rooms", flush=True)
                    except RequestError as error:  # more than its topology has
                        print(error, flush=True)
                    except LimitReached as error:
                        limits += 1
                        print(f"{grammar}, {rooms} rooms, after {made} houses: {error}", flush=True)
                total += made
                where = f"on a grid of {cell} m" if cell else "anywhere"
                seconds = time.monotonic() - began
                print(f"{grammar}, {where}: {made} houses, {seconds:.0f} s with the check", flush=True)
        print(f"{total} houses, {violations} violations, {limits} sizes that ended in a limit")
        return 1 if violations or limits else 0
