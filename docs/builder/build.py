"""Builder of the site: ``./run site`` writes it into ``runs/site``, a folder for any web server.

The site has the documentation, the playground and a report. Pages are Markdown files of the checkout, which
also read well where they are. The builder copies them with everything that they link to, and adds the pages
that are made from code (``pages.py``). Zensical makes HTML of the pages, and fails at a link or an anchor
that leads nowhere. The documentation also opens from a folder, without a server or a network.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import tyro

from docs.builder.pages import MADE, listing, source
from vitruvius.logic.browser.playground import folder as playground
from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.terminal import say

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent

FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"(?<=\]\()(?!\w+:|#)([^)\s#]+)(#[^)]*)?(?=\))")
ITEM = re.compile(r"^([-*]|\d+\.) ")
SOURCES = {".lp", ".pl", ".py", ".toml"}
"""Suffixes of files that become pages of code when a page links to them."""
HEADING = re.compile(r"<th( [^>]*)?></th>")
"""Pattern of an empty heading cell: Markdown's tables need a row of headings."""
STATIC = ("buttons.js", "iframe-worker.js", "site.css")


@dataclass
class Copy:
    """Copy of the site's pages, in a folder of their own, laid out as in the checkout."""

    folder: Path
    done: set[Path] = field(default_factory=set)
    """Paths that have been copied or are being copied, from the checkout's root."""

    def page(self, path: Path) -> None:
        """Copy a Markdown file, or make the page that has this path, and copy all that it links to."""
        made = MADE.get(path.as_posix())
        text = made(self.folder / path.parent) if made else (ROOT / path).read_text()
        self.write(path, "\n".join(_outside_code(text, lambda line: self.line(path, line))))

    def line(self, page: Path, line: str) -> str:
        """Return a line of a page with links to pages of the site; code has no links."""

        def leads(link: re.Match[str]) -> str:
            return self.link(page, link[1]) + (link[2] or "")

        parts = line.split("`")
        return "`".join(part if place % 2 else LINK.sub(leads, part) for place, part in enumerate(parts))

    def link(self, page: Path, address: str) -> str:
        """Copy what a page links to, and return its address on the site."""
        path = Path(os.path.normpath(page.parent / address))
        if path.is_absolute() or path.parts[:1] == ("..",):
            raise RequestError(f"{page}: the link {address} leads out of the project")
        return os.path.relpath(self.copy(path, page), page.parent)

    def copy(self, path: Path, page: Path) -> Path:
        """Copy a file or folder that a page links to; return the path of its page, or of the file itself."""
        if (self.folder / path).is_file():  # copied, or a picture that a page made
            return path
        made = path.as_posix() in MADE
        if not made and not (ROOT / path).exists():
            raise RequestError(f"{page}: there is no {path}, to which it links")
        if (ROOT / path / "README.md").exists():
            path = path / "README.md"
        target, write = path, self.file
        if made or path.suffix == ".md":
            write = self.page
        elif (ROOT / path).is_dir():
            target, write = path / "index.md", self.listing
        elif path.suffix in SOURCES:
            target, write = path.with_name(path.name + ".md"), self.source
        if target not in self.done:
            self.done.add(target)
            write(path)
        return target

    def listing(self, path: Path) -> None:
        """Write the page of a folder, and copy the files in it."""
        self.write(path / "index.md", listing(ROOT / path, self.line))

    def source(self, path: Path) -> None:
        """Write the page of a file of code."""
        self.write(path.with_name(path.name + ".md"), source(path, (ROOT / path).read_text()))

    def file(self, path: Path) -> None:
        """Copy a file as it is."""
        self.write(path, (ROOT / path).read_bytes())

    def write(self, path: Path, content: str | bytes) -> None:
        """Write a file of the site."""
        file = self.folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.encode() if isinstance(content, str) else content)


def _outside_code(text: str, change: Callable[[str], str]) -> Iterator[str]:
    """Yield the lines of a page, changed outside blocks of code, with a blank line before each list.

    GitHub needs no blank line between a paragraph and a list; Python's Markdown does.
    """
    code, before = False, ""
    for line in text.splitlines():
        fence = FENCE.match(line)
        code = code != bool(fence)
        if code or fence:
            yield line
        else:
            if ITEM.match(line) and before and not ITEM.match(before) and not before.startswith(" "):
                yield ""
            yield change(line)
        before = line


def pages_of(nav: list) -> Iterator[str]:
    """Yield the pages that a navigation of Zensical names."""
    for entry in nav:
        for value in entry.values():
            yield from pages_of(value) if isinstance(value, list) else [value]


def build(out: Path, report: Path) -> None:
    """Write the site, with this report, into a folder, which it replaces.

    Raises ``RequestError`` for an error in a page, and what the playground's ``write`` raises.
    """
    config = (HERE / "zensical.toml").read_text()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        copy = Copy(folder / "pages")
        playground.write(copy.folder / "playground")
        copy.write(Path("report.html"), report.read_bytes())
        for page in pages_of(tomllib.loads(config)["project"]["nav"]):
            copy.copy(Path(page), Path("docs/builder/zensical.toml"))
        for static in STATIC:
            copy.file(HERE.relative_to(ROOT) / static)
        (folder / "zensical.toml").write_text(config)
        command = [sys.executable, "-m", "zensical", "build", "--strict", "-f", str(folder / "zensical.toml")]
        environment = os.environ | {"PYTHONPATH": str(ROOT), "NO_COLOR": "1"}
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if ended.returncode:
            raise RequestError(f"the site was not built:\n{ended.stderr.partition('Traceback')[0]}")
        for page in (folder / "site").rglob("*.html"):
            page.write_text(HEADING.sub(r"<td\1></td>", page.read_text()))
        shutil.rmtree(out, ignore_errors=True)
        shutil.move(folder / "site", out)


def _report(run: Path) -> Path:
    """Return the report of a run, after the demo has made it if it is missing."""
    report = run / "report.html"
    if not report.exists():
        say(f"{report}: missing, so that the demo runs first")
        demo = [sys.executable, "-m", "vitruvius.cli", "demo", "--out", str(run)]
        if failed := subprocess.run(demo, check=False).returncode:
            sys.exit(failed)
    return report


def main(out: Path = ROOT / "runs" / "site", run: Path = ROOT / "runs" / "demo") -> None:
    """Build the site with the report of a run: by default the demo's, which is run if there is none."""
    try:
        if out.exists() and not (out / "sitemap.xml").exists():
            raise RequestError(f"--out {out}: already exists, and is not a site: choose a new folder")
        build(out, _report(run))
    except VitruviusError as error:
        say(f"error: {error}")
        sys.exit(error.exit_code)
    say(f"{out / 'index.html'}: open it in a browser, or publish the folder {out}")


if __name__ == "__main__":
    tyro.cli(main)
