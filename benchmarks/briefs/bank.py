"""The frozen bank of briefs, ``briefs-v1.jsonl.gz``: a brief per line, with the known part of its answer."""

import gzip
import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import msgspec

from vitruvius.logic.errors import HouseFileError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.request.brief import Brief, read_brief

FILE = Path(__file__).with_name("briefs-v1.jsonl.gz")
HASH = "58b4ab9521c5c4a7da9522b591a271608d0093288888aa1f1c45c898a4878a46"
"""Hash of the uncompressed lines. The bank is frozen: other briefs need another name."""

Kind = Literal["house", "dissection", "changed", "impossible"]
"""Origin of a brief: a generated house; a random dissection; either of these with one line changed; or
impossible by construction."""


class BriefEntry(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """A brief of the bank."""

    name: str
    kind: Kind
    source: str
    """Grammar of the house, change of the brief, or reason why it is impossible."""
    brief: dict[str, Any]
    """JSON of the brief: ``docs/briefs.md``."""
    answer: Literal["house", "impossible", "unknown"] = "unknown"
    """Answer by construction."""
    grammar: str = ""
    """Grammar by which the house was made and is furnished."""

    @property
    def rooms(self) -> int:
        """Number of rooms that the brief names."""
        return len(self.brief["rooms"])

    @property
    def read(self) -> Brief:
        """The brief, read from JSON."""
        return read_brief(self.brief)


def packed(entries: Iterable[BriefEntry]) -> bytes:
    """Return the lines of a bank."""
    return b"".join(msgspec.json.encode(entry) + b"\n" for entry in entries)


def save_entries(entries: Iterable[BriefEntry], path: Path) -> str:
    """Write a bank, and return its hash."""
    lines = packed(entries)
    write_whole(path, gzip.compress(lines, mtime=0))
    return hashlib.sha256(lines).hexdigest()


def frozen() -> list[BriefEntry]:
    """Return the frozen bank. Raises ``HouseFileError`` if its file holds other briefs."""
    lines = gzip.decompress(FILE.read_bytes())
    if hashlib.sha256(lines).hexdigest() != HASH:
        raise HouseFileError(f"{FILE}: not the held-out set ({HASH[:12]}). Restore it from Git")
    return [msgspec.json.decode(line, type=BriefEntry) for line in lines.splitlines()]
