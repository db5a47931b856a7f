"""A set of houses that several files read."""

from pathlib import Path

import pytest

from tests.logic.dataset.sets import made


@pytest.fixture(scope="session", params=["parquet", "jsonl"])
def of_format(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Generate small houses in three splits, in either format."""
    folder = tmp_path_factory.mktemp(request.param) / "set"
    assert made(folder, "--files", request.param) == 0
    return folder
