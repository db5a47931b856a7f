"""Warnings for files of a grammar's folder that hold rules but are not read, such as ``rooms.LP``."""

import re
from collections.abc import Iterator
from pathlib import Path

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.opener import content_of

SUFFIXES = ".lp", ".pl"

TEXT = {".txt", ".asp", ".clingo", ".dl", ".pro", ".prolog"}
"""Suffixes of other files that may hold rules."""

MAX_BYTES = 1 << 20
"""Largest size of a file that is searched for rules, in bytes."""

RULE = re.compile(rb"(?m)^\s*:-\s|\)\s*:-\s|^[a-z]\w*\([^()\n]*\)\.\s*$")


def unread(directory: Path) -> Iterator[GrammarError]:
    """Yield a warning for each file that is probably meant as a rule file."""
    for file in sorted(directory.iterdir()):
        suffix = file.suffix.lower()
        if file.name.startswith(".") or file.suffix in SUFFIXES or not file.is_file():
            continue
        if suffix in SUFFIXES:
            meant = file.stem + suffix
        elif suffix in TEXT and file.stem.lower().endswith(SUFFIXES):
            meant = file.stem
        elif suffix in TEXT and RULE.search(_content(file)):
            meant = f"{file.stem}.lp, or {file.stem}.pl for lengths"
        else:
            continue
        yield GrammarError(f"is not read: rule files end in .lp or .pl. Rename it {meant}", file, 1, 1)


def _content(file: Path) -> bytes:
    try:
        return content_of(file, MAX_BYTES)
    except OSError:
        return b""
