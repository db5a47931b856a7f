"""Hostile input: its purpose, its maker, and the right answers."""

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from vitruvius.logic.grammar import SHIPPED

REFUSED, LIMITED, ACCEPTED = "refused", "limited", "accepted"
"""Kinds of answers: an error of ours with its place; a stated limit; accepted as data, without an effect."""

STOPPED = (REFUSED, LIMITED)
HARMLESS = (REFUSED, LIMITED, ACCEPTED)

SECRET = "swordfish-1729"
"""Text that no answer may show: it is in a file outside the input."""


@dataclass(frozen=True)
class Yard:
    """Folder with a hostile input and everything within its reach, which must stay unchanged."""

    root: Path
    port: int
    """Port of a server to which nothing may connect."""

    @property
    def input(self) -> Path:
        """Folder of the input."""
        return self.root / "input"

    @property
    def out(self) -> Path:
        """Only folder where files may be written."""
        return self.root / "out"

    @property
    def trace(self) -> Path:
        """File that each of the inputs tries to make."""
        return self.root / "canary" / "trace"

    @property
    def secret(self) -> Path:
        """File that some inputs try to read or to delete."""
        return self.root / "canary" / "secret.lp"

    @cached_property
    def words(self) -> dict[str, str]:
        """Words in the text of an input, and the places that replace them."""
        evil = self.root / "canary" / "evil.pl"
        names = {"TRACE": self.trace, "SECRET": self.secret, "EVIL": evil, "PORT": self.port}
        return {name: str(place) for name, place in names.items()} | {"TOUCH": f"touch {self.trace}"}

    def lay_out(self) -> None:
        """Make the folders and the files in them."""
        for folder in ("input", "out", "canary", "home"):
            (self.root / folder).mkdir(parents=True)
        self.secret.write_text(f'password("{SECRET}"). {SECRET} ?!\n')
        (self.root / "canary" / "evil.pl").write_text(self.filled(":- shell('TOUCH').\n"))

    def filled(self, text: str) -> str:
        """Return a text with the places of this yard in it."""
        for word, place in self.words.items():
            text = text.replace(word, place)
        return text

    def clear(self) -> None:
        """Remove everything, folders included that may not be written."""
        for folder, _, _ in os.walk(self.root):
            os.chmod(folder, 0o700)
        shutil.rmtree(self.root)


@dataclass(frozen=True)
class Case:
    """Input of a kind, with a title that is unique within the collection."""

    kind: str
    title: str
    make: Callable[[Yard], Path]
    """Function that writes the input into a yard and returns its path."""
    answers: tuple[str, ...]
    """Right answers."""
    says: str = ""
    """Word of the refusal's message."""

    def __str__(self) -> str:
        """Return the case's name in pytest."""
        return f"{self.kind}: {self.title}"


def grammar(yard: Yard, **files: str | bytes) -> Path:
    """Return a copy of ``family`` with text added to ``rooms`` (.lp) or ``sizes`` (.pl), or with new files.

    A text with its own clause for ``room_gap/1`` replaces the existing clause.
    """
    folder = yard.input / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    folder.chmod(0o755)
    for name, text in files.items():
        path = folder / {"rooms": "rooms.lp", "sizes": "sizes.pl"}.get(name, name)
        more = yard.filled(text).encode("utf-8", "surrogateescape") if isinstance(text, str) else text
        before = path.read_bytes() if path.exists() else b""
        if b"room_gap(" in more:
            before = before.replace(b"room_gap(0.6).", b"")
        path.write_bytes(before + more + (b"\n" if isinstance(text, str) else b""))
    return folder


def titled(text: str) -> str:
    """Return a text as a title: short and printable."""
    line = ascii(text)[1:-1].replace("\\n", " ").replace("\\'", "'").replace("\\\\", "\\")
    return line if len(line) <= 60 else f"{line[:57]}..."
