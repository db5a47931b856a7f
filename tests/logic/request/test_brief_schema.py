"""The published schema of briefs is the reader's, and the example is a brief."""

import gzip
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from vitruvius.cli import main
from vitruvius.logic.errors import RequestError
from vitruvius.logic.request.brief import MOST_BYTES, read_brief

ROOT = Path(__file__).parents[3]


def test_the_published_schema_is_that_of_the_reader(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["schema", "--brief"])
    published = (ROOT / "docs" / "brief.schema.json").read_text()
    assert published == capsys.readouterr().out, "./run schema --brief > docs/brief.schema.json"


def test_the_example_is_read() -> None:
    assert read_brief(ROOT / "examples" / "brief.json").names[0] == "Corridor"


NO_BRIEFS: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a link to zeros": lambda path: path.symlink_to("/dev/zero"),
    "a bomb": lambda path: path.write_bytes(gzip.compress(bytes(MOST_BYTES + 1))),
    "deep lists": lambda path: path.write_bytes(b'{"rooms": ' + b"[" * 99_999),
    "a number of 5,000 digits": lambda path: path.write_bytes(b'{"area": ' + b"1" * 5000 + b"}"),
}


@pytest.mark.parametrize("kind", NO_BRIEFS)
def test_a_file_that_is_no_brief_is_refused_in_a_line_and_not_waited_for(kind: str, tmp_path: Path) -> None:
    NO_BRIEFS[kind](tmp_path / "brief.json")
    with pytest.raises(RequestError, match=r"\Abrief: .*brief\.json (cannot be read|is not JSON): .+\Z"):
        read_brief(tmp_path / "brief.json")
