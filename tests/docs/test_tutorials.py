"""What the tutorials tell their readers to write and to run, written and run."""

from pathlib import Path

import pytest

from tests.docs.reader import ROOT, Reader, pictures

PAGES = [*sorted((ROOT / "docs" / "tutorials").glob("*.md")), ROOT / "docs" / "gallery.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_can_be_followed_and_shows_the_pictures_that_come_out(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Reader(tmp_path, monkeypatch).follow(page)
    for file, picture in pictures(page).items():
        same = file.read_bytes() == picture.read_bytes()
        assert same, f"{picture.name} is another: ./run python -m tests.docs.reader draws all pictures again"
