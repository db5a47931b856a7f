"""A hostile input: what it tries, how it is made, and what must be answered."""

import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from logic.grammar import SHIPPED

REFUSED, LIMITED, ACCEPTED = "refused", "limited", "accepted"
"""An error of ours with its place; a stated limit; taken as data, without an effect."""

STOPPED = (REFUSED, LIMITED)
HARMLESS = (REFUSED, LIMITED, ACCEPTED)

SECRET = "swordfish-1729"
"""What no answer may show: it stands in a file that is no part of the input."""


@dataclass(frozen=True)
class Yard:
    """A folder with a hostile input and all that it may reach for, which must stay as it is."""

    root: Path
    port: int
    """Where a server listens to which nothing may connect."""

    @property
    def input(self) -> Path:
        """Where the input lies."""
        return self.root / "input"

    @property
    def out(self) -> Path:
        """The only place where files may be written."""
        return self.root / "out"

    @property
    def trace(self) -> Path:
        """A file that each of the inputs tries to make."""
        return self.root / "canary" / "trace"

    @property
    def secret(self) -> Path:
        """A file that others try to read, and to delete."""
        return self.root / "canary" / "secret.lp"

    @cached_property
    def words(self) -> dict[str, str]:
        """What stands for these places in the text of an input."""
        evil = self.root / "canary" / "evil.pl"
        names = {"TRACE": self.trace, "SECRET": self.secret, "EVIL": evil, "PORT": self.port}
        return {name: str(place) for name, place in names.items()} | {"TOUCH": f"touch {self.trace}"}

    def lay_out(self) -> None:
        """Make the folders and what lies in them."""
        for folder in ("input", "out", "canary", "home"):
            (self.root / folder).mkdir(parents=True)
        self.secret.write_text(f'password("{SECRET}"). {SECRET} ?!\n')
        (self.root / "canary" / "evil.pl").write_text(self.filled(":- shell('TOUCH').\n"))

    def filled(self, text: str) -> str:
        """A text with the places of this yard in it."""
        for word, place in self.words.items():
            text = text.replace(word, place)
        return text

    def clear(self) -> None:
        """Take everything away, folders included that may not be written."""
        for folder, _, _ in os.walk(self.root):
            os.chmod(folder, 0o700)
        shutil.rmtree(self.root)


@dataclass(frozen=True)
class Case:
    """An input of a kind, by a title that is its own within the collection."""

    kind: str
    title: str
    make: Callable[[Yard], Path]
    """Writes the input into a yard; gives its path."""
    answers: tuple[str, ...]
    """Which answers are right."""
    says: str = ""
    """A word of the refusal's message."""

    def __str__(self) -> str:
        """Its name in pytest."""
        return f"{self.kind}: {self.title}"


def grammar(yard: Yard, **files: str | bytes) -> Path:
    """A copy of ``family`` with more at the end of its files, ``rooms`` (.lp), ``sizes`` (.pl), or new ones.

    A text with a clause of its own for ``room_gap/1`` takes the place of the one that is there.
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
    """A text as a title: short and printable."""
    line = ascii(text)[1:-1].replace("\\n", " ").replace("\\'", "'").replace("\\\\", "\\")
    return line if len(line) <= 60 else f"{line[:57]}..."
