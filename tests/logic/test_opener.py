"""Files of unknown origin: a file that is irregular, too large, too deep or damaged is refused at once."""

import gzip
import io
import os
import socket
import zipfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import pytest

from vitruvius.logic.opener import (
    MAX_DEPTH,
    MAX_DIGITS,
    MAX_MEMBERS,
    archive_of,
    content_of,
    from_json,
    from_xml,
    member_of,
)

MOST = 1 << 10


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(path))


NO_FILES: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a link to zeros": lambda path: path.symlink_to("/dev/zero"),
    "a link to a terminal": lambda path: path.symlink_to("/dev/ptmx"),
    "a folder": Path.mkdir,
    "a socket": _socket,
}


@pytest.mark.parametrize("kind", NO_FILES)
def test_what_is_no_regular_file_is_refused_and_not_waited_for(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # a socket's path is at most 108 bytes
    path = Path("it")
    NO_FILES[kind](path)
    with pytest.raises(OSError, match=r"pipe|directory|such device") as caught:
        content_of(path, MOST)
    assert caught.value.strerror


DAMAGED = {
    "too large": bytes(MOST + 1),
    "too large, unpacked": gzip.compress(bytes(MOST + 1)),
    "cut short": gzip.compress(os.urandom(MOST))[:-9],
    "of another sum": gzip.compress(b"{}")[:-8] + bytes(8),
    "no gzip after its head": b"\x1f\x8b\x08\0\0\0\0\0\0\0" + b"\xff" * 99,
    "no gzip, of its name": None,
}


@pytest.mark.parametrize("what", DAMAGED)
def test_a_file_beyond_its_bound_or_damaged_is_an_error_that_says_why(what: str, tmp_path: Path) -> None:
    path = tmp_path / ("it" if DAMAGED[what] else "it.gz")
    path.write_bytes(DAMAGED[what] or b"{}")
    with pytest.raises(OSError, match=r"\A.*(more than 1 KiB|damaged: ).*\Z"):
        content_of(path, MOST)


def test_a_file_of_its_bound_is_read_plain_and_packed(tmp_path: Path) -> None:
    for name, content in (("plain", bytes(MOST)), ("packed", gzip.compress(bytes(MOST)))):
        (tmp_path / name).write_bytes(content)
        assert content_of(tmp_path / name, MOST) == bytes(MOST)
        assert content_of(tmp_path / name, MOST, unpack=False) == content


REFUSED_JSON = {
    "deep lists": (b"[" * (MAX_DEPTH + 1) + b"]" * (MAX_DEPTH + 1), "deep"),
    "deep objects": (b'{"a":' * 9999 + b"1" + b"}" * 9999, "deep"),
    "lists without an end": (b"[" * 99_999, "deep"),
    "a number of 400 digits": (b"[" + b"1" * 400 + b"]", "digits"),
    "a number of 5,000 digits": (b"[0." + b"1" * 5000 + b"]", "digits"),
    "a huge number": (b"[1e400]", "1e100"),
    "no number": (b"[NaN]", "NaN"),
    "infinity": (b"[-Infinity]", "Infinity"),
    "half a letter": (rb'["\ud800"]', "half of a surrogate pair"),
    "other letters": (b'["\xff"]', "not UTF-8: byte 0xff"),
    "many values": (b"[" + b"[]," * (1 << 22) + b"[]]", "values"),
    "no JSON": (b'{"a": [1, 2}', "line 1 column 12"),
}


@pytest.mark.parametrize("what", REFUSED_JSON)
def test_json_beyond_its_bounds_is_refused_at_once_whatever_shall_be_read(what: str) -> None:
    content, words = REFUSED_JSON[what]
    started = perf_counter()
    with pytest.raises(ValueError, match=words):
        from_json(content)
    with pytest.raises(ValueError, match=r"\A.+\Z"):
        from_json(content, dict[str, int])
    assert perf_counter() - started < 2


def test_json_within_its_bounds_is_read_with_brackets_and_digits_in_its_texts() -> None:
    deep = b"[" * MAX_DEPTH + b"]" * MAX_DEPTH
    assert str(from_json(deep)).replace(" ", "").encode() == deep
    text = r"\"[" * 999 + "1" * 2 * MAX_DIGITS + r"1e400 \ud83d\ude00"
    assert from_json(f'{{"{text}": 1e-320}}'.encode()) == {
        '"[' * 999 + "1" * 2 * MAX_DIGITS + "1e400 \N{GRINNING FACE}": 1e-320
    }
    assert from_json('{"Küche": 1}'.encode("utf-16"), dict[str, int]) == {"Küche": 1}


@pytest.mark.parametrize("unit", [b'"', rb"\"", b"\\", b"[", b'["', b"1", b"1,", b"e0", b"[]", b"}{"])
def test_content_that_is_no_json_is_refused_in_a_time_that_grows_as_it_does(unit: bytes) -> None:
    started = perf_counter()
    with pytest.raises(ValueError, match=r"\A.+\Z"):
        from_json(unit * (400_000 // len(unit)))
    assert perf_counter() - started < 2


def _archive(*files: bytes, packed: int = zipfile.ZIP_DEFLATED) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", packed) as archive:
        for number, file in enumerate(files):
            archive.writestr(str(number), file)
    return content.getvalue()


REFUSED_ARCHIVES = {
    "files that are too large together": (_archive(*[bytes(MOST // 2 + 1)] * 2), "together"),
    "too many files": (_archive(*[b""] * (MAX_MEMBERS + 1)), "1,024 files"),
    "a way of packing that takes memory": (_archive(b"1", packed=zipfile.ZIP_LZMA), "unusual"),
    "no archive": (b"PK\x03\x04" + bytes(99), "damaged"),
}


@pytest.mark.parametrize("what", REFUSED_ARCHIVES)
def test_an_archive_is_bounded_by_the_sum_and_the_number_of_its_files(what: str) -> None:
    content, words = REFUSED_ARCHIVES[what]
    with pytest.raises(ValueError, match=words):
        archive_of(content, MOST)


def test_a_damaged_file_of_an_archive_is_refused() -> None:
    whole = _archive(b"abc" * 99, packed=zipfile.ZIP_STORED)
    assert member_of(archive_of(whole, MOST), "0") == b"abc" * 99
    with pytest.raises(ValueError, match="0 of the archive is damaged"):
        member_of(archive_of(whole.replace(b"abc", b"abd", 1), MOST), "0")


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"<g>" * 65 + b"</g>" * 65, "nested more than 64 deep"),
        (b"<g>" * 500_000, "nested more than 64 deep"),
        (b"<s>" + b"<g/>" * (1 << 18) + b"</s>", "more than 262,144 elements"),
        (b'<!DOCTYPE s [<!ENTITY a "aa">]><s>&a;</s>', "declares entities"),
        (b"<s>", "no element found"),
        (b'<?xml version="1.0" encoding="none"?><s/>', "unknown encoding"),
    ],
    ids=["deep", "deep and open", "many", "entities", "cut", "encoding"],
)
def test_xml_that_is_deep_large_or_damaged_is_refused(content: bytes, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        from_xml(content)
