"""House files: reading returns what was written, and a wrong file is refused in one line."""

import gzip
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.logic.house.handmade import built, houses, sketches
from tests.sample_houses import changed_record
from vitruvius.logic import House, HouseFileError, Piece, load, save
from vitruvius.logic.files.house_files import HOUSE_FILES
from vitruvius.logic.files.writing import require_ending, write_whole
from vitruvius.logic.house.parts import ORIGINAL, PIXEL, Provenance

EXAMPLE = Path(__file__).parents[2] / "fixtures" / "example1.json"
HOUSE = built(4.2, 4.2, tuple((sketch,) for sketch in sketches()))

PIECE = HOUSE.to_dict()["R0"]["children"][0]
PROVENANCE = {"grammar": "", "grammar_hash": "", "request": {}, "seed": 0, "index": 0, "versions": {}}


def promising(**promises: Any) -> dict[str, Any]:
    return PROVENANCE | {"promises": promises}


provenances = st.builds(
    Provenance,
    grammar=st.text(max_size=9),
    grammar_hash=st.text("0123456789abcdef", max_size=8),
    request=st.fixed_dictionaries({"rooms": st.integers(1, 16), "types": st.just({"bedroom": 2})}),
    seed=st.integers(0, 2**63 - 1),
    index=st.integers(0, 10**6),
    versions=st.dictionaries(st.text(max_size=5), st.text(max_size=5), max_size=2),
)


@settings(max_examples=30)
@given(st.lists(houses(), min_size=1, max_size=3), st.none() | provenances, st.sampled_from(["", ".gz"]))
def test_reading_back_gives_the_same_houses(
    tmp_path_factory: pytest.TempPathFactory, made: list[House], provenance: Provenance | None, end: str
) -> None:
    made = [replace(house, provenance=provenance) for house in made]
    path = tmp_path_factory.mktemp("houses") / f"houses.jsonl{end}"
    save(made, path)
    assert load(path) == made
    assert [House.from_dict(house.to_dict()) for house in made] == made


@pytest.mark.parametrize("name", ["one.json", "one.json.gz"])
def test_a_json_file_holds_one_house_over_any_number_of_lines(tmp_path: Path, name: str) -> None:
    path, text = tmp_path / name, json.dumps(HOUSE.to_dict(), indent=4).encode()
    path.write_bytes(gzip.compress(text) if name.endswith(".gz") else text)
    assert load(path) == [HOUSE]
    save([HOUSE], path)
    assert load(path) == [HOUSE]
    with pytest.raises(ValueError, match="one house, not 2"):
        save([HOUSE, HOUSE], path)


def test_the_same_houses_give_the_same_bytes_at_any_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = [tmp_path / "a.jsonl.gz", tmp_path / "b.jsonl.gz"]
    for path, now in zip(paths, (1e9, 2e9), strict=True):
        monkeypatch.setattr("time.time", lambda now=now: now)
        save([HOUSE], path)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_a_record_without_a_unit_is_the_original_s_in_pixels() -> None:
    record = HOUSE.to_dict()
    del record["format"], record["unit"]
    house = House.from_dict(record)
    assert house.format == ORIGINAL
    assert house.star.floor.width == pytest.approx(4.2 * PIXEL)
    assert house.star.rooms[0].children[0].children[0].width == pytest.approx(0.4 * PIXEL)


def test_the_original_s_example_reads_in_metres_and_reads_back() -> None:
    (house,) = load(EXAMPLE)
    assert [room.type for room in house.star.rooms] == ["bedroom", "bathroom", "kitchen", "hall"]
    assert house.star.rooms[0].door.height == pytest.approx(0.762)
    assert len(house.star.rooms[3].pieces) == 8
    assert House.from_dict(house.to_dict()) == house


def test_pieces_within_pieces_all_count() -> None:
    lamp = Piece(0.1, 0.1, 0.1, 0.1, "lamp")
    bedside = Piece(0.0, 0.0, 0.4, 0.4, "bedside", children=(lamp,))
    room = replace(HOUSE.star.rooms[0], children=(Piece(0.5, 0.0, 1.5, 2.0, "bed", children=(bedside,)),))
    assert [piece.type for piece in room.pieces] == ["bed", "bedside", "lamp"]


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("roomNumber", 10**9, "roomNumber is 1000000000, but 4 rooms follow"),
        ("roomNumber", 1e9, r"Expected `int`, got `float` - at `\$.roomNumber`"),
        ("roomNumber", 3, "roomNumber is 3, but 4 rooms follow"),
        ("roomNumber", "4", "roomNumber"),
        ("roomNumber", ..., "roomNumber"),
        ("R1", ..., "roomNumber is 4, but 3 rooms follow"),
        ("R1", [], "R1: Expected `object`"),
        ("floor", ..., "floor"),
        ("floor.width", "wide", r"Expected `float`, got `str` - at `\$.floor.width`"),
        ("floor.width", 0.0, "floor is 0.0 by 4.2: sizes must be positive"),
        ("floor.x", float("nan"), "floor lies beyond 1000 m or is not a number"),
        ("floor.x", float("inf"), "floor lies beyond 1000 m or is not a number"),
        ("R0.x", 5000.0, "R0 lies beyond 1000 m"),
        ("R0.children", 300 * [PIECE], "R0 has 600 pieces: at most 256"),
        (
            "provenance",
            {**PROVENANCE, "request": {"cell": "0.3"}},
            "cell must be a length in metres, not '0.3'",
        ),
        ("R0.children.0.type", "x" * 129, "R0: .*length <= 128"),
        ("provenance", promising(a_side=0), "Expected `int` >= 1"),
        ("provenance", promising(lit=513 * ["x"]), r"length <= 512 - at `\$.provenance.promises.lit`"),
        (
            "provenance",
            promising(counts={f"t{k}": {} for k in range(513)}),
            "length <= 512 .*promises.counts",
        ),
        ("provenance", promising(house_size=65 * [[1, 1, 1]]), "length <= 64 .*promises.house_size"),
        ("unit", "ft", "unit"),
        ("format", "vitruvius-9", "format"),
        ("colour", "red", "colour"),
        ("R2.colour", "red", "R2: .*colour"),
        ("R2.type", None, "R2: Expected `str`"),
        ("R2.door", ..., "R2: .*door"),
        ("R2.door.height", 1.0, "R2.door must be a segment"),
        ("R2.door.width", 0.0, "R2.door must be a segment"),
        ("R2.height", -1.0, "R2 is 3.5 by -1.0: sizes must be positive"),
        ("R0.children.0.orientation", "up", "R0: Invalid enum value 'up'"),
        ("R0.children.1.width", 0.0, r"R0, piece 2 \(wardrobe\) is 0.0 by 1.4: sizes must be positive"),
        ("R0.children.0.children.0.height", 0, r"R0, piece 1 \(bedside\) is 0.4 by 0.0: sizes"),
    ],
)
def test_a_wrong_record_is_refused_by_the_name_of_its_field(path: str, value: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        House.from_dict(changed_record(HOUSE.to_dict(), path, value))


def test_the_furniture_of_all_rooms_together_is_bounded() -> None:
    record = replace(HOUSE, format="vitruvius-2").to_dict()
    room = record["rooms"][0] | {"children": 250 * [PIECE | {"children": []}]}
    rooms = [room | {"name": f"room {k}"} for k in range(40)]
    with pytest.raises(ValueError, match="more than 8,192 pieces together"):
        House.from_dict(record | {"rooms": rooms, "topology": "", "hub": None, "doors": [], "windows": []})


def test_a_gap_in_the_rooms_names_is_refused() -> None:
    record = HOUSE.to_dict()
    record["R9"] = record.pop("R1")
    with pytest.raises(ValueError, match="R1 is missing"):
        House.from_dict(record)


LINE = json.dumps(HOUSE.to_dict()).encode()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "holds no house"),
        (b"\n\n", "holds no house"),
        (LINE + b"\n" + LINE[:-9], ":2: not a house: its end is missing"),
        (LINE + b"\n\n" + b"[1, 2]", ":3: not a house: a house is a JSON object, not list"),
        (LINE.replace(b"4.2", b"NaN", 1), ":1: not a house: invalid character"),
        (LINE.replace(b"4.2", b"1e999", 1), ":1: not a house: "),
        (LINE.replace(b'"roomNumber": 4', b'"roomNumber": 1e9'), ":1: not a house: .*roomNumber"),
        (b"\xff\xfe" + LINE, ":1: not a house: "),
        (b"\x00" * 100, ":1: not a house: "),
        (b'{"a": ' + b"[" * 200_000, ":1: not a house: "),
        (LINE.replace(b'"R1": ', b'"R0": {}, "R1": '), ":1: not a house: 'R0' appears twice in an object"),
        (LINE.replace(b'"x": ', b'"x": 9, "x": ', 1), ":1: not a house: 'x' appears twice"),
    ],
    ids=[
        "empty",
        "blank",
        "truncated",
        "list",
        "NaN",
        "infinite",
        "1e9",
        "bytes",
        "zeros",
        "deep",
        "room-twice",
        "x-twice",
    ],
)
def test_a_wrong_file_is_refused_by_line_in_one_line(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "houses.jsonl"
    path.write_bytes(content)
    with pytest.raises(HouseFileError, match=words) as error:
        load(path)
    assert "\n" not in str(error.value)
    assert error.value.exit_code == 5


@pytest.mark.parametrize(
    "content", [LINE, gzip.compress(LINE, mtime=0)[:-20], gzip.compress(LINE, mtime=0)[:30] + b"\x07" * 99]
)
def test_a_damaged_gzip_file_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "houses.jsonl.gz"
    path.write_bytes(content)
    with pytest.raises(HouseFileError, match="cannot be read"):
        load(path)


def test_a_small_file_that_unpacks_to_more_than_is_read_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "houses.jsonl.gz"
    path.write_bytes(gzip.compress(bytes(4 << 20)))
    monkeypatch.setattr("vitruvius.logic.files.house_files.MOST_LINE", 1 << 20)
    with pytest.raises(HouseFileError, match=":1: a house of more than 1 MiB"):
        load(path)
    path.write_bytes(gzip.compress((bytes([32]) * 999 + b"\n") * 3000))
    monkeypatch.setattr("vitruvius.logic.files.house_files.MOST_BYTES", 2 << 20)
    with pytest.raises(HouseFileError, match="holds more than 2 MiB"):
        load(path)
    path.write_bytes(gzip.compress(b"\n" * 3000))
    monkeypatch.setattr("vitruvius.logic.files.house_files.MOST_LINES", 2000)
    with pytest.raises(HouseFileError, match="holds more than 2 MiB or 2,000 lines"):
        load(path)


@pytest.mark.parametrize("name", ["a.jsonl", "A.JSONL", "a.geojson", "a.yaml", "a.pgm.txt", "a"])
def test_the_command_that_an_error_proposes_is_not_refused(name: str, tmp_path: Path) -> None:
    for _ in ("absent", "empty"):
        with pytest.raises(HouseFileError) as error:
            load(tmp_path / name)
        if name.endswith(".yaml") and (tmp_path / name).exists():
            assert ": not a ROS map" in str(error.value)
            continue
        require_ending(str(error.value).rpartition(" --out ")[2], HOUSE_FILES)
        (tmp_path / name).touch()


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(HouseFileError, match="there is no such file"):
        load(tmp_path / "absent.jsonl")
    with pytest.raises(HouseFileError, match="is a folder, not a house file"):
        load(tmp_path)


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_an_error_on_the_way_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    path = tmp_path / "houses.jsonl"
    write_whole(path, b"old")

    def full(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(os, step, full)
    with pytest.raises(OSError, match="no space"):
        save([HOUSE], path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_kill_on_the_way_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "houses.jsonl"
    write_whole(path, b"old")
    script = (
        "import os, signal, sys\n"
        "from vitruvius.logic.files.house_files import HOUSE_FILES, require_ending, write_whole\n"
        "os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)\n"
        "write_whole(sys.argv[1], b'new')"
    )
    killed = subprocess.run([sys.executable, "-c", script, str(path)], check=False)
    assert killed.returncode < 0
    assert path.read_bytes() == b"old"


def test_an_empty_list_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no house to write"):
        save([], tmp_path / "houses.jsonl")
    assert not list(tmp_path.iterdir())


def test_files_are_as_readable_as_the_umask_says(tmp_path: Path) -> None:
    old = os.umask(0o027)
    try:
        write_whole(tmp_path / "deep" / "file", b"")
    finally:
        os.umask(old)
    assert (tmp_path / "deep" / "file").stat().st_mode & 0o777 == 0o640


def test_a_file_that_is_replaced_keeps_its_mode(tmp_path: Path) -> None:
    path = tmp_path / "houses.jsonl"
    path.write_bytes(b"old")
    path.chmod(0o600)
    write_whole(path, b"new")
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_link_stays_and_what_it_leads_to_is_replaced(tmp_path: Path) -> None:
    link, file = tmp_path / "link.jsonl", tmp_path / "deep" / "houses.jsonl"
    link.symlink_to(file)
    for content in (b"first", b"second"):  # the first time the target is absent
        write_whole(link, content)
        assert link.is_symlink()
        assert file.read_bytes() == content
    (tmp_path / "round").symlink_to(tmp_path / "round")
    with pytest.raises(OSError, match="round"):
        write_whole(tmp_path / "round", b"")


def test_a_pipe_is_written_to_by_its_number_whatever_it_is_called() -> None:
    """Examples are ``--out /dev/stdout`` and ``--out >(gzip)``."""
    reader, writer = os.pipe()
    try:
        save([HOUSE], f"/dev/fd/{writer}")
        assert os.read(reader, 1 << 16).startswith(b'{"format"')
    finally:
        os.close(reader)
        os.close(writer)


def test_a_pipe_is_written_to_and_stays(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_whole(pipe, b"houses")
        assert os.read(reader, 99) == b"houses"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


def test_a_folder_is_not_replaced(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, b"")


def test_lengths_of_the_originals_files_are_cut_to_whole_pixels_where_asked():
    (house,), (cut,) = load(EXAMPLE), load(EXAMPLE, whole_pixels=True)
    for room, whole in zip(house.rooms, cut.rooms, strict=True):
        for name in ("x", "y", "width", "height"):
            assert getattr(whole, name) == int(getattr(room, name) / PIXEL) * PIXEL


def test_a_file_in_metres_has_no_pixels_to_cut(tmp_path):
    save([HOUSE], tmp_path / "house.json")
    with pytest.raises(HouseFileError, match="its lengths are in m: cropping needs a house in pixels"):
        load(tmp_path / "house.json", whole_pixels=True)


def test_a_house_file_may_begin_with_a_byte_order_mark_and_is_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "houses.jsonl"
    save([HOUSE, HOUSE], path)
    text = path.read_text()
    path.write_bytes(text.encode("utf-8-sig"))
    assert load(path) == [HOUSE, HOUSE]
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(HouseFileError, match=":1: not a house: this file is UTF-16: save it as UTF-8"):
        load(path)
