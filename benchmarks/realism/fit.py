"""Weights of types with which houses of a grammar have as many rooms of each type as the plans of a set."""

import re
import shutil
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from benchmarks.realism.figures import PlanFigures
from vitruvius.logic.grammar import Grammar

GREATEST = 1000
"""Weight of the most frequent type; the other weights are rounded fractions of it."""
WEIGHT = re.compile(r"^\s*(?:weight\([^.]*\)\.\s*)+(?=%|$)", re.MULTILINE)
"""Pattern of lines of a rule file that state weights, and nothing else."""


def shares(plans: Sequence[PlanFigures]) -> Counter[str]:
    """Return the mean number of rooms of each type in a plan."""
    counts = sum((plan.types for plan in plans), Counter[str]())
    return Counter({type_: count / len(plans) for type_, count in counts.items()})


def off(one: Mapping[str, float], other: Mapping[str, float]) -> float:
    """Return the mean number of rooms of a plan that are of other types."""
    return sum(abs(one.get(each, 0.0) - other.get(each, 0.0)) for each in {*one, *other}) / 2


def with_weights(grammar: Grammar, weights: Mapping[str, int], folder: Path) -> Path:
    """Return a copy of a grammar with these weights only."""
    shutil.copytree(grammar.directory, folder)
    for file in folder.rglob("*.lp"):
        file.write_text(WEIGHT.sub("", file.read_text(encoding="utf-8")), encoding="utf-8")
    (folder / "weights.lp").write_text(written(weights, ""), encoding="utf-8")
    return folder


def written(weights: Mapping[str, int], comment: str) -> str:
    """Return the file of these weights."""
    facts = "".join(f"weight({type_},{weight}).\n" for type_, weight in sorted(weights.items()))
    return f"%# How often rooms are of each type{comment}.\n{facts}"


def fitted(
    grammar: Grammar,
    stated: Mapping[str, int],
    wanted: Sequence[PlanFigures],
    make: Callable[[Path], Sequence[PlanFigures]],
    rounds: int,
    say: Callable[[str], None],
) -> dict[str, int]:
    """Return the weights of the round whose houses have the fewest rooms of other types.

    ``stated``: the current weights. In each round, a weight is multiplied by the ratio of the wanted
    frequency of its type to the found one. A type that is not wanted keeps one of the smallest weights.
    """
    target, weights, best = shares(wanted), dict(stated), (float("inf"), dict(stated))
    for number in range(rounds + 1):
        with tempfile.TemporaryDirectory() as folder:
            found = shares(make(with_weights(grammar, weights, Path(folder) / grammar.name)))
        apart = off(found, target)
        say(f"round {number}: {apart:.3f} rooms of a plan have other types")
        best = min(best, (apart, weights), key=lambda each: each[0])
        raw = {type_: w * (target[type_] + 0.02) / (found[type_] + 0.02) for type_, w in weights.items()}
        most = max(raw.values())
        weights = {type_: max(1, round(GREATEST * each / most)) for type_, each in raw.items()}
    return best[1]
