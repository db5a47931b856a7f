"""``vitruvius bench generator``: the study of how hard a house is, on any grammar."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.common.measure import study
from benchmarks.generator.page import generator_page
from logic.errors import RequestError


@dataclass(frozen=True)
class Generator:
    """Solve time against rooms, by stage, beside rejection sampling and another solver."""

    grammar: str = "family"
    """A shipped grammar's name, or a directory of rules."""

    rooms: tuple[int, ...] = (1, 2, 4, 8, 16, 32, 64, 128)
    """Numbers of secondary rooms."""

    rounds: int = 20
    """Houses of each number of rooms."""

    out: Path = Path("runs/bench")
    """Folder for generator.json, generator.png and generator.md."""

    publish: bool = False
    """Put the page and its plot into docs too."""

    def run(self) -> None:
        """Measure, draw, write the page and print the fitted laws."""
        if self.rounds < 1 or not self.rooms or min(self.rooms) < 1:
            raise RequestError("--rooms needs one number or more, each 1 or more; --rounds 1 or more")
        place = Path(self.grammar)
        settings = {
            "VITRUVIUS_GRAMMAR": str(place.resolve()) if place.is_dir() else self.grammar,
            "VITRUVIUS_ROOMS": " ".join(map(str, sorted(set(self.rooms)))),
            "VITRUVIUS_ROUNDS": str(self.rounds),
        }
        page = partial(generator_page, grammar=self.grammar)
        script = Path(__file__).with_name("test_generator.py")
        study(script, self.out, page, publish=self.publish, **settings)
