"""What is left to the second part of the tests is there: no claim is lost by a name that has changed."""

from pathlib import Path

import pytest

from tests.second_part import SECOND_PART, of_second_part

TESTS = Path(__file__).parent


@pytest.mark.parametrize("part", SECOND_PART)
def test_what_is_left_to_the_second_part_is_there(part: str) -> None:
    path, _, name = part.partition("::")
    assert (TESTS / path).exists()
    assert not name or f"def {name}(" in (TESTS / path).read_text()


def test_a_part_is_a_folder_a_file_or_a_test() -> None:
    folder = next(part for part in SECOND_PART if not part.endswith(".py") and "::" not in part)
    assert of_second_part(f"{folder}/test_it.py::test_it[1]")
    assert not of_second_part(f"{folder}s/test_it.py::test_it")
    test = next(part for part in SECOND_PART if "::" in part)
    assert of_second_part(test)
    assert not of_second_part(f"{test}_too")
