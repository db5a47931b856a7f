"""The section of houses: their plans, which a reader filters by file, grammar, rooms, types and furniture."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from agent.report.page import Section, data
from logic import House, load
from logic.draw import plan_svg

MOST = 1000
"""Plans in a report; of more houses, some of each file, evenly."""

WIDTH = 300
"""CSS pixels of a plan."""


def holds_houses(path: Path) -> bool:
    """Whether a file of JSON Lines is of houses: others, such as metrics, have other fields."""
    import gzip

    try:
        with gzip.open(path) if path.suffix == ".gz" else path.open("rb") as file:
            first = msgspec.json.decode(file.readline(1 << 25))
    except (OSError, EOFError, msgspec.DecodeError):
        return False
    return isinstance(first, dict) and ("rooms" in first or "roomNumber" in first)


def section(files: Sequence[Path], folder: Path) -> Section | None:
    """Of these house files. Raises ``HouseFileError`` for one that is damaged."""
    banks = {str(path.relative_to(folder)): load(path) for path in files if holds_houses(path)}
    if not banks:
        return None
    whole = sum(map(len, banks.values()))
    every = -(-whole // MOST)
    plans = [
        plan_of(file, index, houses[index])
        for file, houses in banks.items()
        for index in range(0, len(houses), every)
    ]
    left_out = f" Of each file every {every}th house is shown." if every > 1 else ""
    words = f"<p>{whole:,} houses in {len(banks)} file{'s' * (len(banks) > 1)}.{left_out}</p>"
    return Section("plans", "The houses", f'{words}<div class="plans"></div>\n{data("plans-data", plans)}')


def plan_of(file: str, index: int, house: House) -> dict[str, Any]:
    """A plan, and what it is filtered by."""
    provenance = house.provenance
    return {
        "file": file,
        "index": index,
        "grammar": Path(provenance.grammar).name if provenance else "not noted",
        "rooms": len(house.counted),
        "area": round(sum(room.area for room in house.rooms), 1),
        "types": Counter(room.type for room in house.counted),
        "pieces": Counter(piece.type for room in house.rooms for piece in room.pieces),
        "svg": plan_svg(house, WIDTH),
    }
