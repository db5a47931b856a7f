"""``vitruvius bench sampling``: uniformity of sampled layouts and lengths, and the range of houses.

The study takes a quarter of an hour on two cores; ``--fast``, a minute, which only tests that it runs.
"""

import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from time import monotonic
from typing import Any

import msgspec
import numpy as np

from benchmarks.common.pages import machine, png, table_rows, versions, write
from benchmarks.generator.laws import Law, laws
from benchmarks.generator.layouts import Spread, entropy, spread
from vitruvius.logic import House, generate
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find

GRAMMARS = ("family", "paper")
"""Grammars of stars, whose rules make the outline of a plan full."""
SAMPLES: dict[int | str, int] = {
    5: 2_184_000,
    4: 222_000,
    "bathroom": 140_000,
    "kitchen": 120_000,
    "bedroom": 50_000,
    "hall": 50_000,
}
"""Number of samples of each subject, the slowest first: at least fifty for each layout, if layouts can be
listed."""
TRIES = 150_000
GAPS = 20_000
HOUSES = 1000
BINS = {"bins": 20, "range": ((0.3, 1.0), (0.0, 0.5))}


def furnished(house: House) -> float:
    """Return the fraction of the rooms' floor that furniture covers."""
    return sum(p.area for r in house.rooms for p in r.pieces) / sum(r.area for r in house.secondary)


def compact(house: House) -> float:
    """Return the fraction of the outline's rectangle that the house covers."""
    boxes = np.array([room.box for room in house.rooms])
    west, north, east, south = *boxes[:, :2].min(axis=0), *boxes[:, 2:].max(axis=0)
    return sum(room.area for room in house.rooms) / ((east - west) * (south - north))


def expressive_range(count: int) -> tuple[dict[str, dict[str, float]], bytes]:
    """Return coverage and entropy of a histogram of two measures of many houses, and its picture as a PNG.

    The histogram is the expressive range of Smith and Whitehead (2010).
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.2 * len(GRAMMARS), 3.8), dpi=150, layout="constrained")
    found = {}
    for axes, grammar in zip(figure.subplots(1, len(GRAMMARS)), GRAMMARS, strict=True):
        houses = list(generate(rooms=5, grammar=grammar, seed=11, count=count, workers=2))
        x, y = [compact(house) for house in houses], [furnished(house) for house in houses]
        cells, *_ = axes.hist2d(x, y, cmap="Blues", **BINS)
        found[grammar] = {
            "cells": int((cells > 0).sum()),
            "share": float(entropy(cells.ravel().astype(int)) / np.log(cells.size)),
            "outside": count - int(cells.sum()),
            "compactness": float(np.mean(x)),
            "furniture": float(np.mean(y)),
        }
        axes.set(
            title=f"{grammar}: {count} houses of 5 rooms",
            xlabel="compactness",
            ylabel="floor under furniture",
        )
    return found, png(figure)


def page(spreads: dict[str, Spread], held: list[Law], ranges: dict[str, Any], seconds: float) -> str:
    """Return the page of results."""

    def number(value: float | None) -> str:
        return "" if value is None else f"{value:.3f}"

    return PAGE.format(
        when=datetime.now(UTC).date(),
        machine=machine(),
        minutes=seconds / 60,
        versions=versions("clingo"),
        whole=table_rows(
            (name, f"{s.layouts:,}" if s.layouts else "too many to list", f"{s.samples:,}",
             number(s.share), number(s.uniform), f"{s.accepted:.2f}")
            for name, s in spreads.items()
        ),
        parts=table_rows(
            (name, part, str(p.values), number(p.sampled), number(p.conditioned), number(p.alike),
             f"{p.distance:.3f} ({p.expected:.3f})")
            for name, s in spreads.items()
            for part, p in s.parts.items()
        ),
        laws=table_rows(
            (law.name, f"{law.samples:,}", f"{law.distance:.4f}", f"{law.p:.2f}") for law in held
        ),
        ranges=table_rows(
            (name, *(f"{r[key]:.2f}" for key in ("compactness", "furniture")), str(r["cells"]),
             f"{r['share']:.2f}")
            for name, r in ranges.items()
        ),
    )  # fmt: skip


PAGE = """# Uniformity of sampled houses

`./run bench sampling`, {when}: {minutes:.0f} minutes. {machine}; {versions}. Grammar: `family`.

## Layouts
| | layouts | samples | share | even | accepted |
|---|---|---|---|---|---|
{whole}

A uniform sampler has the largest entropy for this number of layouts. `share` is the measured fraction of
that entropy, corrected for the size of the sample (Miller 1955). `even` is what the same formula gives for
as many samples of an exactly uniform sampler. `accepted` is for comparison: the fraction that the rules
accept if all picks are sampled at once.

Layouts are not meant to be equally likely. Choices are sampled one by one, in random order, by the
grammar's weights, each among the options that the rules and earlier choices leave. With equally likely
layouts, nearly every bathroom would have all the furniture that it may have, because three items have more
placements than one. So the study measures each part of the layouts separately and compares two other laws:

- `rejection` samples all picks at once, by their weights, and repeats until the rules accept them.
- `alike` takes each layout equally often.

All three columns are fractions of the largest entropy of the values that the part can have. If there are
too many layouts to list, they refer to the values that occurred. `distance` is the total variation between
sampled and rejection, 0 to 1. In brackets is the expected distance of two samples of these sizes from one
law.

| | part | values | sampled | rejection | alike | distance |
|---|---|---|---|---|---|---|
{parts}

## Lengths
k items in a row leave k + 1 gaps, which are uniform on their simplex: each is Beta(1,k) of the free length.
The table has the largest Kolmogorov-Smirnov distance of a gap. It also has the smallest p-value times the
number of gaps, at most 1.

| | samples | distance | p |
|---|---|---|---|
{laws}

## Expressive range
This histogram shows houses of 5 rooms of each grammar of stars, in 400 cells (Smith and Whitehead 2010).
One axis is compactness, the fraction of the outline's rectangle that the house covers. The other is the
fraction of the rooms' floor under furniture. `share` is the histogram's entropy relative to a uniform one
over all cells.

![Expressive range of the two grammars](expressive-range.png)

| grammar | mean compactness | mean floor under furniture | cells | share |
|---|---|---|---|---|
{ranges}
"""


@dataclass(frozen=True)
class Sampling:
    """Measure the uniformity of sampled layouts and lengths, and the range of houses."""

    fast: bool = False
    """Take a hundredth of the samples, to test that everything runs; this is no study."""

    out: Path = Path("runs/sampling")
    """Folder for sampling.md, sampling.json and expressive-range.png."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Run the study and write its page."""
        begun, less = monotonic(), 100 if self.fast else 1
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            asked = {
                subject: pool.submit(spread, "family", subject, samples // less, TRIES // less, 60 / less)
                for subject, samples in SAMPLES.items()
            }
            found = {subject: future.result() for subject, future in asked.items()}
        order: list[int | str] = sorted(found, key=lambda subject: (isinstance(subject, str), subject))
        spreads = {f"{s} rooms" if isinstance(s, int) else s: found[s] for s in order}
        held = laws(Builder(find("family")), GAPS // less)
        ranges, picture = expressive_range(HOUSES // less)
        figures = msgspec.to_builtins({"layouts": spreads, "laws": held, "range": ranges})
        text = page(spreads, held, ranges, monotonic() - begun)
        files = {"sampling.json": json.dumps(figures, indent=2) + "\n", "sampling.md": text}
        contents = {name: content.encode() for name, content in files.items()}
        write(contents | {"expressive-range.png": picture}, self.out, self.publish)
        print(self.out / "sampling.md")
