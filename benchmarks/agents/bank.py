"""Make the benchmark bank: ``python -m benchmarks.agents.bank``, once; it never replaces one that is there.

Half a minute on two cores. The same solver versions (``requirements.lock``) give the same houses.
"""

import sys
from argparse import ArgumentParser

from agent.banks import NAME, TEST, bank_hash, geometry_hash
from benchmarks.common.houses import in_turns
from benchmarks.common.pages import ROOT
from logic import check, save

HOUSES, ROOMS = 256, range(2, 7)
OUT = ROOT / "benchmarks" / "houses" / NAME


def main() -> int:
    """Make the bank, check it, save it; 1 where it is there already."""
    if OUT.exists():
        print(f"{OUT}: is frozen. A new bank needs a new name: agent/banks.py", file=sys.stderr)
        return 1
    houses = in_turns(ROOMS, HOUSES, grammar="family", seed=TEST.start)
    for number, house in enumerate(houses):
        if faults := check(house):
            raise ValueError(f"house {number}: {faults[0]}")
    if len(set(map(geometry_hash, houses))) < len(houses):
        raise ValueError("the same house twice")
    save(houses, OUT)
    print(f"{OUT}: {len(houses)} houses, {bank_hash(houses)}")
    return 0


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    sys.exit(main())
