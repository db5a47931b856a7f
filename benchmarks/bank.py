"""Make the benchmark bank: `.venv/bin/python benchmarks/bank.py`, once; it never replaces one that is there.

Half a minute on two cores. The same solver versions (`requirements.lock`) give the same houses.
"""

import sys
from itertools import zip_longest
from pathlib import Path

from agent.banks import NAME, TEST, bank_hash, geometry_hash
from logic import House, check, generate, save

HOUSES, ROOMS = 256, range(2, 7)
OUT = Path(__file__).parent / "houses" / NAME


def made(count: int = HOUSES) -> list[House]:
    """House i has 2 + i % 5 rooms, so every part of the bank has houses of all sizes."""
    counts = [len(range(place, count, len(ROOMS))) for place in range(len(ROOMS))]
    series = [
        list(generate(rooms, grammar="family", seed=TEST.start, count=number, workers=2)) if number else []
        for rooms, number in zip(ROOMS, counts, strict=True)
    ]
    return [house for row in zip_longest(*series) for house in row if house is not None]


def main() -> int:
    if OUT.exists():
        print(f"{OUT}: is frozen. A new bank needs a new name: agent/banks.py", file=sys.stderr)
        return 1
    houses = made()
    for number, house in enumerate(houses):
        if faults := check(house):
            raise ValueError(f"house {number}: {faults[0]}")
    if len(set(map(geometry_hash, houses))) < len(houses):
        raise ValueError("the same house twice")
    save(houses, OUT)
    print(f"{OUT}: {len(houses)} houses, {bank_hash(houses)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
