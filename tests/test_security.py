"""The page of what is promised to those who use files of others."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "SECURITY.md").read_text()


def test_each_promise_names_the_tests_that_show_it_and_they_exist():
    promises = PAGE.partition("## What is promised")[2].partition("## What is not promised")[0]
    rows = [line for line in promises.splitlines() if line.startswith("| ") and "shown by" not in line]
    assert len(rows) > 10
    for row in rows:
        files = re.findall(r"`(tests/\S+\.py)`", row.split("|")[-2])
        assert files, row
        assert [file for file in files if not (ROOT / file).is_file()] == [], row


def test_the_page_is_short_and_names_no_host():
    assert len(PAGE.splitlines()) <= 120
    assert not re.search(r"https?:|@", PAGE)


def test_the_bounds_that_the_page_states_are_those_of_the_readers():
    from agent.runs import released
    from logic import grammar
    from logic.house import files, parts
    from sim import geometry

    mebi = 1 << 20
    for words in (
        f"{grammar.MOST_BYTES // mebi} MiB in all its rule files",
        f"{files.MOST_BYTES >> 30} GiB unpacked, {files.MOST_LINE // mebi} MiB a house",
        f"{parts.MOST_ROOMS:,} rooms, {parts.MOST_PIECES} pieces a room, {parts.FARTHEST:,.0f} m",
        f"{geometry.FARTHEST:.0f} m to be simulated",
        f"{released.MOST_BYTES // mebi} MiB, {released.MOST_HEADER // mebi} MiB of header",
    ):
        assert words in PAGE
