"""``vitruvius bench planted``: briefs that known plans keep at their limits, so that any proof is false.

The plan is a random tiling on a grid of decimetres, by cuts and by pinwheels, some with a void. Each length
and area of its brief is what the plan has: exactly, or as the least or the most.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import numpy as np

from benchmarks.briefs.attempts import Attempt, attempt, attempt_at, within
from benchmarks.briefs.bank import BriefEntry
from benchmarks.briefs.boxes import SIDES, Box, area, around
from benchmarks.briefs.make import Json, proven
from benchmarks.briefs.plans import LEAST_VOID, KnownPlan, dissected, door_tree
from benchmarks.briefs.run import ALONE, warm
from benchmarks.briefs.score import judged
from benchmarks.briefs.tightened import tightened
from benchmarks.common.houses import INFERENCES
from benchmarks.common.processes import say
from logic.errors import RequestError
from logic.generation.builder import Builder
from logic.grammar import find
from logic.house.files import MOST_BYTES
from logic.opener import opened
from logic.request.brief import alone
from logic.request.given_plan import read_plan
from logic.request.request import Request

DOORWAY, WINDOWED, CONTACT, LEAST_ROOM = 0.9, 1.0, 0.1, 0.9
"""Metres: of wall with a door, with a window, and that neighbours share; of a side of a room."""

ROUNDING = 1e-9
"""Metres: what a difference of two places is off."""

WHAT, HOW = ("sizes", "areas", "mixed"), ("exact", "limits")
"""What a brief says of rooms, and how."""

GIVEN, SEED = ("grammar", "plan"), 56
"""What is made of a house, and the seed of the houses."""

BASES = (("plain", 3), ("home", 5), ("plain", 5), ("clinic", 6))
"""Grammars and numbers of rooms of the houses, in turn."""

SELDOM = 15
"""Each so many-th brief is of one of these."""

WALLS = (
    KnownPlan(
        ((0.0, 0.0, 3.0, 3.0), (3.0, 0.0, 5.0, 3.0), (0.0, 3.0, 2.1, 6.0), (2.1, 3.0, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 1), (0, 2), (0, 3)),
        0,
    ),
    KnownPlan(
        ((0.0, 0.0, 3.0, 3.0), (3.0, 0.0, 5.0, 3.0), (0.0, 3.0, 2.9, 6.0), (2.9, 3.0, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 1), (0, 2), (1, 3)),
        0,
    ),
    KnownPlan(
        ((2.0, 0.0, 2.9, 3.1), (0.0, 0.0, 2.0, 3.1), (2.9, 0.0, 5.0, 3.1), (0.0, 3.1, 5.0, 6.0)),
        ("room",) * 4,
        ((0, 3), (1, 3), (2, 3)),
        0,
    ),
    KnownPlan(
        ((0.0, 0.0, 3.0, 1.9), (0.0, 1.9, 3.0, 5.0), (3.0, 2.0, 5.0, 5.0)),
        ("room",) * 3,
        ((0, 1), (1, 2)),
        0,
        ((3.0, 0.0, 5.0, 2.0),),
    ),
)
"""A door in 0.9 m of wall, neighbours by 0.1 m, an entrance in 0.9 m, an outer wall of 0.1 m at a void."""

PLANTED = "planted.jsonl"
"""The file of the answers."""


class PlantedRow(msgspec.Struct, frozen=True, omit_defaults=True):
    """The answer to a planted brief, grammar or plan."""

    number: int
    kind: str
    """``grammar``, ``plan``; of a brief ``sizes``, ``areas`` or ``mixed``, ``exact`` or ``limits``."""
    rooms: int
    said: str
    """``house``, ``undecided`` or ``limit``; where it is wrong, ``false proof`` or ``wrong house``."""
    seconds: float
    """Of processor time."""
    because: tuple[str, ...] = ()
    """The lines of a false proof, the faults of a wrong house, or the limit."""
    brief: Json | None = None
    """Where there is no house."""

    @property
    def wrong(self) -> bool:
        """Whether it is false."""
        return self.said in ("false proof", "wrong house")


@dataclass(frozen=True)
class PlantedStudy:
    """Answer briefs, grammars and plans that known houses keep at their limits: any proof is false."""

    briefs: int = 2000
    """How many. What has an answer in the folder is not asked again."""

    houses: int = 100
    """How many houses have a grammar around them, which is asked for a house, and for one in their plan."""

    boxes: tuple[int, int] = (2, 8)
    """From how many rooms and voids to how many."""

    seconds: int = 60
    """Of processor time for each."""

    out: Path = Path("runs/planted")
    """Folder for planted.jsonl, an answer a line."""

    replace: bool = False
    """Write into the folder whatever else it holds."""

    def run(self) -> int:
        """Print how often each answer came, by kind; 1 where one is false."""
        if not 1 <= self.boxes[0] <= self.boxes[-1]:
            raise RequestError("--boxes: the least comes first, and is 1 or more")
        self.out.mkdir(parents=True, exist_ok=True)
        path, rows = self.out / PLANTED, []
        if path.exists():
            with opened(path, MOST_BYTES) as file:
                rows = [msgspec.json.decode(line, type=PlantedRow) for line in file if line.endswith(b"\n")]
            path.write_bytes(b"".join(map(line_of, rows)))  # without the line that a kill has cut
        for row in self._answers({(row.kind in GIVEN, row.number) for row in rows}):
            rows.append(row)
            say(f"{row.kind} {row.number}: {row.said}, {row.seconds} s")
            with path.open("ab") as file:
                file.write(line_of(row))
        counts = Counter((row.kind, row.said) for row in rows)
        for (kind, said), times in sorted(counts.items()):
            print(f"{kind:16}{said:12}{times:6}")
        return int(any(row.wrong for row in rows))

    def _answers(self, done: set[tuple[bool, int]]) -> Iterator[PlantedRow]:
        """Yield what is not done. SWI-Prolog holds one grammar at a time."""
        builder = warm(ALONE, ())
        for number in range(self.briefs):
            if (False, number) not in done:
                entry = planted(number, *self.boxes)
                yield row_of(number, entry, self._tried(partial(attempt, builder, alone(entry.read))))
        for number in range(self.houses):
            if (True, number) not in done:
                yield from self._of_a_house(number)

    def _of_a_house(self, number: int) -> Iterator[PlantedRow]:
        base, rooms = BASES[number % len(BASES)]
        builder = Builder(find(base))
        house = builder.house(Request(rooms), SEED, number, INFERENCES)
        with TemporaryDirectory() as folder:
            strict = Builder(find(tightened(builder, house, Path(folder) / "mine")))
            types = Counter(room.type for room in house.rooms)
            exact = {type_: (times, times) for type_, times in types.items()}
            requests = Request(rooms, exact), Request(rooms, plan=read_plan(house))
            for kind, request in zip(GIVEN, requests, strict=True):
                found = self._tried(partial(attempt_at, strict, request))
                said = "false proof" if found.because is not None else "house" if found.houses else "limit"
                because = found.because or tuple(filter(None, [found.limit]))
                yield PlantedRow(number, kind, rooms, said, round(found.seconds, 3), because)

    def _tried(self, work: Callable[[], Attempt]) -> Attempt:
        late = Attempt(float(self.seconds), limit=f"{self.seconds} s of processor time")
        return within(self.seconds, work, Attempt) or late


def line_of(row: PlantedRow) -> bytes:
    """Return a line of the file."""
    return msgspec.json.encode(row) + b"\n"


def row_of(number: int, entry: BriefEntry, found: Attempt) -> PlantedRow:
    """Judge an answer to a planted brief."""
    answer = judged(entry, found.answer(entry))
    faults = [*answer.faults, *(line.words for line in answer.lines if not line.kept)]
    if answer.said == "impossible":
        said, because = "false proof", found.because or ()
    elif answer.said == "house":
        said, because = ("wrong house", tuple(faults)) if faults else ("house", ())
    else:
        said, because = "undecided" if "could not be decided" in found.limit else "limit", (found.limit,)
    brief = None if said == "house" else entry.brief
    return PlantedRow(number, entry.source, entry.rooms, said, round(found.seconds, 3), because, brief)


# - briefs --------------------------------------------------------------------


def planted(number: int, least: int = 2, most: int = 6) -> BriefEntry:
    """Return planted brief ``number``, with from ``least`` to ``most`` boxes: each kind in turn."""
    if number % SELDOM == 0:
        return _of_walls(number, WALLS[number // SELDOM % len(WALLS)])
    rng = np.random.default_rng([56, number])
    what, how = WHAT[number % 3], HOW[number // 3 % 2]
    plan = _tiling(int(rng.integers(least, most + 1)), rng)
    brief = _read_off(plan, how == "exact", what, rng)
    name = f"planted-{number}"
    return proven(BriefEntry(name, "dissection", f"{what}, {how}", brief, "house"), plan)


def _of_walls(number: int, walls: KnownPlan) -> BriefEntry:
    """Return a brief of a plan that has a wall of just the least length, with all sizes exact."""
    names = [f"Room {place}" for place in range(1, len(walls.boxes) + 1)]
    sides = [[round(box[2] - box[0], 1), round(box[3] - box[1], 1)] for box in walls.boxes]
    rooms: list[Json] = [
        {"name": name, "size": [[side, side] for side in some]}
        for name, some in zip(names, sides, strict=True)
    ]
    if walls.voids:
        rooms[1]["outside"] = ["east"]
    near = walls.pairs(CONTACT - ROUNDING, np.inf)
    brief: Json = {
        "rooms": rooms,
        "doors": [[names[one], names[other]] for one, other in walls.doors],
        "next_to": [[names[one], names[other]] for one, other in near],
        "entrance": {"room": names[0], "side": walls.outer(0, DOORWAY - ROUNDING)[0]},
        "outline": _outline(walls, True, np.random.default_rng(0)) | {"width": 5, "depth": walls.outline[3]},
    }
    return proven(BriefEntry(f"planted-{number}", "dissection", "walls, exact", brief, "house"), walls)


def _tiling(boxes: int, rng: np.random.Generator) -> KnownPlan:
    """Return a random plan of so many boxes, of which one may be a void; all of its rooms are reached."""
    while True:
        side, stretch = (rng.uniform(4, 12) * boxes) ** 0.5, rng.uniform(0.7, 1.4)
        whole = (0.0, 0.0, round(side * stretch, 1), round(side / stretch, 1))
        found = dissected(whole, boxes, rng, LEAST_ROOM, 1)
        if found is None:
            continue
        found = [found[place] for place in rng.permutation(boxes)]
        voids: list[Box] = []
        if boxes > 1 and rng.random() < 0.3 and _may_be_void(found[0], found[1:]):
            voids, found = found[:1], found[1:]
        plain = KnownPlan(tuple(found), ("room",) * len(found), (), 0, tuple(voids))
        doors = door_tree(plain, rng, DOORWAY - ROUNDING)
        entrances = [room for room in range(len(found)) if plain.outer(room, DOORWAY - ROUNDING)]
        if entrances and (doors or len(found) == 1):
            plan = KnownPlan(plain.boxes, plain.types, doors, int(rng.choice(entrances)), plain.voids)
            return replace(plan, windows=tuple(_windows(plan, rng)))


def _windows(plan: KnownPlan, rng: np.random.Generator) -> Iterator[tuple[int, str]]:
    """Yield a window in some rooms, not in the side by which the house is entered."""
    way_in = plan.entrance, plan.outer(plan.entrance, DOORWAY - ROUNDING)[0]
    for room in range(len(plan.boxes)):
        sides = [side for side in plan.outer(room, WINDOWED - ROUNDING) if (room, side) != way_in]
        if sides and rng.random() < 0.2:
            yield room, sides[0]


def _may_be_void(void: Box, rooms: list[Box]) -> bool:
    """Say whether it is as large as a void is, and takes no whole side of the outline."""
    return min(void[2] - void[0], void[3] - void[1]) >= LEAST_VOID - ROUNDING and around(rooms) == around(
        [void, *rooms]
    )


def _read_off(plan: KnownPlan, exact: bool, what: str, rng: np.random.Generator) -> Json:
    """Return a brief that a plan keeps at its limits."""
    names = [f"Room {number}" for number in range(1, len(plan.boxes) + 1)]
    entrance = plan.outer(plan.entrance, DOORWAY - ROUNDING)[0]
    rooms = []
    for number, box in enumerate(plan.boxes):
        room: Json = {"name": names[number]}
        if what != "areas" and rng.random() < 0.7:
            sides = [_span(box[2] - box[0], exact, rng), _span(box[3] - box[1], exact, rng)]
            room["size"] = sides if rng.random() < 0.7 else sides[::-1]
        if what != "sizes" and rng.random() < 0.7:
            room["area"] = _span(area(box), exact, rng)
        outer = plan.outer(number, CONTACT - ROUNDING)
        if outer and rng.random() < 0.3:
            room["outside"] = [outer[0]] if rng.random() < 0.7 else True
        lit = [side for room, side in plan.windows if room == number]
        rooms.append(room | ({"windows": lit} if lit else {}))
    outline = _outline(plan, exact, rng)
    brief: Json = {"rooms": rooms} | ({"outline": outline} if outline else {})
    if rng.random() < 0.2:
        brief["area"] = _span(sum(map(area, plan.boxes)), exact, rng)
    if rng.random() < 0.8:
        brief["doors"] = [[names[one], names[other]] for one, other in plan.doors]
    if rng.random() < 0.5:
        side = {"side": entrance} if rng.random() < 0.5 else {}
        brief["entrance"] = {"room": names[plan.entrance], **side}
    near, far = plan.pairs(CONTACT - ROUNDING, np.inf), plan.pairs(-np.inf, 0)
    for key, pairs in (("next_to", near), ("apart", far)):
        some = [[names[one], names[other]] for one, other in pairs if rng.random() < 0.3]
        brief |= {key: some} if some else {}
    return brief


def _outline(plan: KnownPlan, exact: bool, rng: np.random.Generator) -> Json:
    west, north, east, south = plan.outline
    found: Json = {
        key: _span(length, exact, rng)
        for key, length in (("width", east - west), ("depth", south - north))
        if rng.random() < 0.6
    }
    voids = []
    for void in plan.voids:
        at = [side for side, a, b in zip(SIDES, void, plan.outline, strict=True) if a == b]
        one: Json = {"width": round(void[2] - void[0], 1), "depth": round(void[3] - void[1], 1)}
        if len(at) == 2:
            one["corner"] = "-".join(sorted(at, key=("north", "south", "west", "east").index))
        else:
            one |= {"x": round(void[0] - west, 1), "y": round(void[1] - north, 1)}
        voids.append(one)
    return found | ({"voids": voids} if voids else {})


def _span(value: float, exact: bool, rng: np.random.Generator) -> list[float]:
    """Return a range that ends at a length or an area, whole square centimetres: which end, or both."""
    value = round(value, 4)
    share = rng.uniform(0.02, 0.5)
    ends = [value, value], [value, round(value * (1 + share), 4)], [round(value * (1 - share), 4), value]
    return ends[0 if exact else rng.integers(1, 3)]
