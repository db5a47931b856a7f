"""The published schema of briefs is that of the reader, and the example is a brief."""

from pathlib import Path

import pytest

from logic.request.brief import read_brief
from vitruvius.cli import main

ROOT = Path(__file__).parents[3]


def test_the_published_schema_is_that_of_the_reader(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["schema", "--brief"])
    published = (ROOT / "docs" / "brief.schema.json").read_text()
    assert published == capsys.readouterr().out, "./run schema --brief > docs/brief.schema.json"


def test_the_example_is_read() -> None:
    assert read_brief(ROOT / "examples" / "brief.json").names[0] == "Corridor"
