"""Make a frozen bank once: ``python -m benchmarks.agents.bank NAME``. The command never replaces a bank.

It takes half a minute on two cores. The same solver versions (``requirements.lock``) give the same houses.
"""

import sys
from argparse import ArgumentParser

from benchmarks.common.houses import in_turns
from vitruvius.agent.banks import BANKS, bank_hash, benchmark_path, geometry_hash
from vitruvius.logic import check, save
from vitruvius.logic.dataset.splits import TEST

HOUSES = 256


def main(name: str) -> int:
    """Make the bank, check it and save it. Return 1 if the bank exists already."""
    bank, out = BANKS[name], benchmark_path(name)
    if out.exists():
        print(f"{out}: is frozen. A new bank needs a new name: agent/banks.py", file=sys.stderr)
        return 1
    houses = in_turns(bank.rooms, HOUSES, grammar=bank.grammar, seed=TEST.start)
    for number, house in enumerate(houses):
        if faults := check(house):
            raise ValueError(f"house {number}: {faults[0]}")
    if len(set(map(geometry_hash, houses))) < len(houses):
        raise ValueError("the same house twice")
    save(houses, out)
    print(f"{out}: {len(houses)} houses, {bank_hash(houses)}")
    return 0


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=BANKS)
    sys.exit(main(parser.parse_args().name))
