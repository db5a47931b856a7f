"""Commands on house files: ``vitruvius check``, ``draw`` and ``convert``."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import tyro

from vitruvius.commands.common import Repeated, print_answer, say_warnings
from vitruvius.logic.exports import FORMATS
from vitruvius.logic.spelling import numbered, printable
from vitruvius.logic.terminal import print_above, progress, say
from vitruvius.options import DASH, Streamed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vitruvius.answers.houses import Differences
    from vitruvius.logic.house.house import House

    Format = str
else:
    Format = Literal["vitruvius-2", *FORMATS]

OTHERS = "; ".join(f"{name}: {each.words}" for name, each in FORMATS.items()) + "."


@dataclass(frozen=True)
class Check:
    """Check houses by plain geometry, independently of the rules that made them.

    Houses count from 0. The check judges promises only, not window lengths and not your own rules in a
    grammar (docs/house-file.md).
    """

    file: tyro.conf.Positional[Streamed]
    """House file, or - for the standard input."""

    promises: Annotated[str | None, tyro.conf.arg(metavar="FILE|GRAMMAR"), DASH] = None
    """Promises to judge by instead of the houses' own: a JSON file that replaces some of them, as
    {"door_clearance": 0.9, "passage": 0.9}, or a grammar, by its name or folder (docs/house-file.md)."""

    clear_front: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="PIECE")] = ()
    """Furniture type that is used from its front: 0.42 m must be free there."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Check the houses and print a line for each violation; return 1 if there is any."""
        from msgspec.structs import replace

        from vitruvius.answers.houses import Checked, Violations
        from vitruvius.logic import HouseSet, check, load
        from vitruvius.logic.dataset.sets import MANIFEST
        from vitruvius.logic.spelling import unknown
        from vitruvius.logic.workers.check import promises_by, promises_of

        say_warnings()
        houses = load(self.file)
        of = houses if isinstance(houses, HouseSet) else None
        judged_by = promises_of if self.promises is None else promises_by(self.promises)
        checked, pieces = list[Violations](), set[str]()
        for index, house in enumerate(progress(of.verified() if of else houses, len(houses), "houses")):
            pieces |= {each.type for room in house.rooms for each in room.pieces}
            promises = judged_by(house)
            clear = (*promises.clear_front, *self.clear_front)
            violations = check(house, replace(promises, clear_front=clear))
            checked.append(Violations(index, violations))
            for violation in [] if self.json else violations:
                print_above(printable(f"{self.file}: house {index}: {violation}"))
        for name in self.clear_front:
            if name not in pieces:
                say(f"--clear-front {name}: {unknown('piece', name, pieces)}")
        nonconforming = sum(bool(each.violations) for each in checked)
        counts = of.counts() if of else None
        if self.json:
            answer = Checked(str(self.file), nonconforming, checked, counts)
            print_answer("check", answer, int(nonconforming > 0))
        if counts:
            say(f"{self.file}: {counts}, as {MANIFEST} states")
        say(f"{self.file}: {len(houses)} checked, {nonconforming or 'none'} with violations")
        return 1 if nonconforming else 0


@dataclass(frozen=True)
class Draw:
    """Draw plans of houses and a contact sheet.

    The plans can have a scale on paper (--scale), or show the differences between two files of houses
    (--diff).
    """

    groups: ClassVar = {
        "out": "Pictures",
        "palette": "Looks",
        "scale": "Pages to scale",
        "diff": "Differences",
        "json": "For programs",
    }

    file: tyro.conf.Positional[Streamed]
    """House file, or - for the standard input."""

    out: Path = Path("plans")
    """Folder for the pictures."""

    format: Literal["svg", "png", "pdf"] = "svg"
    """Format of the plans; a PDF is one file, with a page for each plan."""

    replace: bool = False
    """Overwrite files in the folder that have the names of the pictures."""

    one_scale: bool = False
    """Draw all houses to one scale, so that their sizes compare; by default each is as large as fits."""

    palette: Literal["colour", "distinct", "grey"] = "colour"
    """Colours. colour: one for each room type; distinct: colours that people with colour blindness can
    distinguish; grey: for print, types differ in their grey or their pattern."""

    grammar: str | None = None
    """Name of a shipped grammar, or a directory of rules, whose looks.json has the colours and symbols of
    types. By default the houses' own grammar, if it is a shipped one."""

    scale: str | None = None
    """Scale on a page, as in 1:50: each house is drawn in true millimetres."""

    paper: Literal["A4", "A3", "A2", "A1", "A0"] | None = None
    """Paper size for --scale; by default the smallest that holds the house, for each house."""

    diff: Streamed | None = None
    """Another house file: draw what was added, removed and moved from each house of the first file to the
    house with the same index in this one."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Write a picture of each house, numbered from 0 as in the file, and a picture of all."""
        from vitruvius.logic import load
        from vitruvius.logic.files.replacing import alone_in, require_drawn
        from vitruvius.logic.files.writing import require_folder

        say_warnings()
        self._require()
        require_folder(self.out)
        houses, others = load(self.file), load(self.diff) if self.diff else []
        with alone_in(self.out):
            require_drawn(self.out, self.format, self.replace)
            return self._drawn(houses, others)

    def _drawn(self, houses: "Sequence[House]", others: "Sequence[House]") -> int:
        """Write the requested pictures."""
        from vitruvius.logic.drawing.draw import draw

        if self.diff is not None:
            return self._changes(houses, others)
        if self.scale is not None:
            return self._pages(houses, self.scale)
        pictures = draw(houses, self.out, self.format, self.one_scale, self.palette, self.grammar)
        beside = (
            f" and {numbered(len(pictures) - 1, 'plan')} beside it"
            if len(pictures) > 1
            else f": {numbered(len(houses), 'plan')}"
        )
        self._answer(pictures)
        say(f"{pictures[-1]}{beside}")
        return 0

    def _answer(self, files: "Sequence[Path]", differences: "Sequence[Differences]" = ()) -> None:
        """Remove the pictures of an earlier run, and print the answer if it is requested."""
        from vitruvius.answers.houses import Drawn

        _remove_others(self.out, files)
        if self.json:
            print_answer("draw", Drawn([str(file) for file in files], list(differences)))

    def _require(self) -> None:
        """Raise ``RequestError`` for options that exclude each other."""
        from vitruvius.logic.errors import RequestError

        if self.paper and not self.scale:
            raise RequestError(f"--paper {self.paper}: give a scale, as --scale 1:50")
        if self.scale and (self.one_scale or self.diff):
            other = "--one-scale" if self.one_scale else "--diff"
            raise RequestError(f"--scale and {other}: leave out one of them")
        if self.diff and (self.format == "pdf" or self.one_scale):
            other = "--format pdf" if self.format == "pdf" else "--one-scale"
            raise RequestError(f"--diff and {other}: leave out one of them")

    def _pages(self, houses: "Sequence[House]", scale: str) -> int:
        """Write a page for each house."""
        from vitruvius.logic.drawing.draw import write_pages
        from vitruvius.logic.drawing.pages import page, scale_of
        from vitruvius.logic.drawing.palettes import style

        ratio, look = scale_of(scale), style(houses, self.palette, self.grammar)
        pages = [page(house, look, ratio, self.paper, f"house {n}") for n, house in enumerate(houses)]
        written = write_pages(pages, self.out, self.format, unit="mm")
        names = f"{written[0]}{f' to {written[-1].name}' if len(written) > 1 else ''}"
        self._answer(written)
        say(f"{names}: {len(pages)} pages at 1:{ratio}")
        return 0

    def _changes(self, *pairs: "Sequence[House]") -> int:
        """Write a picture of the changes of each pair of houses, and print the changes."""
        from vitruvius.answers.houses import Differences
        from vitruvius.logic.drawing.difference import diff_drawing
        from vitruvius.logic.drawing.draw import encoded
        from vitruvius.logic.errors import RequestError
        from vitruvius.logic.files.writing import write_whole
        from vitruvius.logic.house.diff import changes

        if len(pairs[0]) != len(pairs[1]):
            counts = f"{self.file} has {numbered(len(pairs[0]), 'house')}, {self.diff} {len(pairs[1])}"
            raise RequestError(
                f"--diff: {counts}: houses are compared in pairs, so give files with the same number"
            )
        digits, files, differences = len(str(len(pairs[0]) - 1)), [], []
        for index, (old, new) in enumerate(zip(*pairs, strict=True)):
            found = changes(old, new)
            drawing = diff_drawing(old, new, found)
            page = [((0.0, 0.0), drawing)], drawing.width, drawing.height
            path = self.out / f"diff-{index:0{digits}}.{self.format}"
            write_whole(path, encoded(page, "png" if self.format == "png" else "svg"))
            files.append(path)
            differences.append(Differences(index, found))
            for change in found if not self.json else ():
                print(printable(f"house {index}: {change}"))
            say(f"{path}: {len(found) or 'no'} changes")
        self._answer(files, differences)
        return 0


@dataclass(frozen=True)
class Convert:
    """Write houses of any format as a house file of the present format, or in the format of another tool."""

    file: tyro.conf.Positional[Streamed]
    """House file, or - for the standard input."""

    out: Streamed
    """New house file (.jsonl, .jsonl.gz, or .json for one house), or - for the standard output; for other
    formats a folder."""

    to: Annotated[Format, tyro.conf.arg(metavar="FORMAT", help=OTHERS)] = "vitruvius-2"
    """Format. vitruvius-2: a house file, whose houses simulate as before. The others write a file for each
    house."""

    replace: bool = False
    """Overwrite new files that have other content."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Read the houses and write them."""
        from vitruvius.answers.houses import Written
        from vitruvius.logic import load, save
        from vitruvius.logic.exports import export
        from vitruvius.logic.files.house_files import HOUSE_FILES
        from vitruvius.logic.files.replacing import require_same_houses, unless_other
        from vitruvius.logic.files.writing import require_ending, require_folder
        from vitruvius.logic.opener import STANDARD

        say_warnings()
        if self.out == STANDARD:
            return self._print()
        if self.to == "vitruvius-2":
            require_ending(self.out, HOUSE_FILES)
            houses = [house.converted() for house in load(self.file)]
            if not self.replace:
                require_same_houses(self.out, houses)
            save(houses, self.out)
            if self.json:
                print_answer("convert", Written([str(self.out)]))
            say(f"{self.out}: {len(houses)} converted")
            return 0
        require_folder(self.out)
        with unless_other(self.out, self.replace) as folder:
            files = export(load(self.file), folder, self.to)
        written = [self.out / file.name for file in files]
        endings = FORMATS[self.to].endings
        _remove_others(self.out, [path.with_suffix(ending) for path in written for ending in endings])
        if self.json:
            print_answer("convert", Written([str(each) for each in written]))
        say(f"{written[0]}{f' to {written[-1].name}' if len(written) > 1 else ''}: {len(written)} converted")
        return 0

    def _print(self) -> int:
        """Write the houses to the standard output.

        Raises ``RequestError`` if the format needs several files.
        """
        from vitruvius.logic import load
        from vitruvius.logic.errors import RequestError

        if self.to != "vitruvius-2":
            raise RequestError(f"--out -: --to {self.to} writes a file for each house: give --out a folder")
        if self.json:
            raise RequestError("--out - and --json both write to standard output: leave out one")
        for house in load(self.file):
            print(json.dumps(house.converted().to_dict()), flush=True)
        return 0


def _remove_others(folder: Path, written: "Sequence[Path]") -> None:
    """Remove the pictures or files of an earlier run with more houses, and print their number."""
    from vitruvius.logic.files.replacing import remove_others

    if number := remove_others(folder, written):
        say(f"{folder}: removed {number} of an earlier run")
