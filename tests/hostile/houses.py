"""House files that are damaged, huge or no files, or whose names are meant to harm a viewer."""

import copy
import gzip
import json
import os
import socket
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from msgspec.structs import replace

from tests.hostile.case import ACCEPTED, HARMLESS, REFUSED, Case, Yard, titled
from tests.hostile.subjects import Answer, command
from tests.logic.house.handmade import built, sketches
from vitruvius.logic.files.replacing import DRAWN_BY

HOUSE = built(4.2, 4.2, tuple((sketch,) for sketch in sketches()))
LINE = json.dumps(replace(HOUSE, format="vitruvius-1").to_dict())
RECORD, PLAN = json.loads(LINE), json.loads(json.dumps(replace(HOUSE, format="vitruvius-2").to_dict()))
"""Records of a star, and of the same house in the format of houses of any topology."""

DRAWN = {"svg", "g", "rect", "line", "path", "polyline", "polygon", "ellipse", "circle", "text", "title"}
"""Elements of a plan: none of them runs, loads or links anything."""

NAMES = (
    "\x1b[2J\x1b]0;title\x07",
    "\x1b]8;;http://localhost/\x07bed",
    "<script>alert(1)</script>",
    '"/><script>alert(1)</script>',
    "]]><!--",
    "&xxe;",
    "<image href='http://localhost/'/>",
    "a\nb\r\nc\u2028d\u0085e",
    "\u202eneht\u202c",
    "\u0000",
    "\ud800",
    "\ufffe\uffff",
    "b\u0435droom",
    "\u200bbed\u200d",
    "%s%n{0}{0.__class__}",
    "../../../../etc/passwd",
    "$(touch TRACE)`touch TRACE`;|&",
    "=cmd|' /C calc'!A0",
    "a" * 100_000,
    "\u0301" * 10_000,
    "\ufdfd" * 3000,
    "",
    "__class__",
    "bed'); shell('TOUCH'), ('",
)
"""Names of rooms, furniture and grammars with text for a terminal, XML, a shell or Prolog."""

VALUES: dict[str, Any] = {
    "null": None,
    "true": True,
    "a text": "x",
    "a number as a text": "1",
    "a list": [],
    "an object": {},
    "minus": -1,
    "zero": 0,
    "minus zero": -0.0,
    "huge": 1e300,
    "beyond 1000 m": 9.9e5,
    "tiny": 5e-324,
    "a huge whole number": 10**400,
    "2 to the 63": 2**63,
    "2 to the 64": 2**64,
    "lists in lists": [[[[[[]]]]]],
}
PLACES = (
    *(
        "roomNumber",
        "floor",
        "floor.x",
        "floor.width",
        "format",
        "unit",
        "R0",
        "R0.x",
        "R0.height",
        "R0.type",
    ),
    *("R0.door", "R0.door.width", "R0.children", "R0.children.0", "R0.children.0.children"),
    *("R0.children.0.orientation", "provenance", "provenance.request", "provenance.request.cell"),
    *("provenance.seed", "provenance.index", "provenance.versions", "provenance.grammar"),
)
PLACES_OF_A_PLAN = (
    *("format", "unit", "rooms", "rooms.0", "rooms.0.name", "rooms.0.x", "rooms.0.width", "rooms.0.type"),
    *("rooms.1.children", "doors", "doors.0", "doors.0.between", "doors.0.between.0", "doors.0.x", "windows"),
    *("doors.0.width", "hub", "topology"),
)
PROVENANCE = {"grammar": "family", "grammar_hash": "", "request": {}, "seed": 0, "index": 0, "versions": {}}


def changed(path: str, value: Any, of: Any = RECORD) -> str:
    """Return a record as JSON with another value at a dotted path."""
    record: Any = copy.deepcopy(of) | {"provenance": copy.deepcopy(PROVENANCE)}
    *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
    place = record
    for step in way:
        place = place[step]
    place[last] = value
    return json.dumps(record)


def good(folder: Path) -> Path:
    """Write a file of one house: the first that a process reads, as the process starts what it needs then."""
    path = folder / "good.jsonl"
    path.write_text(LINE)
    return path


def piece(**changes: Any) -> dict[str, Any]:
    """Return a piece of furniture."""
    return {"x": 0.5, "y": -6.0, "width": 0.5, "height": 0.5, "type": "lamp", "children": []} | changes


def nested(depth: int) -> dict[str, Any]:
    """Return a piece in a piece, ``depth`` times."""
    inner = piece()
    for _ in range(depth):
        inner = piece(children=[inner])
    return inner


def rooms(number: int) -> str:
    """Return a house of many rooms."""
    room = json.dumps(RECORD["R0"])
    listed = ", ".join(f'"R{index}": {room}' for index in range(number))
    floor = json.dumps(RECORD["floor"])
    return f'{{"format": "vitruvius-1", "unit": "m", "roomNumber": {number}, "floor": {floor}, {listed}}}'


TEXTS: dict[str, Callable[[], str | bytes]] = {
    "empty": lambda: "",
    "blanks": lambda: " \n" * 100_000,
    "zeros": lambda: bytes(1_000_000),
    "no JSON": lambda: "vitruvius",
    "null": lambda: "null",
    "a number": lambda: "1e999",
    "a text": lambda: '"house"',
    "a list of houses": lambda: f"[{LINE}]",
    "deep lists": lambda: "[" * 1_000_000,
    "deep lists that close": lambda: '{"floor": ' + "[" * 100_000 + "]" * 100_000 + "}",
    "deep objects": lambda: '{"a":' * 200_000,
    "a long whole number": lambda: LINE.replace("4.2", "4" * 1_000_000, 1),
    "a long exponent": lambda: LINE.replace("4.2", "4e" + "9" * 100_000, 1),
    "NaN": lambda: LINE.replace("4.2", "NaN", 1),
    "Infinity": lambda: LINE.replace("4.2", "-Infinity", 1),
    "1e999": lambda: LINE.replace("4.2", "1e999", 1),
    "hexadecimal": lambda: LINE.replace("4.2", "0x4", 1),
    "a lone surrogate": lambda: LINE.replace("bedroom", "\\ud800", 1),
    "bytes that are no UTF-8": lambda: LINE.encode().replace(b"bedroom", b"\xff\xfe", 1),
    "a surrogate in UTF-8": lambda: LINE.encode().replace(b"bedroom", b"\xed\xa0\x80", 1),
    "UTF-16": lambda: LINE.encode("utf-16"),
    "UTF-32": lambda: LINE.encode("utf-32"),
    "a comment": lambda: f"// a house\n{LINE}",
    "a trailing comma": lambda: LINE[:-1] + ",}",
    "single quotes": lambda: LINE.replace('"', "'"),
    "a key twice": lambda: LINE.replace('"x": ', '"x": 9, "x": ', 1),
    "a room twice": lambda: LINE.replace('"R1": ', '"R0": {}, "R1": '),
    "roomNumber twice": lambda: LINE.replace('"roomNumber": 4', '"roomNumber": 4, "roomNumber": 4'),
    "a key by another spelling": lambda: LINE.replace('"x": ', '"\\u0078": 9, "x": ', 1),
    "an unknown key": lambda: LINE.replace('"x": ', '"__class__": 9, "x": ', 1),
    "an unknown key of the house": lambda: LINE.replace('"unit"', '"on load": "shell", "unit"', 1),
    "__proto__": lambda: LINE.replace('"unit"', '"__proto__": {"x": 1}, "unit"', 1),
    "a room by other digits": lambda: LINE.replace('"R1"', '"R\u0661"'),
    "a room with leading zeros": lambda: LINE.replace('"R1"', '"R01"'),
    "a room by a superscript": lambda: LINE.replace('"R1"', '"R\u00b9"'),
    "cut in the middle": lambda: LINE[: len(LINE) // 2],
    "two on a line": lambda: LINE + LINE,
    "a good house, then a bad one": lambda: f"{LINE}\n{LINE[:-5]}\n",
    "very many rooms": lambda: rooms(10_000),
    "a room too many": lambda: rooms(1025),
    "a roomNumber of a million": lambda: LINE.replace('"roomNumber": 4', '"roomNumber": 1000000'),
    "pieces deep in pieces": lambda: changed("R0.children", [nested(400)]),
    "too many pieces": lambda: changed("R0.children", 20_000 * [piece()]),
    "a long number": lambda: LINE.replace("4.2", "4." + "2" * 1_000_000, 1),
    "pieces in pieces": lambda: changed("R0.children", [nested(200)]),
    "a request of deep lists": lambda: changed(
        "provenance.request", {"a": json.loads("[" * 500 + "]" * 500)}
    ),
    "numbers of many digits": lambda: LINE.replace("4.2", "4.2" + "0" * 400),
    "too many pieces in all rooms": lambda: furnished(64),
    "a type of 30 MB": lambda: changed("R0.children", [piece(type="x" * 30_000_000), *200 * [piece()]]),
    "a million relations of sizes": lambda: changed(
        "provenance.promises", {"room_relations": {"bedroom": 1_000_000 * [[1, -1, 99]]}}
    ),
    "a line of 40 MB": lambda: LINE[:-1] + f', "note": "{"a" * 40_000_000}"}}',
    "a million lines that say why": lambda: '{"stopped": "x"}\n' * 300_000,
    "a floor of 5000 m": lambda: changed("floor.width", 5000.0),
    "a wide house": lambda: changed("R0.x", 999.0),
    "a room that is a line": lambda: changed("R0.height", 0),
    "a door that is a rectangle": lambda: changed("R0.door.height", 1.0),
}
"""Contents of files that are refused, or harmless."""

SHAPES: dict[str, Callable[[], str | bytes]] = {
    "windows' line ends": lambda: f"{LINE}\r\n{LINE}\r\n",
    "a byte order mark": lambda: b"\xef\xbb\xbf" + LINE.encode(),
    "mixed line ends": lambda: f"{LINE}\r\n{LINE}\n\n\r\n{LINE}",
    "one house of all": lambda: changed("provenance.request", {"types": {"bedroom": 2}}),
    "coincident pieces": lambda: changed("R0.children", 200 * [piece()]),
    "pieces outside": lambda: changed("R0.children", [piece(x=900.0, y=900.0)]),
    "a piece as large as the house": lambda: changed("R0.children", [piece(x=-500.0, width=1000.0)]),
    "rooms in one place": lambda: rooms(60),
    "a door far from its wall": lambda: changed("R0.door.x", 300.0),
    "a long door": lambda: changed("R0.door.width", 500.0),
    "a door of a nanometre": lambda: changed("R0.door.width", 1e-9),
    "a floor of a nanometre": lambda: changed("floor.width", 1e-9),
    "a piece of a nanometre": lambda: changed("R0.children", [piece(width=1e-9, height=1e-300)]),
    "a room far away": lambda: changed("R0.x", 900.0),
    "a house of no room": lambda: rooms(0).replace(", }", "}"),
}
"""Houses that are read; ``check`` reports their faults."""


def furnished(rooms: int) -> str:
    """Return a house of ``rooms`` rooms in a row, each with as many pieces as a room may have."""
    record = copy.deepcopy(PLAN)
    room = record["rooms"][0] | {"children": 256 * [piece()]}
    record |= {"topology": "", "doors": [], "windows": [], "hub": None}
    record["rooms"] = [room | {"name": f"R{k}", "x": 10.0 * k} for k in range(rooms)]
    return json.dumps(record)


def bomb(size: int, letter: bytes = b"\0") -> bytes:
    """Return a letter, repeated very often, as gzip: a thousandth of the bytes."""
    packer = zlib.compressobj(1, zlib.DEFLATED, 31)
    return b"".join([*(packer.compress(letter * (1 << 24)) for _ in range(size >> 24)), packer.flush()])


def _linked(yard: Yard, target: str) -> Path:
    path = yard.input / "houses.jsonl"
    path.symlink_to(yard.filled(target))
    return path


def _server(yard: Yard) -> Path:
    path = yard.input / "h.jsonl"
    old = os.getcwd()
    os.chdir(yard.input)  # a socket's path is at most 108 bytes
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path.name)
    os.chdir(old)
    return path


def _folder(yard: Yard) -> Path:
    (yard.input / "houses.jsonl").mkdir()
    return yard.input / "houses.jsonl"


def _sparse(yard: Yard, name: str = "houses.jsonl") -> Path:
    path = yard.input / name
    path.touch()
    os.truncate(path, 5 << 30)
    return path


def _written(content: Callable[[], str | bytes], name: str = "houses.jsonl") -> Callable[[Yard], Path]:
    def make(yard: Yard) -> Path:
        path, text = yard.input / name, content()
        path.write_bytes(yard.filled(text).encode() if isinstance(text, str) else text)
        return path

    return make


FILES: dict[str, Callable[[Yard], Path]] = {
    "absent": lambda yard: yard.input / "houses.jsonl",
    "a folder": _folder,
    "a socket": _server,
    "a link to a device of zeros": lambda yard: _linked(yard, "/dev/zero"),
    "a link to nothing": lambda yard: _linked(yard, "/nowhere/houses.jsonl"),
    "a link to itself": lambda yard: _linked(yard, "houses.jsonl"),
    "a link to a secret": lambda yard: _linked(yard, "SECRET"),
    "a link to a process's memory": lambda yard: _linked(yard, "/proc/self/mem"),
    "a file of 5 GB of nothing": _sparse,
    "a gzip bomb": _written(lambda: bomb(1 << 30), "houses.jsonl.gz"),
    "a gzip bomb of line ends": _written(lambda: bomb(1 << 30, b"\n"), "houses.jsonl.gz"),
    "a gzip bomb in a gzip bomb": _written(lambda: gzip.compress(bomb(1 << 28)), "houses.jsonl.gz"),
    "a gzip file that is none": _written(lambda: LINE, "houses.jsonl.gz"),
    "a gzip file that is cut": _written(lambda: gzip.compress(LINE.encode())[:-9], "houses.jsonl.gz"),
    "a gzip file with a wrong sum": _written(
        lambda: gzip.compress(LINE.encode())[:-8] + bytes(8), "houses.jsonl.gz"
    ),
    "a gzip file with a tail": _written(lambda: gzip.compress(LINE.encode()) + b"tail", "houses.jsonl.gz"),
    "many empty gzip files": _written(lambda: gzip.compress(b"") * 100_000, "houses.jsonl.gz"),
    "two houses in .json": _written(lambda: f"{LINE}\n{LINE}", "houses.json"),
    "a pickle": _written(lambda: b"cos\nsystem\n(S'touch /tmp/never'\ntR.", "houses.jsonl"),
    "a name with a line end": _written(lambda: "{}", "a\nb\x1b[2J.jsonl"),
    "a name that is no UTF-8": _written(lambda: "{}", os.fsdecode(b"\xff\xfe.jsonl")),
}


def shown(path: Path, out: Path) -> Answer:
    """Return the answer of ``check``, ``draw`` and ``info``; the plans must consist of harmless elements."""
    checked = command("check", path)
    drawn = command("draw", path, "--out", out / "plans")
    if checked.answer != drawn.answer:
        return Answer(f"check: {checked.answer}, draw: {drawn.answer}", checked.text + drawn.text)
    told = command("info", path)
    if told.answer != checked.answer:
        return Answer(f"check: {checked.answer}, info: {told.answer}", checked.text + told.text)
    for plan in sorted(out.rglob("*.svg")):
        text = plan.read_text(encoding="utf-8").removesuffix(f"<!-- {DRAWN_BY.decode()} -->\n")
        strange = {element.tag.rpartition("}")[2] for element in ElementTree.fromstring(text).iter()} - DRAWN
        if strange or "href" in text.replace("href=&", "").split(">", 1)[0] or "<!" in text:
            return Answer("a plan with strange elements", ", ".join(strange))
        if len(text) > 10_000_000:
            return Answer("a plan of more than 10 MB", "")
    return Answer(checked.answer, checked.text)


CASES = [
    *(
        Case(
            "houses: names",
            f"{titled(name)} as {place}",
            _written(lambda place=place, name=name: changed(place, name)),
            HARMLESS,
        )
        for name in NAMES
        for place in ("R0.type", "R0.children.0.type", "provenance.grammar")
    ),
    *(
        Case(
            "houses: names",
            f"{titled(name)} as {place} of a plan",
            _written(lambda place=place, name=name: changed(place, name, PLAN)),
            HARMLESS,
        )
        for name in NAMES
        for place in ("rooms.0.name", "topology")
    ),
    *(
        Case(
            "houses: values",
            f"{title} as {place} of a plan",
            _written(lambda place=place, value=value: changed(place, value, PLAN)),
            HARMLESS,
        )
        for title, value in VALUES.items()
        for place in PLACES_OF_A_PLAN
    ),
    *(
        Case(
            "houses: values",
            f"{title} as {place}",
            _written(lambda place=place, value=value: changed(place, value)),
            HARMLESS,
        )
        for title, value in VALUES.items()
        for place in PLACES
    ),
    *(
        Case("houses: texts", title, _written(text), (REFUSED,), "houses.jsonl:")
        for title, text in TEXTS.items()
    ),
    *(Case("houses: shapes", title, _written(text), (ACCEPTED,)) for title, text in SHAPES.items()),
    *(Case("houses: files", title, make, (REFUSED,)) for title, make in FILES.items()),
]
