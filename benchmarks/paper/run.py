"""``vitruvius bench paper``: the study that makes docs/paper.md.

Each part writes its data into the folder during the study. It continues where it was stopped, or from the
published data.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import tyro

from benchmarks.common.pages import DOCS, write
from benchmarks.paper.page import PARTS, paper_page
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import require_folder, write_whole
from vitruvius.logic.spelling import unknown


@dataclass(frozen=True)
class PaperStudy:
    """Measure the paper's claims, and write the page."""

    parts: tyro.conf.Positional[tuple[str, ...]] = ()
    """Parts to measure: agents (minutes), training (hours), complexity (an hour); by default all."""

    engine: Literal["ray"] | None = None
    """Measure complexity by Ray, here or on a cluster; each number of rooms by a method has a whole
    machine."""

    address: str | None = None
    """Address of Ray's cluster: HOST:PORT, or auto for the one on this machine; by default the study starts
    one here."""

    again: bool = False
    """Measure everything, including the published parts."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    out: Path = Path("runs/paper")
    """Folder for page, picture, data, and intermediate files of the parts."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> None:
        """Measure, and write the page with all known data."""
        for part in self.parts:
            if part not in PARTS:
                raise RequestError(unknown("part", part, PARTS))
        if (self.engine or self.address) and (self.parts != ("complexity",) or not self.engine):
            raise RequestError(
                "--engine and --address are for complexity alone: bench paper complexity --engine ray"
            )
        engine = {"engine": self.engine, "address": self.address} if self.engine else {}
        require_folder(self.out)
        self.out.mkdir(parents=True, exist_ok=True)
        data = published()
        for name in self.parts or PARTS:
            file = self.out / f"paper-{name}.json"
            if name in data and not self.again and not file.exists():
                write_whole(file, as_json(data[name]))
            data[name] = PARTS[name].measure(self.out, **engine)
        files = {f"paper-{name}.json": as_json(part) for name, part in data.items()}
        write(files | pages(data), self.out, self.publish)


def published() -> dict[str, Any]:
    """Return the data of all parts that are published."""
    files = {name: DOCS / f"paper-{name}.json" for name in PARTS}
    return {name: json.loads(file.read_text()) for name, file in files.items() if file.exists()}


def pages(data: dict[str, Any]) -> dict[str, bytes]:
    """Return the page and its picture, by their names."""
    made = {"paper.md": paper_page(data).encode()}
    pictures = {name: PARTS[name].picture(part) for name, part in data.items() if name != "agents"}
    return made | {f"paper-{name}.png": picture for name, picture in pictures.items()}


def as_json(data: Any) -> bytes:
    """Return data in the published form."""
    return json.dumps(data, separators=(",", ":")).encode() + b"\n"
