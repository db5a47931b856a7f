"""ARCHITECTURE.md matches the code: its picture, and the files and classes that it names. It is short."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.architecture import FILE, picture
from tests.test_imports import ROOT, modules

pytestmark = pytest.mark.second_part("all commands of pages are run, and the site is opened in a browser")

TEXT = (ROOT / "ARCHITECTURE.md").read_text()
NAMED = re.compile(r"`([\w./-]*\w(?:/|\.(?:py|lp|pl|json|md|css|js|toml|lock|svg)))`")
PAGES = [page for page in ROOT.glob("*.md") if page.stem != "CHANGELOG"]
PAGES += [*(ROOT / "docs").rglob("*.md")]


def test_the_picture_is_drawn_from_the_code() -> None:
    assert FILE.read_text() == picture(), "./run python -m tests.docs.architecture"


def test_every_path_that_it_names_exists() -> None:
    paths = [path for line in TEXT.splitlines() for path in named(line)]
    assert len(paths) > 80
    assert not [path for path in paths if not (ROOT / path).exists()]


def named(line: str) -> Iterator[Path]:
    """Yield the paths that a line names: a name alone is in the folder of the path before it."""
    folder = Path()
    for name in NAMED.findall(line):
        path = Path(name) if "/" in name.rstrip("/") or (ROOT / name).exists() else folder / name
        yield path
        folder = path if (ROOT / path).is_dir() else path.parent


def test_every_class_that_its_glossary_names_exists() -> None:
    named = set(re.findall(r"`([A-Z][a-z]\w+)`", section("Words")))
    sources = "\n".join(file.read_text() for file in modules().values())
    assert len(named) > 8
    assert named <= set(re.findall(r"^class (\w+)", sources, re.MULTILINE))


def section(title: str) -> str:
    """Return the text of a section."""
    return TEXT.split(f"\n## {title}\n")[1].split("\n## ")[0]


def test_it_is_short() -> None:
    assert max(map(len, TEXT.splitlines())) <= 118
    assert len(section("Words").splitlines()) <= 60
    assert len(section("Files to change").splitlines()) <= 40


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_files_that_a_page_links_to_or_names_exist(page: Path) -> None:
    """The test needs no site, which is slow to build."""
    text = page.read_text()
    links = [page.parent / link for link in re.findall(r"\]\((?!\w+:|#)([^)\s#]+)", text)]
    names = re.findall(r"`((?:logic|sim|agent|vitruvius|benchmarks|tests|docs|examples)/[\w./-]*\w/?)`", text)
    assert not [path for path in [*links, *(ROOT / name for name in names)] if not path.exists()]
