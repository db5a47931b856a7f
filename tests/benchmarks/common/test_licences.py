"""The notice of licences names the installed packages, and nothing else."""

import re
import subprocess
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

from benchmarks.common.licences import ASKS_MORE, ELSEWHERE, LOCK, licence, locked, notice, parts

pytestmark = pytest.mark.second_part("each study is run in small")

PAGE = LOCK.with_name("THIRD_PARTY_LICENSES.md")


def installed(name: str) -> bool:
    try:
        return bool(distribution(name))
    except PackageNotFoundError:
        return False


def test_the_notice_names_the_packages_and_versions_of_the_lock_and_no_others():
    rows = re.findall(r"^\| ([\w.-]+) \| (\d\S*(?:, \d\S*)*) \|", PAGE.read_text(), re.MULTILINE)
    entries = re.findall(r"^([\w.-]+)==(\S+)", LOCK.read_text(), re.MULTILINE)
    assert sorted((name, version) for name, versions in rows for version in versions.split(", ")) == sorted(
        entries
    )


def test_the_notice_is_what_the_installed_packages_say():
    """Compare the whole notice on Linux; other systems lack some packages, so there only its rows count."""
    if all(map(installed, locked().keys() - ELSEWHERE)):
        assert notice() == PAGE.read_text()
    for name in filter(installed, locked()):
        assert f"| {licence(distribution(name))} |\n" in PAGE.read_text()


def test_what_asks_for_more_than_a_notice_stands_at_the_top():
    top = PAGE.read_text().partition("## What users install")[0]
    assert {"hypothesis", "pathspec", "shapely"} <= set(re.findall(r"[\w-]+", top))
    for name in filter(installed, locked()):
        if ASKS_MORE.search(licence(distribution(name))) or parts(distribution(name)):
            assert re.search(rf"\b{name}\b", top), name


def test_development_alone_needs_what_no_user_installs():
    used = {name for name, (_, used) in locked().items() if used}
    assert {
        "clingo",
        "torch",
        "contourpy",
        "pytest",
    } <= used  # contourpy by matplotlib; pytest by the studies
    assert not {"ruff", "hypothesis", "orjson"} & used


@pytest.mark.parametrize(
    "words", ["GNU General Public License", "either version 2", "if you link this library"]
)
def test_the_header_of_clpr_says_what_the_notice_says(words):
    find = "absolute_file_name(library(clpr), F, [file_type(prolog), access(read)]), write(F)"
    file = subprocess.run(
        ["swipl", "-f", "none", "-g", find, "-t", "halt"], check=True, capture_output=True, text=True
    )
    assert words in Path(file.stdout).read_text()
