"""``vitruvius generate``: its options, and what it writes."""

import errno
import json
import os
import re
import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import tyro

from logic.errors import RequestError, VitruviusError
from logic.house.house import House
from logic.spelling import quoted
from logic.terminal import progress, say
from vitruvius.commands.common import Repeated, counts, print_answer, print_line, require_plan, say_warnings
from vitruvius.options import Streamed

if TYPE_CHECKING:
    from logic import Broken
    from logic.dataset.formats import Files
    from logic.request.brief import Brief
    from logic.request.own_plan import OwnPlan
else:
    Files = Literal["parquet", "jsonl"]

FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
"""Why a file is written in part: the disk is full, or a quota, or the file as large as it may be."""


@dataclass(frozen=True)
class Generate:
    """Make houses from rules."""

    groups: ClassVar = {
        "rooms": "What the houses have",
        "brief": "Rooms that are wanted, each by its name",
        "plan": "Rooms that are given",
        "grammar": "Which houses, of all that there are",
        "workers": "Work",
        "shard": "A set of many houses",
        "out": "Output",
    }

    rooms: Annotated[str | None, tyro.conf.arg(metavar="N")] = None
    """Number of rooms, 1 to 128, not counted a main room as in family; with a plan or a brief, as many as it
    has. Of a set 4..10 too: its houses have each number in turn."""

    type: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="TYPE=COUNT")] = ()
    """Number of rooms of a type: bedroom=2, bedroom=1..3 or bedroom=2.. ."""

    piece: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="[TYPE.]PIECE=COUNT")] = ()
    """Number of pieces in each room that may have them: bed=1, bedroom.wardrobe=1..2."""

    cell: float = 0.0
    """Side of a grid's cell in metres, on which every edge shall lie; 0 for none."""

    brief: Streamed | None = None
    """JSON file (docs/briefs.md): rooms with types, areas, doors and neighbours, an outline. Without
    --grammar, the brief alone says what the house is."""

    nearest: bool = False
    """Of a brief that no house keeps, break the fewest lines; of a plan, move walls by as little as can be:
    say which, and make houses so."""

    plan: Streamed | None = None
    """House file of one house, GeoJSON, or a plan of HouseExpo, ResPlan, CubiCasa5K, IMDF or IFC: its rooms
    have their places, and all else is generated in them."""

    plan_unit: str | None = None
    """Of a plan that is no house file: m, dm, cm, mm, ft, in, or metres to a unit, as in 0.02; by default
    what the file says, or m."""

    snap: float = 0.01
    """Metres within which edges of the plan's rooms are one wall; what is moved is said."""

    storey: str | None = None
    """Name of the storey to read, for a plan with several storeys."""

    keep: Streamed | None = None
    """House file: a house of it keeps its rooms, and the rest is generated around them. Where rooms share
    walls, all walls, doors and windows stay; types and furniture of the other rooms are generated."""

    keep_house: int = 0
    """Which house of that file, from 0."""

    keep_rooms: tuple[str, ...] = ()
    """Which of its rooms, as in --keep-rooms R0 R2; without it, all."""

    grammar: str | None = None
    """A shipped grammar's name, or a directory of rules; family, or with a brief none."""

    seed: int = 0
    """With the index of a house, all that its random choices depend on."""

    count: int = 1
    """How many houses."""

    start: int = 0
    """Index of the first house: any slice of a series can be made by itself."""

    workers: int | None = None
    """Solver processes: 1, or with --engine all that its processors can take. They change the time, never the
    houses."""

    inferences: int = 100_000_000
    """Most Prolog inferences for a house."""

    seconds: float = 60.0
    """Most seconds for a house, or for all counts; those to start and to load the rules, a few, are not among
    them."""

    count_layouts: bool = False
    """Make no houses, but count the layouts from which they are sampled."""

    shard: Annotated[str | None, tyro.conf.arg(metavar="K/N")] = None
    """Make shard K (from 0) of the N that a set of houses is divided into, or all/N, in the folder --out: one
    that is there is skipped, and with the last one the set is whole (docs/scale.md)."""

    engine: Literal["ray"] | None = None
    """Make shards as tasks of Ray, on this machine or on a cluster (docs/scale.md)."""

    address: str | None = None
    """Of Ray's cluster: HOST:PORT, or auto for the one of this machine; without it, one is started here and
    ends with the command."""

    validation: int = 0
    """Of a set: how many houses beside, of the seeds that are reserved to choose settings by."""

    test: int = 0
    """Of a set: how many houses beside, of the seeds that are reserved to be measured by."""

    files: Files = "parquet"
    """Of a set: Parquet, or JSON Lines."""

    out: Streamed | None = None
    """House file (.jsonl, .jsonl.gz, or .json for one house); without it, or with -, to the standard
    output. Of a set: its folder."""

    replace: bool = False
    """Lose the other houses that the file or the folder holds, if any."""

    json: bool = False
    """Print one answer as JSON (docs/command-line.md): what was made."""

    def run(self) -> int:
        """Write the houses; where a limit, Ctrl-C or SIGTERM ends the work, those made so far, and why."""
        from logic import generate
        from logic.opener import STANDARD

        say_warnings()
        require_plan(self.plan, self.plan_unit, self.snap, self.storey)
        if self.count_layouts:
            from vitruvius.commands.layouts import count_layouts

            return count_layouts(self)
        if self.shard is not None:
            from vitruvius.commands.shards import make_shards

            return make_shards(self, self.shard)
        if self.engine is not None or self.address is not None:
            raise RequestError(
                "--engine and --address are of a set: say which of its shards by --shard, as in all/8"
            )
        out = None if self.out == STANDARD else self.out
        _require_writable(out, self.count)
        houses: list[House] = []
        began = time.monotonic()
        brief, broken = self._nearest() if self.nearest and self.plan is None else (self.brief, ())
        plan, changes = self._nearest_plan() if self.nearest and self.plan else (self.plan, ())
        request = generate(
            **self.asked(brief, plan),
            seed=self.seed,
            count=self.count,
            start=self.start,
            workers=1 if self.workers is None else self.workers,
        )
        try:
            for house in progress(request, self.count, "houses"):
                if out and not houses:
                    self._held(out, house)
                houses.append(house)
                if out is None and not self.json:
                    print_line(json.dumps(house.to_dict()))
        except (VitruviusError, KeyboardInterrupt) as end:
            # Another process may have written meanwhile.
            if out and houses and len(houses) > self._held(out, houses[0]):
                self._save(houses, out, str(end) or "interrupted")
            raise
        if out:
            self._held(out, houses[0])
            self._save(houses, out)
            say(f"{out}: {len(houses)} made. Next: vitruvius draw {quoted(out)}")
        if self.json:
            shown = [] if out else [house.to_dict() for house in houses]
            said = [*map(str, broken), *changes]
            self.answer(time.monotonic() - began, made=len(houses), houses=shown, broken=said)
        return 0

    def asked(self, brief: Any, plan: Any) -> dict[str, Any]:
        """What the houses are asked for by, with this brief and this plan."""
        return {
            "rooms": self.number_of_rooms(),
            "types": counts("--type", self.type),
            "furniture": counts("--piece", self.piece),
            "cell": self.cell,
            "brief": brief,
            "plan": plan or self._plan_kept(),
            "plan_unit": self.plan_unit,
            "snap": self.snap,
            "storey": self.storey,
            "keep": self._kept(),
            "grammar": self.grammar,
            "inferences": self.inferences,
            "seconds": self.seconds,
        }

    def number_of_rooms(self) -> int | tuple[int, int] | None:
        """What ``--rooms`` says. Raises ``RequestError`` where that is no number, or a range but no set."""
        if self.rooms is None:
            return None
        found = re.fullmatch(r"(\d+)(?:\.\.(\d+))?", self.rooms)
        if not found:
            raise RequestError(
                f"--rooms {self.rooms}: give a whole number, as in --rooms 3, or for a set a range, as 4..10"
            )
        least, most = int(found[1]), int(found[2] or found[1])
        if least != most and self.shard is None:
            raise RequestError(
                f"--rooms {self.rooms}: houses of several numbers of rooms are a set: say which of its "
                "shards by --shard, as in all/8, and its folder by --out"
            )
        return least if least == most else (least, most)

    def _nearest(self) -> "tuple[Brief | None, tuple[Broken, ...]]":
        """A brief that has houses, and which lines of the user's these break, which is said."""
        from logic import nearest

        if self.brief is None:
            raise RequestError("--nearest is of a brief or a plan: give it by --brief FILE or --plan FILE")
        found = nearest(
            self.brief,
            types=counts("--type", self.type),
            furniture=counts("--piece", self.piece),
            grammar=self.grammar,
            seed=self.seed,
            index=self.start,
            inferences=self.inferences,
            seconds=self.seconds,
        )
        if found.broken:
            say("no house keeps the whole brief. As few lines as can be are broken:")
        else:
            say("houses keep the whole brief")
        for each in found.broken:
            say(f"  {each}")
        return found.brief, found.broken

    def _nearest_plan(self) -> "tuple[OwnPlan, tuple[str, ...]]":
        """A plan that has houses, and how its rooms differ from the user's, which is said."""
        from logic import nearest_plan

        assert self.plan
        found = nearest_plan(
            self.plan,
            plan_unit=self.plan_unit,
            snap=self.snap,
            storey=self.storey,
            types=counts("--type", self.type),
            furniture=counts("--piece", self.piece),
            grammar=self.grammar or "family",
            seed=self.seed,
            index=self.start,
            inferences=self.inferences,
            seconds=self.seconds,
        )
        if found.proof:
            say(str(found.proof))
            say("walls move by as little as can be:")
            for each in found.changes:
                say(f"  {each}")
        else:
            say("houses keep the whole plan")
        return found.plan, found.changes

    def answer(self, seconds: float, made: int = 0, **found: Any) -> None:
        """Print what was made or counted as JSON."""
        from logic.opener import STANDARD
        from vitruvius.answers.houses import Generated

        out = str(self.out) if self.out and self.out != STANDARD else None
        grammar = self.grammar or ("plain" if self.brief else "family")
        of = Generated(out, made, round(seconds, 3), grammar, self.seed, self.start, **found)
        print_answer("generate", of, 0 if all(each.exact for each in of.counted) else 4)

    def _held(self, out: Path, first: House) -> int:
        """How many houses of this series a file holds; 0 where others are to be lost, which are refused
        otherwise.
        """
        from logic.house.replacing import require_same_series

        return 0 if self.replace else require_same_series(out, first, self.start + self.count - 1)

    def _save(self, houses: list[House], out: Path, stopped: str = "") -> None:
        """Write the houses and why there are no more; where the disk is full, as many as it takes."""
        from logic import save

        kept, full = len(houses), None
        while True:
            try:
                save(houses[:kept], out, stopped and f"at house {self.start + kept}: {stopped}")
                break
            except OSError as error:
                kept = kept * 9 // 10
                if error.errno not in FULL or not kept:
                    raise full or error from None
                full = full or error
                stopped = os.strerror(error.errno)
        if stopped:
            say(f"{out}: holds the first {kept} of {len(houses)} made")
        if full:
            raise full

    def _kept(self) -> House | None:
        """The rooms that are kept. Raises ``RequestError`` for one that is not there."""
        house = self._house_kept
        try:
            return house.only(*self.keep_rooms) if house and self.keep_rooms else house
        except ValueError as error:
            raise RequestError(f"--keep-rooms: {error}") from None

    def _plan_kept(self) -> House | None:
        """A house that is no star, as the plan in which rooms of it are kept: others may have any type."""
        from msgspec.structs import replace

        house = self._house_kept
        if house is None or house.main_room:
            return None
        names = self.keep_rooms or [room.name for room in house.rooms]
        rooms = (room if room.name in names else replace(room, type="") for room in house.rooms)
        return replace(house, rooms=tuple(rooms))

    @cached_property  # what comes by the standard input is read once
    def _house_kept(self) -> House | None:
        """The house of which rooms are kept. Raises ``RequestError`` where there is none."""
        from logic import load

        if self.keep is None:
            if self.keep_house or self.keep_rooms:
                raise RequestError(
                    "--keep-house and --keep-rooms are of a house file: give it by --keep FILE"
                )
            return None
        houses = load(self.keep)
        if not 0 <= self.keep_house < len(houses):
            raise RequestError(
                f"--keep-house {self.keep_house}: {self.keep} has houses 0 to {len(houses) - 1}"
            )
        return houses[self.keep_house]


def _require_writable(out: Path | None, count: int) -> None:
    """Say before the work, not after it, that its place cannot take it."""
    from logic.house.files import HOUSE_FILES, require_file

    if out is None:
        return
    require_file(out, HOUSE_FILES)
    if out.name.removesuffix(".gz").endswith(".json") and count != 1:
        raise RequestError(f"--out {out}: a .json file holds one house, not {count}: use .jsonl")
