"""Readers of foreign files, and the two correct answers to any content: a value, or an error of ours."""

import os
import shutil
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

CORPUS = Path(__file__).parents[2] / "tests" / "fixtures" / "corpus"
"""Small contents to begin with, in a folder for each reader. Contents that once failed are among them."""

READ, REFUSED = "read", "refused"


class WrongAnswer(Exception):
    """Error that a user cannot act on: of a foreign class, with several lines, or without a message."""


class FuzzReader(NamedTuple):
    """A reader: the name of its file, and the function that reads the file at a path."""

    file: str
    read: Callable[[Path], Any]
    is_json: bool = False
    """True if contents are also changed as JSON, by value."""
    begins: tuple[str, ...] = ()
    """Readers whose contents replace the reader's own first contents."""
    refuses: tuple[type[Exception], ...] = ()
    """Documented errors of Python, which callers of the reader turn into one-line errors."""


def _houses(path: Path) -> None:
    """Read houses, and check that each is written as it was read."""
    from vitruvius.logic import House
    from vitruvius.logic.dataset.reading import load

    for house in load(path):
        assert House.from_dict(house.to_dict()) == house


def _drawn(path: Path) -> None:
    """Read houses, check them and draw them, and check that a drawing is XML."""
    from xml.etree import ElementTree

    from vitruvius.logic import check, load
    from vitruvius.logic.drawing.draw import plan_svg

    for house in load(path):
        check(house)
        ElementTree.fromstring(plan_svg(house))


def _map(path: Path) -> None:
    """Read a map from its description; its picture is in the same folder."""
    shutil.copy(CORPUS / "picture" / "map.pgm", path.parent)
    _houses(path)


def _pixels(path: Path) -> None:
    from vitruvius.logic import load

    load(path, whole_pixels=True)


def _plan(path: Path) -> None:
    from vitruvius.logic.request.given_plan import read_plan

    read_plan(path)


def _ifc(path: Path) -> None:
    """Read a plan without IfcOpenShell's process, which is not there."""
    from unittest.mock import patch

    from vitruvius.logic.readers import ifc

    with patch.object(ifc.subprocess, "run", return_value=_Done(b'{"error": "plan: IFC without spaces"}')):
        _plan(path)


class _Done(NamedTuple):
    stdout: bytes


def _solids(path: Path) -> None:
    """Read the answer of IfcOpenShell's process."""
    from unittest.mock import patch

    from vitruvius.logic.readers import ifc
    from vitruvius.logic.readers.regular import regular

    with patch.object(ifc.subprocess, "run", return_value=_Done(path.read_bytes())):
        regular(ifc.read_ifc(b"", None, None), None, 0.01)


def _brief(path: Path) -> None:
    from vitruvius.logic.request.brief import alone, read_brief
    from vitruvius.logic.request.brief_lines import requirements

    brief = read_brief(path)
    requirements(brief)
    alone(brief)


def _rules(path: Path) -> None:
    """Lint a grammar of this file and the other files of ``family``."""
    from vitruvius.logic.grammar import SHIPPED, find
    from vitruvius.logic.language.linter import findings

    folder = path.parent
    for file in (SHIPPED / "family").glob("*.[lp][lp]"):
        if file.suffix != path.suffix:
            shutil.copy(file, folder)
    for each in findings(find(folder)):
        assert each.text.strip(), each


def _statements(path: Path) -> None:
    """Read an answer set program as statements, with its includes and encodings."""
    from vitruvius.logic.grammar import find

    (path.parent / "sizes.pl").touch()
    _ = find(path.parent).hash


def _looks(path: Path) -> None:
    from vitruvius.logic.looks.looks import folder_looks

    folder_looks(path.parent)


def _promises(path: Path) -> None:
    """Read a file of promises."""
    import json

    from vitruvius.logic.house.promises import Promises, read_promises

    stated = json.loads(path.read_bytes())
    if isinstance(stated, dict):
        read_promises(stated, Promises())


def _set(path: Path) -> None:
    """Read a set's description, and if it is valid, the division of the set."""
    from vitruvius.logic.dataset.sets import read_set

    if found := read_set(path.parent):
        found.divided()


def _manifest(path: Path) -> None:
    """Read a set by its manifest, and each of its houses."""
    from vitruvius.logic.dataset.reading import HouseSet

    _beside(path, "set.json", "train-00000-of-00001.jsonl")
    list(HouseSet(path.parent))


def _rows(path: Path) -> None:
    """Read a set by a file of rows, and the parts of the rows."""
    from vitruvius.logic.dataset.reading import HouseSet

    _beside(path, "set.json", "manifest.json")
    data = path.parent / "data"
    data.mkdir(exist_ok=True)
    path.rename(data / "train-00000-of-00001.jsonl")
    list(HouseSet(path.parent))


def _parquet(path: Path) -> None:
    from vitruvius.logic.dataset.formats import read
    from vitruvius.logic.dataset.rows import house_of

    for row in read(path):
        house_of(row, {}, None)


def _beside(path: Path, *names: str) -> None:
    """Copy a set's other files into the folder of one of them."""
    for name in names:
        place = path.parent / ("data" if name.endswith(".jsonl") else "") / name
        place.parent.mkdir(exist_ok=True)
        shutil.copy(CORPUS / "of-a-set" / name, place)


def _checkpoint(path: Path) -> None:
    from vitruvius.agent.runs.checkpoint import load

    load(path)


def _trace(path: Path) -> None:
    from vitruvius.agent.recording.trace import load

    load(path)


def _scores(path: Path) -> None:
    """Read an evaluation, and show it as a report does."""
    from vitruvius.agent.evaluation.scores import load

    load(path)


def _games(path: Path) -> None:
    from vitruvius.agent.play.results import load

    load(path)


def _settings(path: Path) -> None:
    from vitruvius.settings import read

    read(path)


def _task(path: Path) -> None:
    """Read a task from a JSON text, as in checkpoints and evaluations."""
    from vitruvius.sim.tasks.tasks import task

    task(path.read_text("utf-8", "replace"))


def _report(path: Path) -> None:
    """Write the report of a folder with this file; for a description of a run, add a run."""
    from vitruvius.agent.report.folder import report

    if path.name == "about.json":
        shutil.copy(CORPUS / "report-runs" / "metrics.jsonl", path.parent)
    report(path.parent)


def _info(path: Path) -> None:
    from vitruvius.info.recognise import recognised

    recognised(str(path))


READERS = {
    "houses": FuzzReader("mine.jsonl", _houses, is_json=True),
    "packed": FuzzReader("mine.jsonl.gz", _houses),
    "drawn": FuzzReader("mine.jsonl", _drawn, is_json=True, begins=("houses",)),
    "pixels": FuzzReader("mine.json", _pixels, is_json=True),
    "map": FuzzReader("map.yaml", _map),
    "picture": FuzzReader("map.pgm", lambda path: _houses(_described(path))),
    "free-walls": FuzzReader("mine.json", _houses, is_json=True),
    "geojson": FuzzReader("mine.geojson", _plan, is_json=True),
    "houseexpo": FuzzReader("mine.json", _plan, is_json=True),
    "resplan": FuzzReader("mine.json", _plan, is_json=True),
    "cubicasa": FuzzReader("mine.svg", _plan),
    "imdf": FuzzReader("mine.json", _plan, is_json=True),
    "archive": FuzzReader("mine.zip", _plan),
    "ifc": FuzzReader("mine.ifc", _ifc),
    "solids": FuzzReader("mine.json", _solids, is_json=True),
    "other-plans": FuzzReader("mine.dxf", _plan),
    "brief": FuzzReader("mine.json", _brief, is_json=True),
    "statements": FuzzReader("rooms.lp", _statements),
    "answer-sets": FuzzReader("rooms.lp", _rules),
    "prolog": FuzzReader("sizes.pl", _rules),
    "looks": FuzzReader("looks.json", _looks, is_json=True),
    "promises": FuzzReader("promises.json", _promises, is_json=True, refuses=(ValueError, RecursionError)),
    "set": FuzzReader("set.json", _set, is_json=True),
    "manifest": FuzzReader("manifest.json", _manifest, is_json=True),
    "rows": FuzzReader("rows.jsonl", _rows, is_json=True),
    "parquet": FuzzReader("rows.parquet", _parquet, refuses=(ValueError, OSError)),
    "checkpoint": FuzzReader("mine.safetensors", _checkpoint),
    "trace": FuzzReader("mine.trace.json", _trace, is_json=True),
    "scores": FuzzReader("evaluation.json", _scores, is_json=True),
    "games": FuzzReader("mine.jsonl", _games, is_json=True),
    "settings": FuzzReader("mine.toml", _settings),
    "task": FuzzReader("mine.json", _task, is_json=True, refuses=(ValueError,)),
    "report-traces": FuzzReader("mine.trace.json", _report, is_json=True, begins=("trace",)),
    "report-scores": FuzzReader("evaluation.json", _report, is_json=True, begins=("scores",)),
    "report-runs": FuzzReader("metrics.jsonl", _report, is_json=True),
    "report-about": FuzzReader("about.json", _report, is_json=True),
    "info-json": FuzzReader("mine.json", _info, is_json=True, begins=("trace", "scores", "resplan", "imdf")),
    "info-lines": FuzzReader("mine.jsonl", _info, is_json=True, begins=("houses", "games")),
    "info-agent": FuzzReader("mine.safetensors", _info, begins=("checkpoint",)),
    "info-settings": FuzzReader("mine.toml", _info, begins=("settings",)),
}
"""Readers by name. Contents to begin with are in ``tests/fixtures/corpus/NAME``, or in those of
``begins``."""


def _described(picture: Path) -> Path:
    """Write a description for a map's picture."""
    path = picture.with_name("map.yaml")
    path.write_text(
        "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    return path


def begin(name: str) -> list[bytes]:
    """Return the contents that a reader begins with, the smallest first."""
    folders = READERS[name].begins or (name,)
    return sorted((file.read_bytes() for each in folders for file in (CORPUS / each).iterdir()), key=len)


def answer(reader: FuzzReader, content: bytes, folder: Path) -> str:
    """Return ``READ`` or ``REFUSED`` for a file with this content in an empty folder.

    Raises ``WrongAnswer`` for an error of several lines, and any other error that reading raises.
    """
    from vitruvius.logic.errors import VitruviusError

    if any(folder.iterdir()):
        raise ValueError(f"{folder}: is not empty, and all that is in it would be removed")
    path = folder / reader.file
    path.write_bytes(content)
    try:
        with warnings.catch_warnings(action="ignore"):
            reader.read(path)
    except reader.refuses:
        return REFUSED
    except VitruviusError as error:
        text = str(error).strip()
        if error.exit_code == VitruviusError.exit_code:
            raise WrongAnswer(f"{type(error).__name__} has no exit code: {text[:300]}") from error
        if not text or "\n" in text:
            raise WrongAnswer(f"not one line: {text[:300]!r}") from error
        return REFUSED
    finally:
        for each in folder.iterdir():
            shutil.rmtree(each) if each.is_dir() else os.unlink(each)
    return READ


@contextmanager
def scratch() -> Iterator[Path]:
    """Yield a temporary folder, in memory if the system allows it."""
    from tempfile import TemporaryDirectory

    memory = Path("/dev/shm")
    with TemporaryDirectory(dir=memory if memory.is_dir() and os.access(memory, os.W_OK) else None) as folder:
        yield Path(folder)
