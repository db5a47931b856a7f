"""Rule files that others include: ``#include "home/furniture.lp".`` and ``:- include('home/furniture.pl').``

Includes stand at the top of a file, one a line, above all but comments of one line: so what a grammar
consists of is known before any rule is read, and nothing in clingo's or Prolog's language can hide an include
or feign one. No solver sees them: it reads the included file, and of the other one what stands below.
"""

import os
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from logic.errors import GrammarError
from logic.spelling import closest, printable

EXAMPLES = {".lp": '#include "home/furniture.lp".', ".pl": ":- include('home/furniture.pl')."}

LINES = {
    ".lp": re.compile(r'^[ \t]*(?:(#)include[ \t]*"([^"]*)"[ \t]*\.[ \t]*)?(?:%(?!\*)[^\n]*)?\r?$'),
    ".pl": re.compile(
        r"^[ \t]*(?:(:)-[ \t]*include\([ \t]*['\"]([^'\"]*)['\"][ \t]*\)[ \t]*\.[ \t]*)?(?:%[^\n]*)?\r?$"
    ),
}
"""A line above a file's rules: its first group is where an include begins, its second the path."""

SAYS = {
    "elsewhere": "an include stands at the top of its file, alone on its line, as in {example}",
    "outside": "{file} lies outside: an include names a file of a shipped grammar, as in {example}, or one "
    "below the folder of this file",
    "kind": "{file}: a {suffix} file includes {suffix} files alone",
    "absent": "there is no file {file}: {hint}",
    "circle": "a circle: {file} includes itself{way}",
    "twice": "{file} is included already, at {place}: leave one of them out",
    "anyway": "{file} is read anyway, as all files of the grammar's folder are: leave this out",
}
"""What is wrong with an include; ``elsewhere`` where it stands below a rule."""


class Include(NamedTuple):
    """The path that an include names, and where it stands, counted from 1."""

    path: str
    line: int
    column: int


def includes(text: str, suffix: str) -> Iterator[Include]:
    """The includes of a file with this suffix."""
    for number, line in enumerate(text.split("\n"), start=1):
        found = LINES[suffix].match(line)
        if not found:
            return
        if found[1]:
            yield Include(found[2], number, found.start(1) + 1)


def height(text: str, suffix: str) -> int:
    """How many lines at the top of a file no solver reads: down to the last include."""
    return max((each.line for each in includes(text, suffix)), default=0)


def below(text: str, suffix: str) -> str:
    """What a solver reads of a file, each part in its line."""
    number = height(text, suffix)
    return "\n" * number + "\n".join(text.split("\n")[number:])


def name_in(file: Path, directory: Path, shipped: Path) -> str:
    """A grammar's file in short: ``rooms.lp``, and of another grammar, a shipped one, ``home/sizes.pl``."""
    return file.relative_to(directory if directory in file.parents else shipped).as_posix()


class Reading:
    """The files of a grammar, each once, after those that it includes, and what is wrong with includes."""

    def __init__(self, directory: Path, shipped: Path, read: Callable[[Path], bytes]) -> None:
        """Know the grammar's folder, and that of the shipped ones. ``read`` may raise ``GrammarError``."""
        self._directory, self._shipped, self._read = directory, Path(os.path.realpath(shipped)), read
        self.contents: dict[Path, bytes] = {}
        self.errors: list[GrammarError] = []
        self._named: dict[Path, str] = {}

    def follow(self, files: Sequence[Path]) -> tuple[Path, ...]:
        """These files of the grammar's folder, with all that they include."""
        found: list[Path] = []
        for file in files:
            # Not by recursion: a row of includes may be long.
            path = [(file, self._includes(file))]
            while path:
                above, rest = path[-1]
                if include := next(rest, None):
                    path += self._included(above, include, [each for each, _ in path])
                else:
                    found.append(path.pop()[0])
        return tuple(found)

    def _includes(self, file: Path) -> Iterator[Include]:
        """Those of a file, which is read now."""
        try:
            self.contents[file] = self._read(file)
        except GrammarError as error:
            self.errors.append(error)
            return iter(())
        return includes(self.contents[file].decode("utf-8", "replace"), file.suffix)

    def _included(
        self, above: Path, include: Include, path: Sequence[Path]
    ) -> list[tuple[Path, Iterator[Include]]]:
        """The file that is included in ``above``, with what it includes itself; none where that is wrong."""
        try:
            other = self._resolved(above, include.path)
            self._refuse_again(other, path)
        except GrammarError as error:
            self.errors.append(GrammarError(error.message, above, include.line, include.column))
            return []
        self._named[other] = f"{self.name(above)}:{include.line}"
        return [(other, self._includes(other))]

    def name(self, file: Path) -> str:
        """See ``name_in``."""
        return name_in(file, self._directory, self._shipped)

    def _resolved(self, above: Path, path: str) -> Path:
        """The file that ``above`` means: beside it, or else in the folder of shipped grammars."""
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
        """Raise an error where a file would be read twice."""
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
