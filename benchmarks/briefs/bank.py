"""The frozen bank of briefs, ``briefs-v1.jsonl.gz``: a brief a line, with what is known of its answer."""

import gzip
import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import msgspec

from logic.errors import HouseFileError
from logic.house.files import write_whole
from logic.request.brief import Brief, read_brief

FILE = Path(__file__).with_name("briefs-v1.jsonl.gz")
HASH = "58b4ab9521c5c4a7da9522b591a271608d0093288888aa1f1c45c898a4878a46"
"""Of its lines, unpacked. The bank is frozen: other briefs get another name."""

Kind = Literal["house", "dissection", "changed", "impossible"]
"""Read off a generated house; off a random dissection; either of these with one line changed; impossible."""


class BriefEntry(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """A brief of the bank."""

    name: str
    kind: Kind
    source: str
    """The grammar of the house, how the brief was changed, or why it is impossible."""
    brief: dict[str, Any]
    """Its JSON: ``docs/briefs.md``."""
    answer: Literal["house", "impossible", "unknown"] = "unknown"
    """By construction."""
    grammar: str = ""
    """By whose rules the house was made: it is furnished by them too."""

    @property
    def rooms(self) -> int:
        """How many rooms it names."""
        return len(self.brief["rooms"])

    @property
    def read(self) -> Brief:
        """The brief."""
        return read_brief(self.brief)


def packed(entries: Iterable[BriefEntry]) -> bytes:
    """The lines of a bank."""
    return b"".join(msgspec.json.encode(entry) + b"\n" for entry in entries)


def save_entries(entries: Iterable[BriefEntry], path: Path) -> str:
    """Write a bank, and give its hash."""
    lines = packed(entries)
    write_whole(path, gzip.compress(lines, mtime=0))
    return hashlib.sha256(lines).hexdigest()


def frozen() -> list[BriefEntry]:
    """The frozen bank. Raises ``HouseFileError`` where its file holds other briefs."""
    lines = gzip.decompress(FILE.read_bytes())
    if hashlib.sha256(lines).hexdigest() != HASH:
        raise HouseFileError(f"{FILE}: not the frozen bank ({HASH[:12]}). Restore it from Git")
    return [msgspec.json.decode(line, type=BriefEntry) for line in lines.splitlines()]
