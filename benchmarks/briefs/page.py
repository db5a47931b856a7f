"""Page of the bank: how other generators take part, and the results of ours."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import exp, log
from pathlib import Path

import numpy as np

from benchmarks.briefs.attempts import Attempt
from benchmarks.briefs.bank import HASH, BriefEntry, frozen
from benchmarks.briefs.score import JudgedAnswer, score
from benchmarks.common.pages import machine, table_rows, versions
from vitruvius.logic.layout.account import GROUNDING, LAYOUT, LENGTHS

TEMPLATE = Path(__file__).with_name("template.md")

FURNISHED = """
The next table adds the rules and the furniture of *home*, whose rules are grounded beforehand, once per
process. These briefs do not necessarily have a furnished house, because they are exact to a centimetre.

| rooms | both done | without, median | furnished, median | p95 | of it furniture |
|---|---|---|---|---|---|
{rows}
"""

PEER = """
Another program answered a sample in the same run. The times are of briefs to which both gave the same answer,
a house or `impossible`. The ratio is the geometric mean of our time divided by the program's.

| | right, ours | the peer's | both | ours, median | p95 | the peer's, median | p95 | ratio |
|---|---|---|---|---|---|---|---|---|
{rows}
"""


@dataclass
class Results:
    """Results of the study: attempts by the names of their briefs."""

    attempts: dict[str, Attempt] = field(default_factory=dict)
    furnished: dict[str, Attempt] = field(default_factory=dict)
    proofs: dict[str, tuple[int, int, int]] = field(default_factory=dict)
    """Counts of ``needed``."""
    peer: dict[str, JudgedAnswer] = field(default_factory=dict)
    judged: list[JudgedAnswer] = field(default_factory=list)


def page(bank: Sequence[BriefEntry], found: Results, command: str) -> str:
    """Return the page for some results."""
    return TEMPLATE.read_text().format(
        count=len(frozen()),
        hash=HASH[:12],
        command=command,
        machine=machine(),
        versions=versions("clingo", "clingo-dl"),
        kinds=table_rows(kind_rows(frozen())),
        times=table_rows(time_rows(bank, found)),
        score=table_rows(score_rows(found)),
        furnished=FURNISHED.format(rows=table_rows(furnished_rows(bank, found))) if found.furnished else "",
        proofs=proofs_in_words(found),
        peer=PEER.format(rows=table_rows(peer_rows(bank, found))) if found.peer else "",
        figures=" | ".join(FIGURES),
        dashes="|".join("---" for _ in FIGURES),
    )


def kind_rows(bank: Sequence[BriefEntry]) -> Iterator[list[str]]:
    """Yield a row for each kind: the number of briefs, and the known answers."""
    for kind in dict.fromkeys(entry.kind for entry in bank):
        some = [entry for entry in bank if entry.kind == kind]
        sizes = [sum(entry.rooms == rooms for entry in some) for rooms in (5, 8, 10, 12, 16)]
        yield [f"`{kind}`", *map(str, sizes), ", ".join(sorted({entry.answer for entry in some}))]


def time_rows(bank: Sequence[BriefEntry], found: Results) -> Iterator[list[str]]:
    """Yield a row for each kind and number of rooms: counts of the outcomes, and milliseconds."""
    for kind in dict.fromkeys(entry.kind for entry in bank):
        for rooms in sorted({entry.rooms for entry in bank if entry.kind == kind}):
            names = [entry.name for entry in bank if (entry.kind, entry.rooms) == (kind, rooms)]
            some = [found.attempts[name] for name in names if name in found.attempts]
            houses, proofs = (
                sum(bool(each.houses) for each in some),
                sum(each.because is not None for each in some),
            )
            yield [
                f"`{kind}`",
                str(rooms),
                *map(str, (houses, proofs, len(some) - houses - proofs)),
                *spread([each.seconds for each in some]),
                *(
                    middle([each.stages.get(stage, 0.0) for each in some])
                    for stage in (GROUNDING, LAYOUT, LENGTHS)
                ),
                f"{np.mean([each.refuted for each in some]):.1f}",
                str(max(each.refuted for each in some)),
            ]


def spread(seconds: Sequence[float]) -> list[str]:
    """Return the median and the 95th percentile, in milliseconds."""
    return [f"{1e3 * float(np.percentile(seconds, share)):,.0f}" for share in (50, 95)]


def middle(seconds: Sequence[float]) -> str:
    """Return the median, in milliseconds."""
    return f"{1e3 * float(np.median(seconds)):,.0f}"


def score_rows(found: Results) -> Iterator[list[str]]:
    """Yield the score of our answers, and of the peer's answers to the same briefs."""
    entries = [("ours", found.judged)]
    if found.peer:
        ours = [each for each in found.judged if each.entry.name in found.peer]
        entries += [("ours, the briefs of the peer", ours), ("the peer", list(found.peer.values()))]
    for name, judged in entries:
        scored = score(judged)
        yield [name, *(_figure(scored[key]) for key in FIGURES)]


FIGURES = (
    *("briefs", "right", "houses", "valid", "all lines kept", "edges kept", "areas kept", "other lines kept"),
    *("impossible", "false refutations", "known impossible, named so", "different plans"),
)
"""Columns of the score."""


def _figure(value: float | None) -> str:
    return "" if value is None else str(value) if isinstance(value, int) else f"{100 * value:.1f} %"


def furnished_rows(bank: Sequence[BriefEntry], found: Results) -> Iterator[list[str]]:
    """Yield a row for each number of rooms: houses with and without furniture, for the same briefs."""
    names = [entry for entry in bank if entry.name in found.furnished]
    for rooms in sorted({entry.rooms for entry in names}):
        pairs = [
            (found.attempts[entry.name], found.furnished[entry.name])
            for entry in names
            if entry.rooms == rooms
        ]
        done = [(plan, whole) for plan, whole in pairs if plan.houses and whole.houses]
        if done:
            yield [
                str(rooms),
                f"{len(done)} of {len(pairs)}",
                middle([plan.seconds for plan, _ in done]),
                *spread([whole.seconds for _, whole in done]),
                middle([_of_pieces(whole) for _, whole in done]),
            ]


def _of_pieces(whole: Attempt) -> float:
    return whole.stages.get("furniture", 0.0)


def proofs_in_words(found: Results) -> str:
    """Return a sentence on the number of minimal proofs."""
    if not found.proofs:
        return "Not measured."
    lines, sure, unknown = (sum(each[place] for each in found.proofs.values()) for place in range(3))
    minimal = sum(count == needed for count, needed, _ in found.proofs.values())
    open_ = sum(count > needed and count == needed + late for count, needed, late in found.proofs.values())
    percent = 100 * minimal / len(found.proofs)
    return (
        f"Of {len(found.proofs)} proofs {minimal} ({percent:.0f} %) are minimal: without any one of their "
        f"lines, the others have a house. For {open_} more it is unknown, because some of these reach a "
        f"limit. The proofs name {lines} lines; {sure} are needed, and {unknown} may be."
    )


def peer_rows(bank: Sequence[BriefEntry], found: Results) -> Iterator[list[str]]:
    """Yield rows by number of rooms and by kind: times of both generators on briefs with the same answer."""
    ours = {each.entry.name: each for each in found.judged}
    rows: list[tuple[str, Callable[[BriefEntry], bool]]] = [
        (f"{rooms} rooms", lambda entry, rooms=rooms: entry.rooms == rooms)
        for rooms in sorted({entry.rooms for entry in bank})
    ]
    rows += [
        (f"`{kind}`", lambda entry, kind=kind: entry.kind == kind) for kind in sorted({e.kind for e in bank})
    ]
    for words, is_one in rows:
        asked = [name for name, each in found.peer.items() if is_one(each.entry)]
        both = [
            (ours[name].seconds or 0.0, found.peer[name].seconds or 0.0)
            for name in asked
            if ours[name].said == found.peer[name].said != "nothing" and found.peer[name].seconds
        ]
        if both:
            ratio = exp(float(np.mean([log(mine / other) for mine, other in both])))
            yield [
                words,
                *(str(sum(each[name].right for name in asked)) for each in (ours, found.peer)),
                str(len(both)),
                *spread([mine for mine, _ in both]),
                *spread([other for _, other in both]),
                f"{ratio:.2f}",
            ]
