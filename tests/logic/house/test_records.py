"""House files of the current format are read back, mistakes are named, and the schema agrees."""

import copy
import json
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.logic.house.handmade import houses
from tests.plans import PLANS
from tests.sample_houses import FIXTURES, changed_record, random_house
from vitruvius.cli import main
from vitruvius.logic import FreeWall, House, check, load, save
from vitruvius.logic.house.records import schema
from vitruvius.logic.request.geojson import from_geojson

SCHEMA = schema()
RECORDS = [json.loads(json.dumps(house.to_dict())) for house in PLANS.values()]
RECORD = RECORDS[0]

STATED = re.compile(
    "appears twice|must not be named outside|no hub|there is no room|joins .* with itself|must be a segment"
    "|sizes must be positive|must have a length|lies beyond 1000 m|at most 256|topology (star|original)"
    "|request.cell"
)
"""Errors of the reader that a schema cannot express: see ``logic.house.records.schema``."""


def test_the_hand_made_plans_are_read_as_they_were_written() -> None:
    assert load(FIXTURES / "plans.jsonl") == list(PLANS.values())


@settings(max_examples=20)
@given(houses(), st.booleans())
def test_a_converted_star_is_the_same_house_and_its_file_can_be_written_back(house: House, old: bool) -> None:
    house = House.of_star(house.star, "original") if old else house
    new = House.from_dict(json.loads(json.dumps(house.converted().to_dict())))
    assert new == house.converted() != house
    assert replace(new, format=house.format) == house
    assert House.from_dict(house.to_dict()) == house


def test_a_file_of_any_format_is_converted_by_a_command(tmp_path: Path) -> None:
    (example,) = load(FIXTURES / "example1.json")
    save([example, *PLANS.values()][:1], tmp_path / "old.jsonl")
    with pytest.raises(SystemExit) as end:
        main(["convert", str(tmp_path / "old.jsonl"), "--out", str(tmp_path / "new.jsonl.gz")])
    assert end.value.code == 0
    (new,) = load(tmp_path / "new.jsonl.gz")
    assert (new.format, new.topology, new.hub) == ("vitruvius-2", "original", "main")
    assert new.star == example.star


def test_a_house_that_is_no_star_cannot_be_written_as_one() -> None:
    with pytest.raises(ValueError, match="topology is ring: only a star has a main room"):
        replace(PLANS["flat"], format="vitruvius-1").to_dict()


def test_walls_that_stand_by_themselves_are_read_as_they_were_written_but_a_star_file_has_none() -> None:
    walls = FreeWall(1, 1, 2.5, 2, 0.1), FreeWall(3, 0, 3, 2, 0)
    house = replace(PLANS["flat"], free_walls=walls)
    record = json.loads(json.dumps(house.to_dict()))
    assert record["walls"][0] == [1, 1, 2.5, 2, 0.1]
    assert House.from_dict(record) == house
    assert accepts(SCHEMA, record)
    assert [wall.box for wall in walls] == [None, (3, 0, 3, 2)]
    star = replace(random_house(1), free_walls=walls)
    with pytest.raises(ValueError, match="the format vitruvius-1 does not support free walls: write"):
        star.to_dict()
    assert House.from_dict(star.converted().to_dict()).free_walls == walls


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("rooms", [], r"Expected `array` of length >= 1 - at `\$.rooms`"),
        ("rooms", ..., "missing required field `rooms`"),
        ("unit", ..., "missing required field `unit`"),
        ("unit", "px", r"Invalid enum value 'px' - at `\$.unit`"),
        ("colour", "red", "unknown field `colour`"),
        ("rooms.3.door", {}, r"unknown field `door` - at `\$.rooms\[3\]`"),
        ("rooms.3.storey", 1, r"Invalid enum value 1 - at `\$.rooms\[3\].storey`"),
        ("rooms.3.name", " R3", r"matching regex .* - at `\$.rooms\[3\].name`"),
        ("rooms.3.name", "R2", "rooms: the name R2 appears twice"),
        ("rooms.3.name", "outside", "rooms: a room must not be named outside: entrances lead there"),
        ("rooms.3.width", 0.0, "R3 is 0.0 by 3.6: sizes must be positive"),
        ("rooms.3.x", 1e9, "R3 lies beyond 1000 m or is not a number"),
        ("rooms.3.x", float("nan"), "R3 lies beyond 1000 m or is not a number"),
        ("rooms.1.children.0.width", -1.0, r"R1, piece 0 \(bed\) is -1.0 by 2.1: sizes must be positive"),
        ("rooms.1.children", 300 * [RECORD["rooms"][1]["children"][0]], "R1 has 300 pieces: at most 256"),
        ("hub", "R9", "hub: there is no room R9: there are R0, R1"),
        ("doors.0.between", ["R0"], r"Expected `array` of length 2"),
        ("doors.0.between", ["R0", "R11"], r"doors\[0\]: there is no room R11: did you mean R1\?"),
        ("doors.0.between", ["R0", "R0"], r"doors\[0\]: joins R0 with itself"),
        ("doors.0.height", 0.5, r"doors\[0\] must be a segment: its width or its height is zero"),
        ("windows.1.room", "outside", r"windows\[1\]: there is no room outside: there are R0"),
        ("windows.1.width", 0.0, r"windows\[1\] must be a segment"),
        ("topology", "star", "topology star: R1: a room of a star has one door, to R0"),
        ("walls", [[0, 0, 1, 1]], r"Expected `array` of (at least )?length 5"),
        ("walls", [[0, 0, 1, 1, -0.1]], r"walls\[0\] must have a length, and a thickness of at least 0"),
        ("walls", [[0, 0, 1, 1, 0], [2, 3, 2, 3, 0.1]], r"walls\[1\] must have a length"),
        ("walls", [[0, 0, 1e9, 1, 0]], r"walls\[0\] lies beyond 1000 m or is not a number"),
        ("provenance", {"grammar": "home"}, "missing required field `grammar_hash`"),
    ],
)
def test_a_wrong_record_is_refused_by_the_name_of_its_field(path: str, value: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        House.from_dict(changed_record(RECORD, path, value))


def test_the_published_schema_is_that_of_the_reader(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["schema"])
    published = Path(__file__).parents[3] / "docs" / "house.schema.json"
    assert published.read_text() == capsys.readouterr().out, "./run schema > docs/house.schema.json"


PAGE = (Path(__file__).parents[3] / "docs" / "house-file.md").read_text()


def test_the_page_about_house_files_shows_a_house_that_conforms_and_a_plan_that_is_read() -> None:
    example, plan = re.findall(r"```json\n(.*?)```", PAGE, re.DOTALL)
    drawn, _ = from_geojson(json.loads(plan))
    (room,) = drawn.rooms
    assert (room.name, room.width, room.height) == ("hall", 2.5, 4)
    assert accepts(SCHEMA, json.loads(example))
    assert check(House.from_dict(json.loads(example))) == []


TABLES = {"House": "A house", "Room": "A room", "Piece": "A piece", "Door": "A door", "Window": "A window"}
TABLES |= {"OccupancyGrid": "A map", "Provenance": "Provenance", "Promises": "Fields of promises"}
"""Titles on the page of the tables with the fields of each part."""


def table(title: str) -> dict[str, str]:
    """Return the first table after a bold title on the page: fields, and their values."""
    text = PAGE.partition(f"**{title}")[2].partition("\n|---")[2].partition("\n\n")[0]
    return dict(re.findall(r"^\| `(\w+)` \| (.+?) \| .+ \|$", text, re.MULTILINE))


def test_the_page_about_house_files_names_all_fields_of_a_stars_file() -> None:
    record = random_house(1).to_dict()
    rooms = [each for name, each in record.items() if re.fullmatch(r"R\d+", name)]
    others = {name for name in record if not re.fullmatch(r"R\d+", name)}
    assert set(table("A star")) == others | {"provenance"}
    for room in rooms:
        assert set(table("A rectangle") | table("A room of a star")) == set(room)


@pytest.mark.parametrize("part", TABLES)
def test_the_page_about_house_files_says_of_each_field_what_its_values_are(part: str) -> None:
    fields, rule = table(TABLES[part]), SCHEMA["$defs"][part]
    if {"x", "y", "width", "height"} <= set(rule["properties"]):
        fields = table("A rectangle") | fields
    assert set(fields) == set(rule["properties"])
    for name, said in fields.items():
        values = [rule["properties"][name], *rule["properties"][name].get("anyOf", [])]
        # The page says above the table how many types and relations a promise names.
        bounds = [each[key] for each in values for key in BOUNDS if each.get(key, 2) not in (2, 64, 512)]
        words = [str(word) for each in values for word in each.get("enum", [])]
        assert all(re.search(rf"(?<![\w.]){re.escape(f'{each:g}')}(?![\w.])", said) for each in bounds), (
            name,
            said,
        )
        assert all(word in said for word in words), (name, said)
        if part != "Promises":
            assert ("optional" in said) == (name not in rule["required"]), (name, said)


BOUNDS = ("minimum", "maximum", "maxItems")
"""Bounds of numbers and lists that both the schema and the page state; pairs are described in words."""


def accepts(rule: dict[str, Any], value: Any) -> bool:  # noqa: PLR0911
    """Return True if a JSON Schema, with the keywords of ours, accepts a value."""
    if "$ref" in rule:
        return accepts(SCHEMA["$defs"][rule["$ref"].rpartition("/")[2]], value)
    if "anyOf" in rule and not any(accepts(one, value) for one in rule["anyOf"]):
        return False
    if "enum" in rule and not any(value == one and type(value) is type(one) for one in rule["enum"]):
        return False
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "integer": int,
        "number": int | float,
        "null": type(None),
    }
    if "type" in rule and (not isinstance(value, kinds[rule["type"]]) or isinstance(value, bool)):
        return False
    match value:
        case dict():
            known, more = rule.get("properties", {}), rule.get("additionalProperties", True)
            if not set(rule.get("required", ())) <= set(value) or (more is False and set(value) - set(known)):
                return False
            default = more if isinstance(more, dict) else {}
            return all(accepts(known.get(key, default), item) for key, item in value.items())
        case list():
            first, rest = rule.get("prefixItems", []), rule.get("items", {})
            pairs = [*zip(first, value, strict=False), *((rest or {}, item) for item in value[len(first) :])]
            size = rule.get("minItems", 0) <= len(value) <= rule.get("maxItems", len(value))
            return size and all(accepts(*pair) for pair in pairs)
        case str():
            return len(value) <= rule.get("maxLength", len(value)) and bool(
                re.search(rule.get("pattern", ""), value)
            )
        case int() | float():
            return rule.get("minimum", value) <= value <= rule.get("maximum", value)
    return True


scalars = st.sampled_from(
    [None, True, 0, 1, -1, 7, 0.5, -0.5, 1e4, 1e300, "", "m", "R1", "R9", "outside", "N", "star", [], {}]
)


@st.composite
def altered(draw: st.DrawFn) -> dict[str, Any]:
    """Return a plan's record with one or two values replaced, removed or added, anywhere."""
    record: Any = copy.deepcopy(draw(st.sampled_from(RECORDS)))
    for _ in range(draw(st.integers(1, 2))):
        place: Any = record
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            if not keys:
                break
            key = draw(st.sampled_from(keys))
            inner = place[key]
            if isinstance(inner, dict | list) and inner and draw(st.integers(0, 4)):
                place = inner
                continue
            change = draw(st.sampled_from(["replace", "remove", "add", "swap"]))
            if change == "remove":
                del place[key]
            elif change == "add" and isinstance(place, dict):
                place[draw(st.sampled_from(["colour", "provenance", "topology", "hub", "orientation"]))] = (
                    draw(scalars)
                )
            elif change == "swap":
                place[key] = copy.deepcopy(place[draw(st.sampled_from(keys))])
            else:
                place[key] = draw(scalars)
            break
    return record


@settings(max_examples=400)
@given(altered())
def test_the_schema_and_the_reader_accept_the_same_records_but_for_what_is_stated(record: Any) -> None:
    if record.get("format") != "vitruvius-2":
        return  # another format has another reader
    refusal = ""
    try:
        House.from_dict(record)
    except ValueError as error:
        refusal = str(error)
    if refusal:
        assert STATED.search(refusal) or not accepts(SCHEMA, record), refusal
    else:
        assert accepts(SCHEMA, record)
