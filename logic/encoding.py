"""Checks that text files are UTF-8, and messages that name another encoding or the first wrong place."""

import codecs
import unicodedata

MARKS = {
    codecs.BOM_UTF32_LE: "UTF-32",
    codecs.BOM_UTF32_BE: "UTF-32",
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
}
"""First bytes of files in other encodings, longer marks first."""


def illegible(content: bytes) -> tuple[int, int, str] | None:
    """Return line, column and message for the first part of a file's content that is not UTF-8, or None."""
    for mark, name in MARKS.items():
        if content.startswith(mark):
            return 1, 1, f"this file is {name}: save it as UTF-8"
    if content and content.count(0) > len(content) / 4:
        return 1, 1, "this file is UTF-16 or not text: save it as UTF-8"
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        byte = content[error.start : error.start + 1]
        meant = byte.decode("cp1252", "replace")
        return *_place(
            content[: error.start]
        ), f"not UTF-8: byte {byte[0]:#x}, {meant} in Latin-1: save as UTF-8"
    for place, letter in enumerate(text):
        if letter == "\0":
            return *_place(text[:place].encode()), "a NUL character: this is not text"
        if letter == "\r" and text[place + 1 : place + 2] != "\n":
            return *_place(
                text[:place].encode()
            ), "a line ends with a carriage return only: save with LF line endings"
    return None


def _place(before: bytes) -> tuple[int, int]:
    """Return the line and the column of the byte that follows ``before``."""
    *lines, last = before.split(b"\n")
    return len(lines) + 1, len(last.decode("utf-8", "replace").removeprefix("\ufeff")) + 1


def shown(letter: str) -> str:
    """Return a letter as it is if it is visible, else its number and name."""
    if letter.isprintable() and not unicodedata.combining(letter):
        return letter
    return f"U+{ord(letter):04X} ({unicodedata.name(letter, 'a control character')})"
