"""A grammar is a directory of rule files: ``.lp`` for clingo, ``.pl`` for SWI-Prolog, all at its top."""

import hashlib
import os
import stat
from dataclasses import dataclass
from pathlib import Path

from logic.errors import GrammarError
from logic.spelling import unknown

SHIPPED = Path(__file__).parent / "grammars"
RULES = Path(__file__).parent / "rules"

MOST_BYTES = 1 << 24
"""What is read of a grammar, all its rule files together: those that we know have less than 20 kB."""


@dataclass(frozen=True)
class Grammar:
    """A grammar's name, its rule files and the hash that names their content."""

    name: str
    directory: Path
    asp: tuple[Path, ...]
    prolog: tuple[Path, ...]
    hash: str


def shipped() -> list[str]:
    """Names of the grammars that come with Vitruvius."""
    return sorted(path.name for path in SHIPPED.iterdir() if path.is_dir())


def find(grammar: str | Path) -> Grammar:
    """Find a shipped grammar by its name, or a user's by its directory.

    Raises ``GrammarError`` where there is none, or where it lacks ``.lp`` or ``.pl`` files, and for files
    that lie elsewhere, cannot be read, are devices or pipes, or hold more than ``MOST_BYTES``.
    """
    directory = SHIPPED / grammar if str(grammar) in shipped() else Path(grammar)
    if not directory.is_dir():
        raise GrammarError(f"there is no such directory, and {unknown('grammar', grammar, shipped())}")
    directory = directory.resolve()
    # Editors leave hidden files beside those that they edit.
    files = [file for file in sorted(directory.iterdir()) if not (file.name.startswith(".") or file.is_dir())]
    asp, prolog = (tuple(file for file in files if file.suffix == suffix) for suffix in (".lp", ".pl"))
    for file in asp + prolog:
        # What an error quotes of a rule file may be seen by others than the reader of what the link leads to.
        if Path(os.path.realpath(file)).parent != directory:
            raise GrammarError("is a link out of the grammar's directory: copy the file there", file)
    for found, kind in ((asp, ".lp"), (prolog, ".pl")):
        if not found:
            raise GrammarError(
                f"the grammar has no {kind} file. Copy {SHIPPED / 'family'} and edit it", directory
            )
    return Grammar(directory.name, directory, asp, prolog, _hash(asp + prolog))


def _hash(files: tuple[Path, ...]) -> str:
    """SHA-256 of the grammar's files and of the shared core's: the rules that made a house."""
    digest, left = hashlib.sha256(), MOST_BYTES
    for file in (*files, *sorted(RULES.glob("*.[lp][lp]"))):
        try:
            # Not to wait where it is a pipe: what is read is what was opened.
            with open(file, "rb", opener=lambda path, flags: os.open(path, flags | os.O_NONBLOCK)) as rules:
                if not stat.S_ISREG(os.fstat(rules.fileno()).st_mode):
                    raise GrammarError("is a device or a pipe, and no file of rules", file)
                content = rules.read(left + 1)
        except OSError as error:
            raise GrammarError(f"cannot be read: {error.strerror}", file) from None
        left -= len(content)
        if left < 0:
            most = f"{MOST_BYTES >> 20} MiB"
            raise GrammarError(f"with this file the grammar holds more than {most}: it is not read", file)
        digest.update(f"{file.name} {len(content)}\n".encode() + content)
    return digest.hexdigest()
