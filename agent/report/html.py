"""Report: sections under a title, as one self-contained HTML file."""

import base64
import hashlib
import re
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import Any

import msgspec

from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.spelling import markup


class ReportError(VitruviusError):
    """Error for a folder that is absent or no run, or for a damaged file in it."""

    exit_code = 5


FOLDER = Path(__file__).parent

SCRIPTS = ("page", "plans", "picture", "episodes")
"""Files of the page's script, in order."""


@dataclass(frozen=True)
class Section:
    """Part of a report."""

    name: str
    """Anchor in the page: ``#name``."""
    title: str
    html: str


@dataclass(frozen=True)
class Cell:
    """Cell of a table: words, and smaller words below them."""

    text: str
    below: str = ""
    order: float | None = None
    """Key by which rows are sorted in this column; by default the words."""


def page(title: str, lead: str, sections: Sequence[Section]) -> bytes:
    """Return the file; ``lead`` is the sentence below its title, or an empty string.

    The page's content security policy lets a browser fetch nothing and run no script but the page's own.
    """
    style = FOLDER.joinpath("page.css").read_text()
    script = "\n".join(FOLDER.joinpath("script", f"{name}.js").read_text() for name in SCRIPTS)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return (
        Template(FOLDER.joinpath("page.html").read_text())
        .substitute(
            title=markup(title),
            lead=f'<p class="lead">{markup(lead)}</p>' if lead else "",
            links="\n".join(f'<li><a href="#{each.name}">{markup(each.title)}</a></li>' for each in sections),
            sections="\n".join(
                f'<section id="{each.name}"><h2>{markup(each.title)}</h2>\n{each.html}\n</section>'
                for each in sections
            ),
            policy=f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'",
            style=style,
            script=script,
        )
        .encode()
    )


def inline(text: str) -> str:
    """Return a paragraph as HTML, with ``**bold**`` and code between backticks."""
    html = re.sub(r"\*\*(.+?)\*\*", r"<strong>\1</strong>", markup(text))
    return re.sub(r"`(.+?)`", r"<code>\1</code>", html)


def table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[Cell | str]]) -> str:
    """Return a table whose rows a reader can sort by each column; the first cell of a row names it."""
    lines = []
    for row in rows:
        cells = [each if isinstance(each, Cell) else Cell(each) for each in row]
        lines.append("<tr>" + "".join(map(_cell, cells, [True] + [False] * len(cells))) + "</tr>")
    head = "".join(map(_heading, headings))
    return (
        f'<div class="wide"><table class="figures"><caption>{markup(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>\n" + "\n".join(lines) + "\n</tbody></table></div>"
    )


def _heading(words: str) -> str:
    """Return a heading that sorts the table by its column, or an empty cell if there are no words."""
    return f'<th scope="col"><button type="button">{markup(words)}</button></th>' if words else "<td></td>"


def _cell(cell: Cell, first: bool) -> str:
    order = f' data-order="{cell.order:.6g}"' if cell.order is not None else ""
    below = f" <small>{markup(cell.below)}</small>" if cell.below else ""
    content = f"{order}>{markup(cell.text)}{below}"
    kind = ' class="words"' if any(map(str.isalpha, cell.text)) else ""
    return f'<th scope="row"{content}</th>' if first else f"<td{kind}{content}</td>"


def details(summary: str, html: str) -> str:
    """Return HTML that a reader can open and close."""
    return f"<details><summary>{markup(summary)}</summary>\n{html}\n</details>"


def data(name: str, value: Any) -> str:
    """Return a value for the page's script, deflated, under a name."""
    content = base64.b64encode(zlib.compress(msgspec.json.encode(value), 9)).decode()
    return f'<script type="text/plain" id="{name}">{content}</script>'
