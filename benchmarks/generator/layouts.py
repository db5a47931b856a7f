"""Uniformity of stage 1's layouts, compared with all layouts and with rejection sampling.

Rejection sampling samples every pick by its weight alone, and begins again until the rules accept all picks.
So its law is known: it is that of the picks, given the rules. The study compares it with sampling pick by
pick, which never begins again.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

import numpy as np
from clingo import Symbol

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.program import ALL_LAYOUTS, Program

PARTS = {
    "types": {"room": (0, 1)},
    "sides": {"side": (1,)},
    "corners": {"corner": (0, 1, 2)},
    "how many": {"on": (0,)},
    "at which wall": {"on": (0, 2)},
    "in which order": {"on": (0, 2, 3)},
    "what touches": {"joined": (0, 1), "end": (0,)},
    "how turned": {"turned": (0, 2), "faces": (0, 2), "row": (0,)},
    "companions": {"with": (0, 2)},
}
"""Arguments of atoms that define each part of a layout."""

Layout = tuple[Symbol, ...]
Value = tuple[tuple[str | Symbol, ...], ...]


def entropy(counts: Iterable[int]) -> float:
    """Return the entropy of a sample, in nats, corrected for its size (Miller 1955)."""
    counted = np.array([count for count in counts if count])
    shares = counted / counted.sum()
    return float(-(shares * np.log(shares)).sum() + (len(counted) - 1) / (2 * counted.sum()))


def share(counts: Iterable[int], values: int) -> float:
    """Return the entropy of a sample as a fraction of the largest entropy of ``values`` values."""
    return float(entropy(counts) / np.log(values))


@dataclass(frozen=True)
class LayoutPart:
    """A part of a program's layouts: fractions of the largest entropy under three laws, and a distance."""

    values: int
    sampled: float
    """Fraction for layouts as stage 1 samples them."""
    conditioned: float
    """Fraction for rejection sampling."""
    alike: float | None
    """Fraction if all layouts were equally probable; None if there are too many to list."""
    distance: float
    """Total variation between sampled and conditioned, 0 to 1."""
    expected: float
    """Expected distance between two samples of these sizes from one law."""


@dataclass(frozen=True)
class Spread:
    """Sampled layouts of one program."""

    layouts: int | None
    """Number of all layouts; None if there are too many to list."""
    samples: int
    seen: int
    share: float | None
    """Fraction of the largest entropy."""
    uniform: float | None
    """Fraction that as many samples of an exactly uniform sampler would show."""
    accepted: float
    """Fraction of rejection's tries that the rules accept."""
    parts: dict[str, LayoutPart] = field(default_factory=dict)


def spread(grammar: str, subject: int | str, samples: int, tries: int, seconds: float) -> Spread:
    """Study the layouts of a number of rooms, or of the furniture of a type of room.

    Layouts are listed if that takes at most ``seconds``.
    """
    builder = Builder(find(grammar))
    make: Any = builder.programs.rooms if isinstance(subject, int) else builder.programs.furniture
    listed = every_layout(make(subject, arguments=ALL_LAYOUTS), seconds)
    program: Program = make(subject)
    sampled = Counter(tuple(program.sample(np.random.default_rng([1, i])) or ()) for i in range(samples))
    conditioned = by_rejection(program, np.random.default_rng(2), tries)
    size = len(listed) if listed else None
    alike = np.random.default_rng(3).multinomial(samples, np.full(size, 1 / size)) if size else ()
    found = {name: _part(name, sampled, conditioned, listed) for name in PARTS}
    return Spread(
        layouts=size,
        samples=samples,
        seen=len(sampled),
        share=share(sampled.values(), size) if size else None,
        uniform=share(alike, size) if size else None,
        accepted=conditioned.total() / tries,
        parts={name: part for name, part in found.items() if part},
    )


def every_layout(program: Program, seconds: float) -> Counter[Layout] | None:
    """Return each layout once, or None after ``seconds``."""
    deadline, listed = monotonic() + seconds, Counter[Layout]()
    with program._control.solve(yield_=True) as handle:
        for model in handle:
            listed[tuple(sorted(model.symbols(shown=True)))] += 1
            if monotonic() > deadline:
                return None
    return listed


def by_rejection(program: Program, rng: np.random.Generator, tries: int) -> Counter[Layout]:
    """Return the layouts of the tries that the rules accept."""
    several = {atom.arguments[0]: atom.arguments[1].number for atom in program.atoms("picks", 2)}
    variables = sorted({atom.arguments[0] for atom in program.atoms("option", 3)})
    wanted = np.repeat([several.get(variable, 1) for variable in variables], program._counts)
    variable = np.repeat(np.arange(len(variables)), program._counts)
    place = np.arange(len(variable)) - np.repeat(
        np.cumsum(program._counts) - program._counts, program._counts
    )
    accepted = Counter[Layout]()
    program.end_search()
    for _ in range(tries):
        keys = rng.exponential(size=len(variable)) / program._weights
        picked = program._choices[np.lexsort((keys, variable))[place < wanted]]
        with program._control.solve(assumptions=picked.tolist(), yield_=True) as handle:
            model = handle.model()
            if model is not None:
                accepted[tuple(sorted(model.symbols(shown=True)))] += 1
    return accepted


def _part(
    name: str, sampled: Counter[Layout], conditioned: Counter[Layout], listed: Counter[Layout] | None
) -> LayoutPart | None:
    """Return a part of these layouts; None if they lack it, or all have the same value."""
    ours, theirs = _values(name, sampled), _values(name, conditioned)
    every = _values(name, listed) if listed else None
    values = every or ours | theirs
    if len(values) < 2:
        return None
    p = np.array([ours[value] for value in values]) / ours.total()
    q = np.array([theirs[value] for value in values]) / theirs.total()
    both = (p + q) / 2
    deviation = np.sqrt(both * (1 - both) * (1 / ours.total() + 1 / theirs.total()))
    return LayoutPart(
        values=len(values),
        sampled=share(ours.values(), len(values)),
        conditioned=share(theirs.values(), len(values)),
        alike=float(-(a := np.array([*every.values()]) / every.total()) @ np.log(a) / np.log(len(values)))
        if every
        else None,
        distance=float(np.abs(p - q).sum() / 2),
        expected=float(np.sqrt(2 / np.pi) * deviation.sum() / 2),
    )


def _values(name: str, layouts: Counter[Layout]) -> Counter[Value]:
    """Return the frequency of each value of a part of the layouts."""
    kept, values = PARTS[name], Counter[Value]()
    for layout, count in layouts.items():
        atoms = [(a.name, *(a.arguments[i] for i in kept[a.name])) for a in layout if a.name in kept]
        values[tuple(sorted(atoms))] += count
    return values
