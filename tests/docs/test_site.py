"""Site: it builds without a warning, its pages need no network, and their search needs no server."""

import json
import sys
import tomllib
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

import pytest
from playwright.sync_api import Page

from docs.builder.build import Copy, pages_of
from tests.browsing import cut_on_paper, findings, too_wide
from tests.docs.reader import ROOT
from tests.programs import finished
from vitruvius.agent.report.folder import write_report
from vitruvius.logic import generate, save
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("all commands of pages are run, and the site is opened in a browser")

BUILD = [sys.executable, "-m", "docs.builder.build"]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site as ``./run site`` does after the demo, with the report of a run of one house."""
    run = tmp_path_factory.mktemp("docs")
    save(generate(rooms=2), run / "houses.jsonl")
    write_report(run)
    built = finished([*BUILD, "--out", str(run / "site"), "--run", str(run)])
    assert (built.returncode, built.stdout) == (0, ""), built.stderr
    index, folder = run / "site" / "index.html", run / "site"
    assert built.stderr == f"{index}: open it in a browser, or publish the folder {folder}\n"
    return folder


class Links(HTMLParser):
    """Links and pictures of a page, and its anchors."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.anchors: set[str] = set()
        self.feed(file.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.links |= {values[name] or "" for name in ("href", "src") if name in values}
        self.anchors |= {values[name] or "" for name in ("id", "name") if name in values}


def broken(site: Path) -> Iterator[str]:
    """Yield links to files or anchors that the site lacks."""
    pages = {file: Links(file) for file in site.rglob("*.html") if file.name != "404.html"}
    for file, page in pages.items():
        for link in page.links:
            address, anchor = urldefrag(link)
            if not urlsplit(address).scheme and address not in {"", "."}:
                target = (file.parent / unquote(address)).resolve()
                there = target.exists() and (not anchor or anchor in pages[target].anchors)
                if not there:
                    yield f"{file.relative_to(site)}: {link}"


def test_every_link_between_its_pages_leads_somewhere(site: Path) -> None:
    assert not [*broken(site)]


def test_it_has_the_playground_and_the_report_of_the_run(site: Path) -> None:
    assert {"../playground/index.html", "../report.html"} <= Links(site / "docs/try.html").links
    assert "family" in json.loads((site / "playground/rules.json").read_text())["grammars"]
    assert (site / "report.html").read_bytes() == (site.parent / "report.html").read_bytes()


def test_it_has_every_page_of_the_documentation(site: Path) -> None:
    pages = {file.relative_to(ROOT) for file in (ROOT / "docs").rglob("*.md")}
    named = {file.with_suffix(".html").with_stem(file.stem.replace("README", "index")) for file in pages}
    assert not [str(file) for file in named if not (site / file).exists()]


def test_its_menu_names_every_page_of_the_documentation() -> None:
    nav = tomllib.loads((ROOT / "docs/builder/zensical.toml").read_text())["project"]["nav"]
    pages = {file.relative_to(ROOT).as_posix() for file in (ROOT / "docs").rglob("*.md")}
    assert pages - {*pages_of(nav)} == set()


def test_its_reference_has_all_public_names(site: Path) -> None:
    import vitruvius
    from vitruvius import sim

    for package in (vitruvius, sim):
        anchors = Links(site / f"docs/reference/{package.__name__.rpartition('.')[2]}.html").anchors
        assert {*package.__all__} <= {anchor.rpartition(".")[2] for anchor in anchors}


def test_the_notebook_ran_and_shows_its_plan(site: Path) -> None:
    shown = (site / "examples/first_steps.html").read_text()
    assert "There is a house with --rooms 2" in shown
    assert "<svg" in (site / "examples/cell-2-0.svg").read_text()


def test_opened_as_a_file_it_finds_words_and_asks_nothing_of_a_network(site: Path, page: Page) -> None:
    page.goto((site / "index.html").as_uri())
    page.keyboard.press("Control+k")
    page.keyboard.type("washing machine")
    page.get_by_text("4 results").wait_for()
    page.keyboard.press("Enter")
    page.wait_for_url("**/room-type.html*")
    assert page.locator("h1").inner_text().startswith("A room type")
    assert page.evaluate("[...document.images].every(image => image.complete && image.naturalWidth > 0)")


@pytest.mark.parametrize(
    "name",
    [
        "index",
        "docs/try",
        "docs/gallery",
        "docs/command-line",
        "docs/reference/schema",
        "examples/first_steps",
    ],
)
def test_pages_fit_screens_and_paper_and_axe_finds_nothing(site: Path, page: Page, name: str) -> None:
    page.goto((site / f"{name}.html").as_uri())
    assert findings(page) == []
    assert too_wide(page) == []
    assert cut_on_paper(page) == []


BROKEN = """() => [...document.querySelectorAll("td code")].filter((each) => {
    const lines = new Set([...each.getClientRects()].map(({ top }) => Math.round(top)));
    return lines.size > each.textContent.trim().split(/[\\s(-]+/).length;
}).map((each) => each.textContent)"""
"""Script that lists code in tables with more lines than words; a bracket begins a word."""


@pytest.mark.parametrize("name", ["docs/rules", "docs/plans", "docs/playground"])
def test_words_of_rules_in_tables_are_whole_on_a_telephone(site: Path, phone: Page, name: str) -> None:
    phone.goto((site / f"{name}.html").as_uri())
    assert phone.evaluate(BROKEN) == []
    assert too_wide(phone) == []


def test_a_link_that_leads_nowhere_stops_the_build(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    with pytest.raises(RequestError, match=r"docs/plans.md: there is no docs/nowhere.md"):
        copy.line(Path("docs/plans.md"), "see [this](nowhere.md)")


def test_a_folder_that_is_no_site_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "mine").touch()
    ended = finished([*BUILD, "--out", str(tmp_path)])
    assert ended.returncode == 2
    assert "already exists, and is not a site" in ended.stderr
    assert (tmp_path / "mine").exists()
