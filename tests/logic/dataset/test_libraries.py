"""Common libraries read a set as it is, by their own means."""

import json
from pathlib import Path
from typing import Any

import pytest

from vitruvius.logic import HouseSet, load
from vitruvius.logic.dataset.rows import house_of, house_sha256
from vitruvius.logic.dataset.sets import read_set

pytestmark = pytest.mark.second_part("pandas, polars, DuckDB, datasets and Croissant's reader are imported")

SPLITS = {"train": 12, "validation": 3, "test": 2}


@pytest.fixture
def files(of_format: Path) -> str:
    """Return a pattern for all shards."""
    return str(of_format / "data" / f"*.{kind(of_format)}")


def kind(folder: Path) -> str:
    found = read_set(folder)
    assert found
    return found.files


def require_same(folder: Path, rows: list[dict[str, Any]], off: float = 0.0) -> None:
    """Check that rows are those of the set, each with the house of its hash or lengths off by ``off``."""
    of = read_set(folder)
    assert of
    own = {row["id"]: row for row in HouseSet(folder).rows()}
    assert len(rows) == len(own) == 17
    for row in rows:
        assert row["area"] == pytest.approx(own[row["id"]]["area"], rel=off, abs=0)
        assert list(row["types"]) == own[row["id"]]["types"]
        house = house_of(own[row["id"]] | {"house": row["house"]}, of.versions, of.promises)
        assert house
        assert [room.x for room in house.rooms] == pytest.approx(
            [room["x"] for room in own[row["id"]]["house"]["rooms"]], rel=off, abs=0
        )
        assert off or house_sha256(house) == row["sha256"]


def test_hugging_face_datasets_reads_the_splits_that_the_card_names(of_format: Path, tmp_path: Path) -> None:
    import datasets

    found = datasets.load_dataset(str(of_format), cache_dir=str(tmp_path))
    assert {name: len(split) for name, split in found.items()} == SPLITS
    require_same(of_format, [dict(row) for split in found.values() for row in split])


def test_pandas_reads_rows_with_their_nested_houses(of_format: Path) -> None:
    import pandas

    paths = sorted((of_format / "data").iterdir())
    if kind(of_format) == "parquet":
        table = pandas.concat([pandas.read_parquet(path) for path in paths])
    else:
        table = pandas.concat([pandas.read_json(path, lines=True, precise_float=True) for path in paths])
    assert dict(table.groupby("split").size()) == SPLITS
    rows = [{**row, "house": plain(row["house"])} for row in table.to_dict("records")]
    require_same(of_format, rows)


def plain(value: Any) -> Any:
    """Return a value without NumPy's arrays and numbers."""
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    return [plain(each) for each in value] if isinstance(value, list) else value


def test_polars_reads_rows_with_their_nested_houses(of_format: Path, files: str) -> None:
    import polars

    table = polars.read_parquet(files) if files.endswith("parquet") else polars.read_ndjson(files)
    assert dict(table.group_by("split").len().iter_rows()) == SPLITS
    # It reads numbers of JSON to the last bit but one.
    require_same(of_format, table.to_dicts(), off=0.0 if files.endswith("parquet") else 1e-15)


def test_duckdb_asks_for_rows_and_parts_of_houses_by_sql(of_format: Path, files: str) -> None:
    import duckdb

    asked = duckdb.connect()
    table = asked.execute(f"select * from '{files}'")
    columns = [column[0] for column in table.description or ()]
    require_same(of_format, [dict(zip(columns, row, strict=True)) for row in table.fetchall()])
    pieces = f"select unnest(house.pieces) as piece from '{files}'"
    [beds] = asked.execute(f"select count(*) from ({pieces}) where piece.type = 'bed'").fetchall()
    own = [piece.type for house in load(of_format) for room in house.rooms for piece in room.pieces]
    assert beds == (own.count("bed"),)


def test_croissants_reader_validates_the_description_and_reads_by_it(
    of_format: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import mlcroissant

    monkeypatch.chdir(of_format)
    described = mlcroissant.Dataset("croissant.json")
    assert not described.metadata.ctx.issues.errors
    own = {row["id"]: row for row in HouseSet(of_format).rows()}
    found = list(described.records("houses"))
    assert len(found) == 17
    for record in found:
        row = own[text(record["houses/id"])]
        assert record["houses/area"] == row["area"]
        assert text(record["houses/sha256"]) == row["sha256"]
        assert [text(each) for each in record["houses/types"]] == row["types"]
    said = json.loads(Path("croissant.json").read_text())
    assert {each["name"] for each in said["recordSet"][0]["field"]} == {*next(iter(own.values()))} - {"house"}


def text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else value
