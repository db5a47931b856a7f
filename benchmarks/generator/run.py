"""``vitruvius bench generator``: the study of the difficulty of houses, on any grammar."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

from benchmarks import SECTIONS
from benchmarks.common.measure import study
from benchmarks.generator.page import generator_page
from vitruvius.agent.report.folder import write_report
from vitruvius.logic.errors import RequestError
from vitruvius.logic.grammar import find

Part = Literal["loading", "house", "layout", "place", "workers", "rejection", "decide", "sample"]


@dataclass(frozen=True)
class Generator:
    """Solve time against rooms, by stage, compared with rejection sampling and another solver."""

    grammar: str = "family"
    """Name of a shipped grammar, or a directory of rules."""

    rooms: tuple[int, ...] = (1, 2, 4, 8, 16, 32, 64, 128)
    """Numbers of secondary rooms."""

    rounds: int = 20
    """Number of houses of each number of rooms."""

    part: tuple[Part, ...] = ()
    """Parts of the study: loading a grammar; a house by both stages, its layout (clingo), its place (CLP(R));
    several workers; rejection sampling; if linear systems have a solution (decide), and one of the solutions
    (sample), also with another solver. By default all."""

    out: Path = Path("runs/bench")
    """Folder for generator.json and generator.csv, written during the study, report.html, generator.png and
    generator.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Measure, draw, write the page and print the fitted laws."""
        if self.rounds < 1 or not self.rooms or min(self.rooms) < 1:
            raise RequestError("--rooms needs one number or more, each 1 or more; --rounds 1 or more")
        if self.publish and self.part:
            raise RequestError("--publish: the page in docs shows all parts: leave out --part")
        rooms = " ".join(map(str, sorted(set(self.rooms))))
        settings = {
            "VITRUVIUS_GRAMMAR": str(find(self.grammar).directory.resolve()),
            "VITRUVIUS_ROOMS": rooms,
            "VITRUVIUS_ROUNDS": str(self.rounds),
        }
        command = f"./run bench generator --grammar {self.grammar}"
        if (self.rooms, self.rounds, self.part) != (Generator.rooms, Generator.rounds, Generator.part):
            command += f" --rooms {rooms} --rounds {self.rounds}"
            command += f" --part {' '.join(self.part)}" if self.part else ""
        page = partial(generator_page, command=command)
        script = Path(__file__).with_name("test_generator.py")
        study(script, self.out, page, parts=self.part, publish=self.publish, **settings)
        print(write_report(self.out, studies=SECTIONS))
