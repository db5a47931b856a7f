"""Section of houses: plans that a reader filters by file, grammar, rooms, types and furniture."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vitruvius.agent.banks import BANKS, bank_hash, benchmark
from vitruvius.agent.evaluation import scores
from vitruvius.agent.evaluation.result import yardstick
from vitruvius.agent.evaluation.tables import LABELS
from vitruvius.agent.report.html import Section, data
from vitruvius.logic import House, load
from vitruvius.logic.drawing.draw import plan_svg
from vitruvius.logic.files.house_files import MOST_BYTES, MOST_LINE
from vitruvius.logic.looks.looks import looks_of
from vitruvius.logic.opener import DAMAGED, from_json, opened
from vitruvius.logic.spelling import numbered
from vitruvius.sim.tasks.words import in_words

MAX_PLANS = 1000
"""Largest number of plans in a report. If there are more houses, the plans are spread evenly over each
file."""

WIDTH = 300
"""Width of a plan, in CSS pixels."""


def holds_houses(path: Path) -> bool:
    """Return True if a JSON Lines file holds houses: other files, such as metrics, have other fields."""
    try:
        with opened(path, MOST_BYTES) as file:
            first = from_json(file.readline(MOST_LINE))
    except (*DAMAGED, ValueError):
        return False
    return isinstance(first, dict) and ("rooms" in first or "roomNumber" in first)


def section(files: Sequence[Path], folder: Path) -> Section | None:
    """Return the section of house files, and of the benchmark's banks in ``evaluation.json`` files.

    Each plan has the ratio of each policy in its house. Raises ``HouseFileError`` for a damaged file.
    """
    measured = [scores.load(path) for path in files if path.name == "evaluation.json"]
    banks = {str(path.relative_to(folder)): load(path) for path in files if holds_houses(path)}
    banks |= {each.bank.file: benchmark(each.bank.file) for each in measured if each.bank.file in BANKS}
    if not banks:
        return None
    whole = sum(map(len, banks.values()))
    every = -(-whole // MAX_PLANS)
    plans = []
    for file, houses in banks.items():
        hash_ = bank_hash(houses) if measured else ""
        ratios = [_ratios(each, houses) for each in measured if each.bank.hash == hash_]
        for index in range(0, len(houses), every):
            found = {key: values[index] for one in ratios for key, values in one.items()}
            plans.append(plan_of(file, index, houses[index]) | {"ratios": found})
    left_out = f" Of each file every {every}th house is shown." if every > 1 else ""
    words = f"<p>{numbered(whole, 'house')} in {numbered(len(banks), 'file')}.{left_out}</p>"
    return Section("plans", "Houses", f'{words}<div class="plans"></div>\n{data("plans-data", plans)}')


def _ratios(file: scores.ScoreFile, bank: Sequence[House]) -> dict[str, list[float | None]]:
    """Return the ratio to the yardstick's targets in each house, by policy and mode.

    The ratio is over all runs and episodes, and None in a house in which the yardstick has no targets.
    """
    found, houses, named = {}, len(bank), looks_of(bank[0]).name
    for mode, scored in file.targets.items():
        best = yardstick(scored.policies)
        whole = [_is_whole(each, houses) for each in scored.policies.values()]
        if best not in scored.policies or not all(whole):
            continue  # scores of another program, which need not be whole
        # episode i is in house i % houses
        counts = {
            policy: np.array([run.targets for run in each.runs]).reshape(len(each.runs), -1, houses)
            for policy, each in scored.policies.items()
        }
        oracle = counts.pop(best).mean(axis=(0, 1))
        for policy, each in counts.items():
            ratio = each.mean(axis=(0, 1)) / np.where(oracle > 0, oracle, np.nan)
            found[f"{LABELS.get(policy, policy)}, {in_words(mode, named)}"] = [
                None if np.isnan(value) else round(float(value), 3) for value in ratio
            ]
    return found


def _is_whole(policy: scores.PolicyScores, houses: int) -> bool:
    """Return True if all runs of a policy have the same number of episodes in each house."""
    lengths = {len(run.targets) for run in policy.runs}
    return len(lengths) == 1 and max(lengths) > 0 and not max(lengths) % houses


def plan_of(file: str, index: int, house: House) -> dict[str, Any]:
    """Return a plan, and the values by which it is filtered."""
    provenance, named = house.provenance, looks_of(house).name
    return {
        "file": file,
        "index": index,
        "grammar": Path(provenance.grammar).name if provenance else "not noted",
        "rooms": len(house.counted),
        "area": round(sum(room.area for room in house.rooms), 1),
        "types": Counter(room.type for room in house.counted),
        "pieces": Counter(named(piece.type) for room in house.rooms for piece in room.pieces),
        "svg": plan_svg(house, WIDTH),
    }
