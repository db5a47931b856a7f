"""The tests of the second part exist: no claim is lost by a changed name."""

from pathlib import Path

import pytest

from tests.second_part import SECOND_PART, of_second_part

TESTS = Path(__file__).parent


@pytest.mark.parametrize("part", SECOND_PART)
def test_what_is_left_to_the_second_part_is_there(part: str) -> None:
    assert (TESTS / part).exists()
    what = SECOND_PART[part]
    names = what if isinstance(what, dict) else ()
    assert all(f"def {name}(" in (TESTS / part).read_text() for name in names)


def test_a_part_is_a_folder_a_file_or_some_tests_of_one() -> None:
    folder = next(part for part in SECOND_PART if not part.endswith(".py"))
    file = next(part for part, what in SECOND_PART.items() if part.endswith(".py") and isinstance(what, str))
    some, names = next((part, what) for part, what in SECOND_PART.items() if isinstance(what, dict))
    for test in (f"{folder}/test_it.py::test_it[1]", f"{file}::test_it", f"{some}::{next(iter(names))}[1]"):
        assert of_second_part(test)
    for test in (f"{folder}s/test_it.py::test_it", f"{some}::{next(iter(names))}_too"):
        assert not of_second_part(test)
