"""Files that others include: ``#include "home/furniture.lp".`` and ``:- include('home/furniture.pl')``.

Includes stand at the top of a file, one a line, with only one-line comments between them. Therefore the files
of a grammar are known before any rule is read, and no construct of clingo or Prolog can hide or fake an
include. The solver never sees an include. It reads the included file, and the part of the including file
below the includes.
"""

import os
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.spelling import closest, printable

EXAMPLES = {".lp": '#include "home/furniture.lp".', ".pl": ":- include('home/furniture.pl')."}

LINES = {
    ".lp": re.compile(r'^[ \t]*(?:(#)include[ \t]*"([^"]*)"[ \t]*\.[ \t]*)?(?:%(?!\*)[^\n]*)?\r?$'),
    ".pl": re.compile(
        r"^[ \t]*(?:(:)-[ \t]*include\([ \t]*['\"]([^'\"]*)['\"][ \t]*\)[ \t]*\.[ \t]*)?(?:%[^\n]*)?\r?$"
    ),
}
"""Line at the top of a file. Its first group marks the column of an include, the second is the path."""

SAYS = {
    "elsewhere": "an include must be at the top of its file, alone on its line, as in {example}",
    "outside": "{file} lies outside: an include names a file of a shipped grammar, as in {example}, or one "
    "below the folder of this file",
    "kind": "{file}: a {suffix} file includes only {suffix} files",
    "absent": "there is no file {file}: {hint}",
    "circle": "a circle: {file} includes itself{way}",
    "twice": "{file} is included already, at {place}: leave one of them out",
    "anyway": "{file} is read anyway, as all files of the grammar's folder are: leave this out",
}
"""Messages for wrong includes. ``elsewhere`` is for an include below a rule."""


class Include(NamedTuple):
    """Path that an include names, and its line and column, counted from 1."""

    path: str
    line: int
    column: int


def includes(text: str, suffix: str) -> Iterator[Include]:
    """Yield the includes of a file with this suffix."""
    for number, line in enumerate(text.split("\n"), start=1):
        found = LINES[suffix].match(line)
        if not found:
            return
        if found[1]:
            yield Include(found[2], number, found.start(1) + 1)


def height(text: str, suffix: str) -> int:
    """Return the number of lines at the top of a file that no solver reads, down to the last include."""
    return max((each.line for each in includes(text, suffix)), default=0)


def below(text: str, suffix: str) -> str:
    """Return the part of a file that a solver reads, with its line numbers unchanged."""
    number = height(text, suffix)
    return "\n" * number + "\n".join(text.split("\n")[number:])


def name_in(file: Path, directory: Path, shipped: Path) -> str:
    """Return the short name of a file: ``rooms.lp``, or ``home/sizes.pl`` for a file of a shipped grammar."""
    return file.relative_to(directory if directory in file.parents else shipped).as_posix()


class Reading:
    """Files of a grammar, each once and after the files that it includes, and the errors in its includes."""

    def __init__(self, directory: Path, shipped: Path, read: Callable[[Path], bytes]) -> None:
        """Set the grammar's folder and the folder of shipped grammars.

        ``read`` may raise ``GrammarError``.
        """
        self._directory, self._shipped, self._read = directory, Path(os.path.realpath(shipped)), read
        self.contents: dict[Path, bytes] = {}
        self.errors: list[GrammarError] = []
        self._named: dict[Path, str] = {}

    def follow(self, files: Sequence[Path]) -> tuple[Path, ...]:
        """Return these files of the grammar's folder and all files that they include."""
        found: list[Path] = []
        for file in files:
            # A loop, because a chain of includes may exceed the recursion limit.
            path = [(file, self._includes(file))]
            while path:
                above, rest = path[-1]
                if include := next(rest, None):
                    path += self._included(above, include, [each for each, _ in path])
                else:
                    found.append(path.pop()[0])
        return tuple(found)

    def _includes(self, file: Path) -> Iterator[Include]:
        """Read a file and return its includes."""
        try:
            self.contents[file] = self._read(file)
        except GrammarError as error:
            self.errors.append(error)
            return iter(())
        return includes(self.contents[file].decode("utf-8", "replace"), file.suffix)

    def _included(
        self, above: Path, include: Include, path: Sequence[Path]
    ) -> list[tuple[Path, Iterator[Include]]]:
        """Return the file that ``above`` includes, with its own includes; nothing if the include is wrong."""
        try:
            other = self._resolved(above, include.path)
            self._refuse_again(other, path)
        except GrammarError as error:
            self.errors.append(GrammarError(error.message, above, include.line, include.column))
            return []
        self._named[other] = f"{self.name(above)}:{include.line}"
        return [(other, self._includes(other))]

    def name(self, file: Path) -> str:
        """Return the short name of a file: see ``name_in``."""
        return name_in(file, self._directory, self._shipped)

    def _resolved(self, above: Path, path: str) -> Path:
        """Return the file that ``above`` means, either beside it or in the folder of shipped grammars."""
        suffix = above.suffix
        said = {"file": printable(path), "suffix": suffix, "example": EXAMPLES[suffix]}
        if path.startswith("/") or ".." in PurePosixPath(path).parts:
            raise _wrong("outside", **said)
        if path.endswith(tuple(EXAMPLES.keys() - {suffix})):
            raise _wrong("kind", **said)
        for folder in (above.parent, self._shipped):
            if path.endswith(suffix) and os.path.isfile(folder / path):
                found = Path(os.path.realpath(folder / path))
                if {self._directory, self._shipped}.isdisjoint(found.parents):
                    raise _wrong("outside", **said)
                return found
        known = {*self._shipped.glob(f"*/*{suffix}"), *above.parent.glob(f"*/*{suffix}")}
        near = closest(path, [f"{each.parent.name}/{each.name}" for each in known])
        hint = f"did you mean {near}?" if near else "neither beside this file nor in a shipped grammar"
        raise _wrong("absent", **said, hint=hint)

    def _refuse_again(self, other: Path, path: Sequence[Path]) -> None:
        """Raise ``GrammarError`` if an include would read a file twice."""
        name = self.name(other)
        if other in path:
            way = ", ".join(self.name(each) for each in path[path.index(other) + 1 :])
            raise _wrong("circle", file=name, way=way and f" by way of {way}")
        if other in self._named:
            raise _wrong("twice", file=name, place=self._named[other])
        if other.parent == self._directory:
            raise _wrong("anyway", file=name)


def _wrong(what: str, **parts: str) -> GrammarError:
    return GrammarError(SAYS[what].format(**parts))
