"""Kolmogorov-Smirnov tests of the laws of stage 2 against its samples, through the real predicates.

k things in a row leave k + 1 gaps. If gaps are uniform on their simplex, each is Beta(1,k) of their total.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from clingo import Function, parse_term
from scipy.stats import beta, kstest

from vitruvius.logic import House
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import Work
from vitruvius.logic.generation.star import StarDraft, house
from vitruvius.logic.placement import prolog
from vitruvius.logic.placement.layout import Layout, RoomLayout
from vitruvius.logic.placement.lengths import stated_lengths
from vitruvius.logic.placement.placer import Infeasible, Misfit
from vitruvius.logic.request.house_request import HouseRequest

CHAINS = Path(__file__).with_name("chains.pl")

SIDES = {"north": (0, 1), "east": (1, 1), "south": (0, -1), "west": (1, -1)}
"""Axis along which a side's rooms follow each other clockwise, and the direction."""


@dataclass(frozen=True)
class Law:
    """Test of a law against samples: the worst statistic among its gaps."""

    name: str
    samples: int
    distance: float
    """Largest distance between the sampled and the stated distribution functions."""
    p: float
    """Smallest p-value of a gap, times the number of gaps (Bonferroni); at most 1."""


def held(name: str, gaps: np.ndarray) -> Law:
    """Test gaps, (samples, k+1), as fractions of their sum, against Beta(1,k)."""
    k = gaps.shape[1] - 1
    found = [kstest(gap, beta(1, k).cdf) for gap in gaps.T]
    least = min(float(result.pvalue) for result in found)
    distance = max(float(result.statistic) for result in found)
    return Law(name, len(gaps), distance, min(1.0, least * len(found)))


def on_a_chain(pieces: int, samples: int) -> np.ndarray:
    """Return the gaps around ``pieces`` pieces of 0.5 m on 10 m, as fractions of the free length."""
    seeds = np.random.default_rng(pieces).integers(2**63, size=samples).tolist()
    prolog.load(CHAINS)
    starts = np.array(prolog.ask("starts", pieces, 0.5, 10.0, seeds, module="chains"))
    return _gaps(starts, starts + 0.5, 0.0, 10.0) / (10 - 0.5 * pieces)


def on_a_wall(builder: Builder, pieces: Sequence[str], samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the gaps around pieces at a bathroom's back wall, as fractions, and its widths in metres."""
    atoms = [f"on({piece},1,back,{n})" for n, piece in enumerate(pieces, start=1)]
    furniture = [parse_term(atom) for atom in (*atoms, "busy(back)", f"last(back,{len(pieces)})")]
    passage, shares, widths = 0.42, [], []
    rng = np.random.default_rng(len(pieces))
    for seed in rng.integers(2**63, size=samples).tolist():
        room = RoomLayout(0, Function("bathroom"), Function("north"), furniture, seed)
        (made,) = builder.placer.place(Layout([room], []), rng, 10**8).rooms
        assert made
        boxes = np.array(sorted((each.x, each.width) for each in made.children))
        gaps = _gaps(boxes[None, :, 0], boxes.sum(axis=1)[None], made.x, made.x + made.width)[0]
        shares.append((gaps - passage) / (gaps - passage).sum())
        widths.append(made.width)
    return np.array(shares), np.array(widths)


def along_sides(builder: Builder, rooms: int, samples: int) -> dict[int, np.ndarray]:
    """Return the gaps along the sides of whole houses, as fractions, by the number of rooms on the side.

    The first gap begins where the first room's door would touch the corner of the main room, or a gap past
    the corner if the corner belongs to another side. The last gap ends likewise.
    """
    lengths: dict[str, float] = stated_lengths(builder.placer, {})[0]["lengths"]
    between = max(lengths["room_gap"], lengths["door_clearance"])
    shares: dict[int, list[np.ndarray]] = defaultdict(list)
    for index in range(samples):
        rng = np.random.default_rng([rooms, index])
        request = HouseRequest(rooms)
        layout = StarDraft(builder.loaded, builder.maker.feasibility, request, Work(rng, 10**8)).sample()
        try:
            plan = builder.placer.place(layout, rng, 10**8, minimal=False)
        except (Infeasible, Misfit):  # of the furniture, which does not affect the places of rooms
            continue
        made = house(plan, layout, request)
        owners = {
            tuple(map(str, corner.arguments[:2])): str(corner.arguments[2]) for corner in layout.corners
        }
        for side in SIDES:
            own = [
                star
                for star, room in zip(made.star.rooms, layout.rooms, strict=True)
                if str(room.side) == side
            ]
            if own:
                gaps = _side_gaps(made, own, side, owners, between)
                shares[len(own)].append(gaps / gaps.sum())
    return {k: np.array(found) for k, found in sorted(shares.items())}


def _side_gaps(
    house: House, rooms: list[Any], side: str, owners: dict[tuple[str, ...], str], between: float
) -> np.ndarray:
    """Return the free gaps along one side: the rest of each gap after its minimum."""
    axis, way = SIDES[side]
    west, north, east, south = house.main.box
    corner = {"north": west, "east": north, "south": east, "west": south}[side]
    length = (east - west, south - north)[axis]

    def span(rect: Any) -> tuple[float, float]:
        """Return start and end, clockwise from the side's first corner."""
        ends = ((rect.box[axis] - corner) * way, (rect.box[axis + 2] - corner) * way)
        return min(ends), max(ends)

    sides = list(SIDES)
    before, after = sides[sides.index(side) - 1], sides[(sides.index(side) + 1) % 4]
    starts, ends = np.array([span(room) for room in rooms]).T
    first = span(rooms[0])[0] - between if owners.get((before, side)) == before else span(rooms[0].door)[0]
    inside = owners.get((side, after)) == after
    last = length - between - ends[-1] if inside else length - span(rooms[-1].door)[1]
    return np.array([first, *(starts[1:] - ends[:-1] - between), last])


def _gaps(starts: np.ndarray, ends: np.ndarray, first: float, last: float) -> np.ndarray:
    """Return the gaps before, between and behind things in a row: (samples, k+1) for (samples, k)."""
    edge = np.ones((len(starts), 1))
    return np.hstack([starts, last * edge]) - np.hstack([first * edge, ends])


def laws(builder: Builder, samples: int) -> list[Law]:
    """Return the table of the study."""
    found = [
        held(f"gaps on a chain of {k}, by `chain_sample`", on_a_chain(k, samples)) for k in (1, 2, 3, 5, 8)
    ]
    for k, pieces in enumerate((["toilet"], ["toilet", "sink"], ["toilet", "sink", "shower"]), start=1):
        shares, widths = on_a_wall(builder, pieces, samples // 5)
        found.append(held(f"gaps around {k} at a wall, in rooms", shares))
        if k == 1:
            widths = (widths - 2.4) / (3.7 - 2.4)
            found.append(
                held("the width of a room that nothing binds", np.stack([widths, 1 - widths], axis=1))
            )
    for k, shares in along_sides(builder, 6, samples // 10).items():
        found.append(held(f"gaps around {k} room{'s' * (k > 1)} on a side, in houses of 6", shares))
    return found
