"""What a report shows of a run: a section for each kind of file that its folder holds.

Who writes a folder writes files, and the report is made of them alone: so the same run gives the same bytes,
today by the command that made it and any day by ``vitruvius report``.
"""

import pkgutil
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from agent.report.page import ReportError, Section, inline, page
from logic.errors import RequestError
from logic.house.files import write_whole
from logic.opener import content_of, from_json

NAME = "report.html"

MADE_BY = b"Made by <code>vitruvius report</code>"
"""Words of ``page.html`` that every report has."""

ABOUT = "about.json"
"""What the run says of itself: see ``About``."""

SECTIONS = (
    (("*.trace.json",), "agent.report.episodes:section"),
    (("evaluation.json",), "agent.report.measured:section"),
    (("config.json", "metrics.jsonl"), "agent.report.learning:section"),
    (("*.jsonl", "*.jsonl.gz", "evaluation.json"), "agent.report.plans:section"),
)
"""In the order of the page: names of files, and what makes a section of them, ``module:function``; it is
imported where there are such files. Those of a study stand before the last.
"""

Sections = Sequence[tuple[tuple[str, ...], str]]

DEPTH = "", "*/", "*/*/"
"""How deep files may lie: a study has folders of runs."""


MAX_ABOUT_BYTES = 1 << 20
"""Size of the file in which a run describes itself, in bytes."""


class About(msgspec.Struct):
    """A title, and paragraphs for the last section, as ``agent.report.page.inline`` takes them."""

    title: str
    words: list[str] = []


def describe(folder: Path, title: str, *words: str) -> None:
    """Say what a run is, for its report."""
    write_whole(folder / ABOUT, msgspec.json.format(msgspec.json.encode(About(title, list(words)))) + b"\n")


def require_report(folder: Path, replace: bool | None) -> None:
    """Raise ``RequestError`` where a page in the place of a folder's report is none of ours, unless it is to
    be lost; None: it cannot be.
    """
    path = folder / NAME
    if not replace and path.is_file() and MADE_BY not in path.read_bytes():
        ways = "give another folder" + (", or add --replace to lose it" if replace is not None else "")
        raise RequestError(f"{path}: holds something else than a report: {ways}")


def write_report(folder: Path, out: Path | None = None, studies: Sections = ()) -> Path:
    """Write the report of a run, by default into its folder; its path. Raises as ``report`` does."""
    path = out or folder / NAME
    write_whole(path, report(folder, studies))
    return path


def report(folder: Path, studies: Sections = ()) -> bytes:
    """The report of a run: of one that was interrupted, what there is. ``studies``: sections of their files.

    Raises ``ReportError`` where the folder holds nothing to report, and a ``VitruviusError`` that names the
    file where one is damaged or a trace is of another version.
    """
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "there is no such folder"
        raise ReportError(f"{folder}: {what}. Name the folder of a run: vitruvius report runs/demo")
    sections = list(_sections(folder, (*SECTIONS[:-1], *studies, SECTIONS[-1])))
    if not sections:
        kinds = "metrics.jsonl, evaluation.json, *.trace.json, house files"
        raise ReportError(f"{folder}: is no run: nothing here can be reported ({kinds})")
    about = _about(folder)
    if about.words:
        words = "\n".join(f"<p>{inline(each)}</p>" for each in about.words)
        sections.append(Section("about", "What was done", words))
    return page(about.title, _lead(found(folder, ("evaluation.json",))), sections)


def _lead(files: Sequence[Path]) -> str:
    """How a report of agents begins; a study of houses has none, and needs nothing of agents."""
    if not files:
        return ""
    from agent.report.measured import lead  # here: it imports torch

    return lead(files)


def _sections(folder: Path, known: Sections) -> Iterator[Section]:
    for names, maker in known:
        if files := found(folder, names):
            section = pkgutil.resolve_name(maker)(files, folder)
            if section:
                yield section


def found(folder: Path, names: Sequence[str]) -> list[Path]:
    """The files of these names in a folder, and some way below it."""
    paths = {path for depth in DEPTH for name in names for path in folder.glob(depth + name)}
    return sorted(path for path in paths if path.is_file())


def _about(folder: Path) -> About:
    path = folder / ABOUT
    if not path.exists():
        return About(f"Report of {folder.resolve().name}")
    try:
        return from_json(content_of(path, MAX_ABOUT_BYTES), About)
    except OSError as error:
        raise ReportError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise ReportError(f"{path}: not what a run says of itself: {error}") from None
