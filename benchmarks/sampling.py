"""The sampling study: how evenly layouts are drawn, and what range of houses comes of it.

``python benchmarks/sampling.py`` writes docs/sampling.json and docs/expressive-range.png, in four minutes.
"""

import json
import sys
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from agent.progress import progress
from logic import House, count_layouts, generate
from logic.builder import Builder
from logic.files import write_whole
from logic.grammar import find

DOCS = Path(__file__).parents[1] / "docs"
DRAWS = {4: 222_000, 5: 100_000}
HOUSES = 1000


def entropy(counts: Iterable[int]) -> float:
    """Of a sample, in nats, corrected for its size (Miller 1955)."""
    counted = np.array([count for count in counts if count])
    shares = counted / counted.sum()
    return float(-(shares * np.log(shares)).sum() + (len(counted) - 1) / (2 * counted.sum()))


def layout_shares(builder: Builder, rooms: int, draws: int) -> dict[str, float]:
    """Entropy of drawn layouts as a share of the greatest: of the whole, and of its parts."""
    program = builder._housing(rooms, ())
    whole: Counter[str] = Counter()
    types: Counter[str] = Counter()
    divisions: Counter[tuple[str, ...]] = Counter()
    with progress(f"{rooms} rooms") as tell:
        for index in range(draws):
            atoms = program.draw(np.random.default_rng([rooms, index])) or []
            whole[" ".join(map(str, atoms))] += 1
            types[" ".join(str(a) for a in atoms if a.name == "room")] += 1
            divisions[tuple(str(a.arguments[1]) for a in atoms if a.name == "side")] += 1
            if index % 1000 == 0:
                tell(index / draws, "drawing layouts")
    layouts = count_layouts(rooms, grammar="family", seconds=30)[0][1]
    return {
        f"layouts of {rooms} rooms": layouts,
        f"draws of {rooms} rooms": draws,
        f"seen of {rooms} rooms": len(whole),
        f"entropy share of {rooms} rooms": entropy(whole.values()) / np.log(layouts),
        f"entropy share of the types of {rooms} rooms": entropy(types.values()) / np.log(len(types)),
        f"entropy share of the sides of {rooms} rooms": entropy(divisions.values()) / np.log(len(divisions)),
    }


def furnished(house: House) -> float:
    """The share of the rooms' floor that furniture covers."""
    return sum(p.area for r in house.rooms for p in r.pieces) / sum(r.area for r in house.rooms)


def compact(house: House) -> float:
    """The share of the outline's rectangle that the house covers."""
    boxes = np.array([house.floor.box, *(room.box for room in house.rooms)])
    west, north, east, south = *boxes[:, :2].min(axis=0), *boxes[:, 2:].max(axis=0)
    return (house.floor.area + sum(room.area for room in house.rooms)) / ((east - west) * (south - north))


def expressive_range(grammars: list[str]) -> dict[str, float]:
    """Two measures of many houses as a histogram (Smith and Whitehead 2010): its coverage and entropy."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.2 * len(grammars), 3.8), dpi=150, layout="constrained")
    found = {}
    for axes, grammar in zip(np.atleast_1d(figure.subplots(1, len(grammars))), grammars, strict=True):
        houses = list(generate(rooms=5, grammar=grammar, seed=11, count=HOUSES, workers=2))
        x, y = [compact(house) for house in houses], [furnished(house) for house in houses]
        cells, _, _ = np.histogram2d(x, y, bins=20, range=((0.3, 1.0), (0.0, 0.5)))
        found[f"cells of 400 in the range of {grammar}"] = int((cells > 0).sum())
        found[f"entropy share of the range of {grammar}"] = entropy(cells.ravel().astype(int)) / np.log(400)
        axes.hist2d(x, y, bins=20, range=((0.3, 1.0), (0.0, 0.5)), cmap="Blues")
        axes.set(
            title=f"{grammar}: {HOUSES} houses of 5 rooms",
            xlabel="compactness",
            ylabel="floor under furniture",
        )
    figure.savefig(DOCS / "expressive-range.png")
    return found


def main() -> None:
    """Run the study and write its figures."""
    builder = Builder(find("family"))
    figures: dict[str, float] = {}
    for rooms, draws in DRAWS.items():
        figures |= layout_shares(builder, rooms, draws // int(sys.argv[1]) if len(sys.argv) > 1 else draws)
    figures |= expressive_range(["family", "paper", "clinic"])
    write_whole(DOCS / "sampling.json", (json.dumps(figures, indent=2) + "\n").encode())
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
