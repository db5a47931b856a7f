"""``vitruvius check``, ``draw`` and ``convert``: what is done with files of houses."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from logic.commands import Repeated, print_answer, progress, say
from logic.spelling import printable


@dataclass(frozen=True)
class Check:
    """Check houses by plain geometry, apart from the rules that made them. Houses count from 0."""

    file: tyro.conf.Positional[Path]
    """House file."""

    clear_front: Annotated[tuple[str, ...], Repeated, tyro.conf.arg(metavar="PIECE")] = ()
    """A piece type that is used from its front: 0.42 m must be free there."""

    json: bool = False
    """Print one answer as JSON (docs/command-line.md): each house and its violations."""

    def run(self) -> int:
        """Print a line for each violation; 1 if there is any."""
        from msgspec.structs import replace

        from logic import check, load
        from logic.answers import Checked, Violations
        from logic.check import promises_of
        from logic.spelling import unknown

        houses = load(self.file)
        pieces = sorted({each.type for house in houses for room in house.rooms for each in room.pieces})
        for name in self.clear_front:
            if name not in pieces:
                say(f"--clear-front {name}: {unknown('piece', name, pieces)}")
        checked = list[Violations]()
        for index, house in enumerate(progress(houses, len(houses), "houses")):
            promises = promises_of(house)
            clear = promises.clear_front.union(self.clear_front)
            violations = check(house, replace(promises, clear_front=clear))
            checked.append(Violations(index, violations))
            for violation in [] if self.json else violations:
                print(printable(f"{self.file}: house {index}: {violation}"))
        nonconforming = sum(bool(each.violations) for each in checked)
        if self.json:
            print_answer("check", Checked(str(self.file), nonconforming, checked), int(nonconforming > 0))
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

    json: bool = False
    """Print one answer as JSON: the names of the files."""

    def run(self) -> int:
        """Write a picture of each house, numbered from 0 as in the file, and one of all."""
        from logic import load
        from logic.answers import Written
        from logic.draw import draw
        from logic.files import require_folder

        require_folder(self.out)
        pictures = draw(load(self.file), self.out, format=self.format, one_scale=self.one_scale)
        if self.json:
            print_answer("draw", Written([str(each) for each in pictures]))
        say(f"{pictures[-1]} and {len(pictures) - 1} plans beside it")
        return 0


@dataclass(frozen=True)
class Convert:
    """Write houses of any format as a house file of today, or in the format of another tool."""

    file: tyro.conf.Positional[Path]
    """House file."""

    out: Path
    """The new house file (.jsonl, .jsonl.gz, or .json for one house); for other formats a folder."""

    to: Literal["vitruvius-2", "geojson", "gltf", "mjcf", "ros", "usd"] = "vitruvius-2"
    """vitruvius-2: a house file, whose houses simulate as before. The others are a file for each house.
    geojson: in metres; gltf, usd: walls 2.5 m high; mjcf: MuJoCo's XML, with a robot and its range finders;
    ros: an occupancy map for map_server."""

    json: bool = False
    """Print one answer as JSON: the names of the files."""

    def run(self) -> int:
        """Read the houses and write them."""
        from logic import load, save
        from logic.answers import Written
        from logic.exports import export
        from logic.files import HOUSE_FILES, require_ending, require_folder

        if self.to == "vitruvius-2":
            require_ending(self.out, HOUSE_FILES)
            houses = [house.converted() for house in load(self.file)]
            save(houses, self.out)
            if self.json:
                print_answer("convert", Written([str(self.out)]))
            say(f"{self.out}: {len(houses)} converted")
            return 0
        require_folder(self.out)
        written = export(load(self.file), self.out, self.to)
        if self.json:
            print_answer("convert", Written([str(each) for each in written]))
        say(f"{written[0]}{f' to {written[-1].name}' if len(written) > 1 else ''}: {len(written)} converted")
        return 0
