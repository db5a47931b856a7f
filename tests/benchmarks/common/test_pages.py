"""Published pages."""

import pytest

from benchmarks.common import pages

pytestmark = pytest.mark.second_part("each study is run in small")


def test_a_published_page_keeps_what_is_written_by_hand(tmp_path, monkeypatch):
    docs, out = tmp_path / "docs", tmp_path / "out"
    docs.mkdir()
    monkeypatch.setattr(pages, "DOCS", docs)
    (docs / "a.md").write_bytes(b"old\n" + pages.BY_HAND + b"kept\n")
    pages.write({"a.md": b"new\n", "b.md": b"other\n"}, out, publish=True)
    assert (docs / "a.md").read_bytes() == b"new\n\n" + pages.BY_HAND + b"kept\n"
    assert (docs / "b.md").read_bytes() == b"other\n"
    assert (out / "a.md").read_bytes() == b"new\n"
