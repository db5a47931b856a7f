"""Page of the promises to users of untrusted files."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "SECURITY.md").read_text()


def test_each_promise_names_the_tests_that_show_it_and_they_exist():
    promises = PAGE.partition("## Promises")[2].partition("## Limits of the promises")[0]
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
    from vitruvius.agent.runs import released
    from vitruvius.logic import grammar, opener
    from vitruvius.logic.files import house_files
    from vitruvius.logic.house import occupancy, parts
    from vitruvius.logic.readers.regular import MAX_CORNERS as of_rooms
    from vitruvius.logic.readers.sketch import MAX_CORNERS, MAX_CROSSINGS
    from vitruvius.logic.request import brief, given_plan
    from vitruvius.sim import geometry

    mebi = 1 << 20
    for words in (
        f"{grammar.MOST_BYTES // mebi} MiB in all its rule files",
        f"{house_files.MOST_BYTES >> 30} GiB unpacked, {house_files.MOST_LINE // mebi} MiB a house",
        f"{parts.MOST_ROOMS:,} rooms, {parts.MOST_PIECES} pieces a room, {parts.MAX_COORDINATE_M:,.0f} m",
        f"{geometry.MAX_COORDINATE_M:.0f} m to be simulated",
        f"{opener.MAX_BYTES // mebi} MiB, {opener.MAX_DEPTH} levels",
        f"{opener.MAX_VALUES:,} values, and numbers of {opener.MAX_DIGITS} digits",
        f"{brief.MOST_BYTES // mebi} MiB unpacked, {brief.MOST_ROOMS} rooms",
        f"{given_plan.MOST_BYTES // mebi} MiB unpacked; of an archive {opener.MAX_MEMBERS:,} files",
        f"{parts.MOST_OPENINGS:,} doors and windows; {MAX_CORNERS:,} corners",
        f"cross {MAX_CROSSINGS:,} times, and {of_rooms:,} along the axes",
        f"{parts.MAX_HOUSE_PIECES:,} pieces in all rooms",
        f"{occupancy.MAX_RUNS:,} runs of equal cells",
        f"{released.MAX_BYTES // mebi} MiB, {released.MAX_HEADER_BYTES // mebi} MiB of header",
    ):
        assert words in PAGE


MODULES = {
    "marshal",
    "np.load",
    "numpy.load",
    "pickle",
    "runpy",
    "shelve",
    "subprocess",
    "torch.load",
    "yaml",
}
"""Modules and functions that run or create what a text states."""

CALLS = {
    *("__import__", "compile", "eval", "exec", "import_module", "resolve_name", "spec_from_file_location"),
    *("execv", "execve", "execvp", "fork", "popen", "posix_spawn", "system"),
}
"""Functions, of any module, that do the same."""


def calls(path: Path) -> Iterator[str]:
    """Yield the calls of a file that run text or create objects from it."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call):
            full = ast.unparse(node.func)
            module, _, name = full.rpartition(".")
            is_method = name in ("compile", "eval") and module  # of a network, of a regular expression
            if (name in CALLS and not is_method) or {module, full} & MODULES:
                yield full


def test_every_place_where_text_becomes_an_import_a_program_or_an_object_is_on_the_page():
    table = PAGE.partition("text becomes | where")[2].partition("\n\n`tests")[0]
    named = set(re.findall(r"`([a-z_/]+\.py)`", table))
    packages = ("logic", "sim", "agent", "vitruvius")
    paths = sorted(path for package in packages for path in (ROOT / package).rglob("*.py"))
    found = {path.relative_to(ROOT).as_posix() for path in paths if any(calls(path))}
    assert found == named - {"logic/spelling.py"}


def test_no_script_of_a_page_makes_tags_of_text():
    scripts = [*(ROOT / "agent/report").rglob("*.js"), *(ROOT / "logic/browser").rglob("*.js")]
    scripts = [path for path in scripts if "node_modules" not in path.parts]
    forbidden = (
        r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|ContextualFragment|\beval\(|new Function"
    )
    assert [path.name for path in scripts if re.search(forbidden, path.read_text())] == []
    parsers = {path.relative_to(ROOT).as_posix() for path in scripts if "DOMParser" in path.read_text()}
    assert all(f"`{path}`" in PAGE for path in parsers)
