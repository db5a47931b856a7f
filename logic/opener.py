"""Access to files from others: only regular files are read, and nothing is unpacked beyond a bound.

A refused file raises ``OSError`` with ``strerror``, as an absent file does; refused content raises
``ValueError``. Both errors give the reason in one line, to which the calling reader adds the file's name.
"""

import errno
import gzip
import io
import json
import os
import re
import stat
import sys
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, NoReturn, cast
from xml.etree import ElementTree

import msgspec

from vitruvius.logic.encoding import illegible

STANDARD = Path("-")
"""The standard input for a file to read, the standard output for a file to write."""

PACKED = b"\x1f\x8b"
"""First bytes of a gzip file."""

ZIPPED = b"PK\x03\x04"
"""First bytes of a zip archive."""

MAX_BYTES, MAX_DEPTH, MAX_DIGITS, MAX_VALUES = 1 << 26, 64, 128, 1 << 22
"""Size of a JSON text: bytes, levels of lists and objects, digits of a number, and values."""

MAX_ELEMENTS = 1 << 18
"""Number of elements in an XML document."""

MAX_MEMBERS = 1 << 10
"""Number of files in an archive."""

DAMAGED = (OSError, EOFError, zlib.error)
"""Errors of reading an open file: see ``reason``."""

_STRING = re.compile(rb'"(?:[^"\\]++|\\.)*+"?', re.DOTALL)
_LONG = re.compile(rb"\d{129}")
_HUGE = re.compile(rb"[eE]\+?0*+\d{3}")
_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")
_NO_BRACKETS = bytes(set(range(256)) - set(b"[]{}"))
_PLAIN_MEMBERS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compression methods that are read. Other methods may take as much memory as an archive requests."""

FLAGS = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_CLOEXEC", "O_BINARY"))
"""Flags for reading that wait for no pipe and take no terminal; the last is of Windows."""


def opened(path: str | Path, most: int, *, unpack: bool = True) -> BinaryIO:
    """Open a regular file of at most ``most`` bytes, or the standard input, which may be a pipe.

    Gzip content is unpacked, whatever the file's name. ``most`` does not bound the unpacked content that the
    caller then reads: see ``content_of``. Raises ``OSError`` for a folder, a pipe, a device and a socket,
    without waiting for one.
    """
    if Path(path) == STANDARD:
        file = io.BufferedReader(io.FileIO(sys.stdin.fileno(), closefd=False))
    else:
        # Confinement denies calls that ``open`` makes.
        number = os.open(path, FLAGS)
        try:
            _require_bounded(os.fstat(number), path, most)
        except OSError:
            os.close(number)
            raise
        file = os.fdopen(number, "rb")
    packed = unpack and (Path(path).suffix == ".gz" or file.peek(len(PACKED)).startswith(PACKED))
    if not packed:
        return file
    unpacked = gzip.GzipFile(fileobj=file)
    unpacked.myfileobj = file  # pyright: ignore[reportAttributeAccessIssue] - closed with it
    return cast(BinaryIO, unpacked)


def content_of(path: str | Path, most: int, *, unpack: bool = True) -> bytes:
    """Return the unpacked content of a file or of the standard input.

    Raises ``OSError``, also for damaged content and for more than ``most`` bytes.
    """
    try:
        with opened(path, most, unpack=unpack) as file:
            content = file.read(most + 1)
    except DAMAGED as error:
        if isinstance(error, OSError) and error.errno:
            raise
        raise OSError(errno.EIO, f"damaged: {reason(error)}", str(path)) from None
    if len(content) > most:
        _too_large(path, most)
    return content


def require_file(path: str | Path, most: int) -> None:
    """Raise ``OSError`` unless a path is a regular file of at most ``most`` bytes.

    Readers call this before they pass the path to a library that opens the file itself.
    """
    _require_bounded(os.stat(path), path, most)


def reason(error: Exception) -> str:
    """Return the reason of a read error in one line."""
    words = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return words.splitlines()[0]


def from_json(content: bytes, kind: Any = None, pairs: Callable[[list[Any]], Any] | None = None) -> Any:
    """Return the value of a JSON text: of a type ``kind`` of msgspec, or with objects made by ``pairs``.

    Raises ``ValueError``, in one line, if the text is no JSON or exceeds ``MAX_BYTES``, ``MAX_DEPTH``,
    ``MAX_DIGITS`` or ``MAX_VALUES``.
    """
    if len(content) > MAX_BYTES:
        raise ValueError(f"more than {_size(MAX_BYTES)} of JSON")
    if (encoding := json.detect_encoding(content)) != "utf-8":  # what Windows writes
        content = content.decode(encoding).encode()
    _require_plain(content)
    try:
        if kind is not None:
            return msgspec.json.decode(content, type=kind)
        found = json.loads(content, parse_constant=_no_number, object_pairs_hook=pairs)
        if _SURROGATE.search(content):  # half of a surrogate pair cannot be encoded
            json.dumps(found, ensure_ascii=False).encode()
        return found
    except msgspec.ValidationError:
        raise
    except msgspec.DecodeError as error:
        words = str(error).removeprefix("JSON is malformed: ")
        raise ValueError(words.replace("Input data was truncated", "its end is missing")) from None
    except UnicodeEncodeError:
        raise ValueError("a text has half of a surrogate pair") from None
    except UnicodeDecodeError:
        line, column, words = illegible(content) or (1, 1, "not UTF-8: save as UTF-8")
        raise ValueError(f"line {line}, column {column}: {words}") from None
    except RecursionError:
        raise ValueError(f"nested more than {MAX_DEPTH} deep") from None


def from_xml(content: bytes) -> ElementTree.Element:
    """Return the root element of an XML document.

    Raises ``ValueError``, in one line, if the document is no XML, declares entities, or exceeds ``MAX_DEPTH``
    or ``MAX_ELEMENTS``.
    """
    if b"<!ENTITY" in content:
        raise ValueError("it declares entities: save it without them")
    parser = ElementTree.XMLParser(target=_BoundedTree())
    try:
        parser.feed(content)
        return parser.close()
    except (ElementTree.ParseError, LookupError) as error:  # LookupError: unknown encoding
        raise ValueError(reason(error)) from None


class _BoundedTree(ElementTree.TreeBuilder):
    """Tree builder that refuses deep and large documents."""

    def __init__(self) -> None:
        super().__init__()
        self._depth = self._elements = 0

    def start(self, tag: str, attrs: dict[str, str], /) -> ElementTree.Element:
        self._depth, self._elements = self._depth + 1, self._elements + 1
        if self._depth > MAX_DEPTH:
            raise ValueError(f"nested more than {MAX_DEPTH} deep")
        if self._elements > MAX_ELEMENTS:
            raise ValueError(f"more than {MAX_ELEMENTS:,} elements")
        return super().start(tag, attrs)

    def end(self, tag: str, /) -> ElementTree.Element:
        self._depth -= 1
        return super().end(tag)


def archive_of(content: bytes, most: int, members: int = MAX_MEMBERS) -> zipfile.ZipFile:
    """Return a zip archive of at most ``members`` files, which together unpack to at most ``most`` bytes.

    Raises ``ValueError`` for other archives. ``zipfile`` unpacks no more of a file than the archive states.
    """
    # Counted before ``zipfile`` reads the list of files, which may take more memory than the archive.
    if content.count(b"PK\x01\x02") > members:
        raise ValueError(f"an archive of more than {members:,} files")
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except (zipfile.BadZipFile, NotImplementedError, OSError) as error:
        raise ValueError(f"a damaged archive: {reason(error)}") from None
    files = archive.infolist()
    if sum(each.file_size for each in files) > most:
        raise ValueError(f"an archive whose files hold more than {_size(most)} together")
    if any(each.flag_bits & 1 or each.compress_type not in _PLAIN_MEMBERS for each in files):
        raise ValueError("an archive that is encrypted or has an unusual compression method")
    return archive


def member_of(archive: zipfile.ZipFile, name: str) -> bytes:
    """Return the content of a file of an archive. Raises ``ValueError`` if the file is damaged."""
    try:
        return archive.read(name)
    except (*DAMAGED, zipfile.BadZipFile, NotImplementedError, RuntimeError) as error:
        raise ValueError(f"{name} of the archive is damaged: {reason(error)}") from None


def _require_bounded(about: os.stat_result, path: str | Path, most: int) -> None:
    if stat.S_ISDIR(about.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(about.st_mode):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(path))
    if about.st_size > most:
        _too_large(path, most)


def _too_large(path: str | Path, most: int) -> NoReturn:
    raise OSError(errno.EFBIG, f"it holds more than {_size(most)}", str(path))


def _size(most: int) -> str:
    return f"{most >> 20} MiB" if most >> 20 else f"{most >> 10} KiB"


def _require_plain(content: bytes) -> None:
    """Raise ``ValueError`` for JSON that is too deep or too large, before it is decoded."""
    plain = _STRING.sub(b"", content)
    brackets = plain.translate(None, _NO_BRACKETS)
    if plain.count(b",") + len(brackets) / 2 > MAX_VALUES:
        raise ValueError(f"more than {MAX_VALUES:,} values")
    if _LONG.search(plain) or _HUGE.search(plain):
        raise ValueError(f"a number of more than {MAX_DIGITS} digits, or of 1e100 or more")
    for _ in range(MAX_DEPTH):
        brackets = brackets.replace(b"[]", b"").replace(b"{}", b"")
    # The decoder reports unmatched brackets, with line and column.
    is_deep = b"[]" in brackets or b"{}" in brackets
    if is_deep or brackets.count(b"[") + brackets.count(b"{") > MAX_DEPTH:
        raise ValueError(f"nested more than {MAX_DEPTH} deep")


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word} is not a number")
