"""Contents of a run's report: a section for each kind of file in the run's folder.

Commands write files to the folder, and the report is made of these files alone. So the same run gives the
same bytes, both in the command that ran it and in a later ``vitruvius report``.
"""

import pkgutil
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from vitruvius.agent.report.html import ReportError, Section, inline, page
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.opener import content_of, from_json

NAME = "report.html"

MADE_BY = b"Made by <code>vitruvius report</code>"
"""Words of ``page.html`` that every report has."""

ABOUT = "about.json"
"""File in which a run describes itself: see ``About``."""

SECTIONS = (
    (("*.trace.json",), "vitruvius.agent.report.episodes:section"),
    (("evaluation.json",), "vitruvius.agent.report.measured:section"),
    (("config.json", "metrics.jsonl"), "vitruvius.agent.report.learning:section"),
    (("*.jsonl", "*.jsonl.gz", "evaluation.json"), "vitruvius.agent.report.plans:section"),
)
"""Sections in the order of the page: file patterns, and the function that makes a section of the files,
``module:function``. A function is imported only if such files exist. Sections of a study stand before the
last."""

Sections = Sequence[tuple[tuple[str, ...], str]]

DEPTH = "", "*/", "*/*/"
"""Depths at which files may lie: a study has folders of runs."""


MAX_ABOUT_BYTES = 1 << 20
"""Largest size of the file in which a run describes itself, in bytes."""


class About(msgspec.Struct):
    """Title of a report, and paragraphs of its last section, as ``agent.report.html.inline`` takes them."""

    title: str
    words: list[str] = []


def describe(folder: Path, title: str, *words: str) -> None:
    """Write the description of a run for its report."""
    write_whole(folder / ABOUT, msgspec.json.format(msgspec.json.encode(About(title, list(words)))) + b"\n")


def require_report(folder: Path, replace: bool | None) -> None:
    """Raise ``RequestError`` if a file in the place of a folder's report is not a report of ours.

    With ``replace`` true the file may be overwritten; None means that there is no option to do so.
    """
    path = folder / NAME
    if not replace and path.is_file() and MADE_BY not in path.read_bytes():
        ways = "choose another folder" + (", or add --replace to overwrite it" if replace is not None else "")
        raise RequestError(f"{path}: exists and is not a report: {ways}")


def write_report(folder: Path, out: Path | None = None, studies: Sections = ()) -> Path:
    """Write the report of a run, by default into its folder; return its path. Raises as ``report`` does."""
    path = out or folder / NAME
    write_whole(path, report(folder, studies))
    return path


def report(folder: Path, studies: Sections = ()) -> bytes:
    """Return the report of a run; an interrupted run gives an incomplete report.

    ``studies`` are sections for the files of studies. Raises ``ReportError`` if the folder holds nothing to
    report. Raises a ``VitruviusError`` that names the file if a file is damaged or a trace is of another
    version.
    """
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "there is no such folder"
        raise ReportError(f"{folder}: {what}. Name the folder of a run: vitruvius report runs/demo")
    sections = list(_sections(folder, (*SECTIONS[:-1], *studies, SECTIONS[-1])))
    if not sections:
        kinds = "metrics.jsonl, evaluation.json, *.trace.json, house files"
        raise ReportError(f"{folder}: is not a run: it holds none of the files of a report ({kinds})")
    about = _about(folder)
    if about.words:
        words = "\n".join(f"<p>{inline(each)}</p>" for each in about.words)
        sections.append(Section("about", "About this run", words))
    return page(about.title, _lead(found(folder, ("evaluation.json",))), sections)


def _lead(files: Sequence[Path]) -> str:
    """Return the first sentence of a report of agents; a study of houses has none, and needs no agents."""
    if not files:
        return ""
    from vitruvius.agent.report.measured import lead  # here: it imports torch

    return lead(files)


def _sections(folder: Path, known: Sections) -> Iterator[Section]:
    for names, maker in known:
        if files := found(folder, names):
            section = pkgutil.resolve_name(maker)(files, folder)
            if section:
                yield section


def found(folder: Path, names: Sequence[str]) -> list[Path]:
    """Return the files with these names in a folder, and up to two folders below."""
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
        raise ReportError(f"{path}: not a description of a run: {error}") from None
