"""Fifty homes of four to eight rooms in other programs' formats: read, then furnished, moved or refuted.

Run it by ``./run python -m tests.logic.readers.fifty``, which takes about three minutes.
"""

import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

from tests.logic.readers.written import WRITERS
from vitruvius.logic import Unsatisfiable, check, generate, nearest_plan


def main() -> None:
    """Print the outcome of each plan, and the number of each outcome."""
    warnings.simplefilter("ignore")
    homes = [home for rooms in range(4, 9) for home in generate(rooms, grammar="home", seed=rooms, count=10)]
    counts = Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        for number, home in enumerate(homes):
            format_ = list(WRITERS)[number % len(WRITERS)]
            file = Path(folder) / "plan"
            file.write_bytes(WRITERS[format_](home, np.random.default_rng(number), 0.01))
            outcome, said = outcome_of(file)
            counts[outcome] += 1
            print(number, format_, outcome, said, flush=True)
    print(dict(counts))


def outcome_of(file: Path) -> tuple[str, str]:
    """Return the outcome of a plan, furnished, moved or refuted, and the changes or the proof."""
    try:
        found = nearest_plan(file, grammar="home")
        house = next(generate(plan=found.plan, grammar="home"))
    except Unsatisfiable as proof:
        return "refuted", str(proof)
    assert check(house) == []
    return ("moved", "; ".join(found.changes)) if found.proof else ("furnished", "")


if __name__ == "__main__":
    main()
