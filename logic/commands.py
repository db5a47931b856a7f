"""The commands about houses: each is a dataclass whose fields are its options; the command line gathers them.

What a command needs is imported in its ``run``, so that help comes at once.
"""

import errno
import json
import os
import re
import sys
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro
from rich.console import Console
from rich.progress import Progress, ProgressColumn, TextColumn

from logic.errors import RequestError, VitruviusError
from logic.house import House
from logic.spelling import printable

Repeated = tyro.conf.UseAppendAction

FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
"""Why a file is written in part: the disk is full, or a quota, or the file as large as it may be."""


@dataclass(frozen=True)
class Generate:
    """Make houses from rules."""

    rooms: int
    """Number of secondary rooms, 1 to 128."""

    type: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="TYPE=COUNT")] = ()
    """Number of rooms of a type, as in bedroom=2, bedroom=1..3 or bedroom=2.. . Repeat for several types."""

    piece: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="[TYPE.]PIECE=COUNT")] = ()
    """Number of pieces in each room that may have them, as in bed=1 or bedroom.wardrobe=1..2. Repeat."""

    cell: float = 0.0
    """Side of a grid's cell in metres, on which every edge shall lie; 0 for none."""

    keep: Path | None = None
    """House file: a house of it keeps its rooms, and the rest is generated around them."""

    keep_house: int = 0
    """Which house of that file, from 0."""

    keep_rooms: tuple[str, ...] = ()
    """Which of its rooms, as in --keep-rooms R0 R2; without it, all."""

    grammar: str = "family"
    """A shipped grammar's name, or a directory of rules."""

    seed: int = 0
    """With the index of a house, all that its random choices depend on."""

    count: int = 1
    """How many houses."""

    start: int = 0
    """Index of the first house: any slice of a series can be made by itself."""

    workers: int = 1
    """Solver processes. They change the time, never the houses."""

    inferences: int = 100_000_000
    """Most Prolog inferences for a house."""

    seconds: float = 60.0
    """Most seconds for a house."""

    count_layouts: bool = False
    """Make no houses, but count the layouts from which they are sampled."""

    out: Path | None = None
    """House file (.jsonl, .jsonl.gz, or .json for one house); without it, to the standard output."""

    def run(self) -> int:
        """Write the houses; where a limit, Ctrl-C or SIGTERM ends the work, those made so far, and why."""
        from logic import generate

        _say_warnings()
        if self.count_layouts:
            return self._count()
        _require_writable(self.out, self.count)
        houses: list[House] = []
        request = generate(
            rooms=self.rooms,
            types=_counts("--type", self.type),
            furniture=_counts("--piece", self.piece),
            cell=self.cell,
            keep=self._kept(),
            grammar=self.grammar,
            seed=self.seed,
            count=self.count,
            start=self.start,
            workers=self.workers,
            inferences=self.inferences,
            seconds=self.seconds,
        )
        try:
            for house in _progress(request, self.count, "houses"):
                houses.append(house)
                if self.out is None:
                    print(json.dumps(house.to_dict()), flush=True)
        except (VitruviusError, KeyboardInterrupt) as end:
            if houses and self.out:
                self._save(houses, self.out, str(end) or "interrupted")
            raise
        if self.out:
            self._save(houses, self.out)
            say(f"{self.out}: {len(houses)} made. Next: vitruvius draw {self.out}")
        return 0

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
        """The house whose rooms are kept. Raises ``RequestError`` for one, or a room, that is not there."""
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
        house = houses[self.keep_house]
        try:
            return house.only(*self.keep_rooms) if self.keep_rooms else house
        except ValueError as error:
            raise RequestError(f"--keep-rooms: {error}") from None

    def _count(self) -> int:
        """Print the number of layouts of the rooms and of each type's furniture; 4 if some are too many."""
        from logic import count_layouts

        if self.keep:
            raise RequestError("--count-layouts counts those of whole houses: leave out --keep")
        if self.out:
            raise RequestError("--count-layouts makes no houses: leave out --out")
        begun, exact = time.monotonic(), True
        with _bar(TextColumn("{task.description}")) as bar:
            task = bar.add_task("")

            def report(name: str, number: int) -> None:
                passed = time.monotonic() - begun
                bar.update(task, description=f"{name}: {number:,} layouts after {passed:.0f} s")

            for name, number, whole in count_layouts(
                self.rooms,
                types=_counts("--type", self.type),
                furniture=_counts("--piece", self.piece),
                grammar=self.grammar,
                seconds=self.seconds,
                report=report,
            ):
                print(
                    f"{name}: {'' if whole else f'in {self.seconds:g} s, more than '}{number:,}", flush=True
                )
                begun, exact = time.monotonic(), exact and whole
                bar.update(task, description="")
        return 0 if exact else 4


@dataclass(frozen=True)
class Explain:
    """Say why no house satisfies a request (--rooms), or why a house is as it is (HOUSES --why R3.bed)."""

    file: tyro.conf.Positional[Annotated[Path | None, tyro.conf.arg(metavar="[HOUSES]")]] = None
    """House file: explain a part of a house in it."""

    why: str | None = None
    """The part: a room (R3), its door (R3.door), a piece (R3.bed, R3.bed2 for the second), or main."""

    house: int = 0
    """Index of the house in the file, counted from 0."""

    rooms: int | None = None
    """Of a request: number of secondary rooms, 1 to 128."""

    type: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="TYPE=COUNT")] = ()
    """Number of rooms of a type, as in bedroom=2, bedroom=1..3 or bedroom=2.. . Repeat for several types."""

    piece: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="[TYPE.]PIECE=COUNT")] = ()
    """Number of pieces in each room that may have them, as in bed=1 or bedroom.wardrobe=1..2. Repeat."""

    cell: float = 0.0
    """Side of a grid's cell in metres; 0 for none."""

    grammar: str | None = None
    """A shipped grammar's name, or a directory of rules; family, or the house's own."""

    seconds: float = 60.0
    """Most seconds."""

    json: bool = False
    """Print the reasons as JSON."""

    def run(self) -> int:
        """Print the reasons; 1 where a request has a house after all."""
        from logic import Unsatisfiable, generate
        from logic.errors import to_record

        _say_warnings()
        if self.file is not None:
            return self._house(self.file)
        if self.rooms is None or self.why is not None:
            raise RequestError(
                "explain a request, as in explain --rooms 3 --type bathroom=9, or a part of a house, as in "
                "explain houses.jsonl --why R3"
            )
        houses = generate(
            rooms=self.rooms,
            types=_counts("--type", self.type),
            furniture=_counts("--piece", self.piece),
            cell=self.cell,
            grammar=self.grammar or "family",
            seconds=self.seconds,
        )
        try:
            next(houses)
        except Unsatisfiable as proof:
            print(json.dumps(to_record(proof)) if self.json else printable(str(proof), "\n"))
            return 0
        print(json.dumps({"satisfiable": True}) if self.json else "There are such houses: vitruvius generate")
        return 1

    def _house(self, file: Path) -> int:
        """Print why a part of a house is as it is."""
        from msgspec import to_builtins

        from logic import explain_house, load

        asked = {"--rooms": self.rooms, "--type": self.type, "--piece": self.piece, "--cell": self.cell}
        if given := [option for option, value in asked.items() if value]:
            raise RequestError(f"{' and '.join(given)}: asks about a request: leave out that, or {file}")
        if self.why is None:
            raise RequestError(
                f"explain {file}: say what with --why, as in --why main, --why R0, --why R0.door"
            )
        houses = load(file)
        if not 0 <= self.house < len(houses):
            raise RequestError(f"--house {self.house}: {file} has houses 0 to {len(houses) - 1}")
        answer = explain_house(houses[self.house], self.why, grammar=self.grammar, seconds=self.seconds)
        print(json.dumps(to_builtins(answer)) if self.json else printable(str(answer), "\n"))
        return 0


@dataclass(frozen=True)
class Lint:
    """Find the mistakes in rule files that clingo and Prolog pass over."""

    grammar: tyro.conf.Positional[str] = "family"
    """A shipped grammar's name, or a directory of rules."""

    json: bool = False
    """Print each finding as a line of JSON."""

    def run(self) -> int:
        """Print a line for each finding; 1 if any is an error."""
        from msgspec import to_builtins

        from logic import lint

        found = lint(self.grammar)
        for finding in found:
            print(json.dumps(to_builtins(finding)) if self.json else printable(str(finding)))
        errors = sum(finding.severity == "error" for finding in found)
        say(f"{self.grammar}: {errors or 'no'} errors, {len(found) - errors or 'no'} warnings")
        return 1 if errors else 0


@dataclass(frozen=True)
class Check:
    """Check houses by plain geometry, apart from the rules that made them. Houses count from 0."""

    file: tyro.conf.Positional[Path]
    """House file."""

    json: bool = False
    """Print the violations of each house as a line of JSON."""

    clear_front: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="PIECE")] = ()
    """A piece type that is used from its front: 0.42 m must be free there. Repeat for several types."""

    def run(self) -> int:
        """Print a line for each violation; 1 if there is any."""
        from msgspec.structs import replace

        from logic import check, load
        from logic.check import promises_of
        from logic.spelling import unknown

        houses = load(self.file)
        pieces = sorted({each.type for house in houses for room in house.rooms for each in room.pieces})
        for name in self.clear_front:
            if name not in pieces:
                say(f"--clear-front {name}: {unknown('piece', name, pieces)}")
        nonconforming = 0
        for index, house in enumerate(_progress(houses, len(houses), "houses")):
            promises = promises_of(house)
            clear = promises.clear_front.union(self.clear_front)
            violations = check(house, replace(promises, clear_front=clear))
            nonconforming += bool(violations)
            if self.json:
                print(json.dumps({"house": index, "violations": violations}))
            else:
                for violation in violations:
                    print(printable(f"{self.file}: house {index}: {violation}"))
        say(f"{self.file}: {len(houses)} checked, {nonconforming or 'none'} with violations")
        return 1 if nonconforming else 0


@dataclass(frozen=True)
class Draw:
    """Draw plans of houses and a contact sheet."""

    file: tyro.conf.Positional[Path]
    """House file."""

    out: Path = Path("plans")
    """Folder for the pictures."""

    format: Literal["svg", "png"] = "svg"
    """What the plans are written as."""

    one_scale: bool = False
    """Draw all houses to one scale, so that their sizes compare; without it, each as large as it fits."""

    def run(self) -> int:
        """Write a picture of each house, numbered from 0 as in the file, and one of all."""
        from logic import load
        from logic.draw import draw

        pictures = draw(load(self.file), self.out, format=self.format, one_scale=self.one_scale)
        say(f"{pictures[-1]} and {len(pictures) - 1} plans beside it")
        return 0


def _counts(option: str, texts: tuple[str, ...]) -> dict[str, Any]:
    """``("bedroom=2", "hall=..1")`` as ``{"bedroom": 2, "hall": (0, 1)}``."""
    from logic.request import from_option

    counts = {}
    for text in texts:
        name, _, number = text.partition("=")
        if not name or not re.fullmatch(r"\d+|\d*\.\.\d*", number) or name in counts:
            raise RequestError(f"{option} {text}: give each name once, as in {option} bed=2 or bed=1..3")
        counts[name] = from_option(number)
    return counts


def _require_writable(out: Path | None, count: int) -> None:
    """Say before the work, not after it, that its place cannot take it."""
    from logic.files import HOUSE_FILES, require_ending

    if out is None:
        return
    if out.is_dir():
        raise RequestError(f"--out {out}: is a folder: name a file in it, as in {out / 'houses.jsonl'}")
    require_ending(out, HOUSE_FILES)
    if out.name.removesuffix(".gz").endswith(".json") and count != 1:
        raise RequestError(f"--out {out}: a .json file holds one house, not {count}: use .jsonl")
    folder = next(parent for parent in out.absolute().parents if parent.exists())
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        raise RequestError(f"--out {out}: {folder} cannot be written to")


def _progress(items: Any, total: int, what: str) -> Iterator[Any]:
    """A progress bar on a terminal, nothing in a pipe."""
    with _bar() as bar:
        yield from bar.track(items, total, description=what)


def _bar(*columns: ProgressColumn) -> Progress:
    """A bar on stderr. Where the standard output is a file, rich must not redirect it to the bar."""
    console = Console(stderr=True)
    return Progress(
        *columns,
        console=console,
        disable=not console.is_terminal,
        transient=True,
        redirect_stdout=sys.stdout.isatty(),
    )


def _say_warnings() -> None:
    """Print a warning as ``lint`` does, without the line of Python that it came by."""
    warnings.showwarning = lambda message, *_: say(str(message))


def say(text: str) -> None:
    """A line for the user, on stderr: the standard output is for houses and answers."""
    print(printable(text, "\n"), file=sys.stderr, flush=True)
