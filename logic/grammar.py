"""A grammar is a directory of rule files: ``.lp`` for clingo, ``.pl`` for SWI-Prolog, all at its top.

A file may include one of a shipped grammar: see ``includes.py``.
It may name a topology, how rooms lie together: a file of ``rules/topologies``, or its own file of that name.
"""

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from errno import EFBIG
from pathlib import Path

from logic.copies import Stated, original, stated_by, statements
from logic.errors import GrammarError, Reason
from logic.includes import Reading, name_in
from logic.opener import content_of
from logic.spelling import printable, unknown

SHIPPED = Path(__file__).parent / "grammars"
RULES = Path(__file__).parent / "rules"

TOPOLOGIES, SHARED_WALLS = RULES / "topologies", RULES / "shared_walls"
STAR = TOPOLOGIES / "star.lp"
"""The topology of a grammar that names none."""

ADJACENT = SHARED_WALLS / "adjacent.lp"
"""Which rooms share a wall: read where a rule names ``adjacent``, since it takes choices of its own."""

GUARD = SHARED_WALLS / "topology.lp"
"""What a topology of the user's own keeps, whatever it says."""

PLANS = tuple(SHARED_WALLS / name for name in ("access.lp", "differences.lp", "stated.lp"))
"""What all other topologies share: rooms that share walls, and doors in them."""

STATED = SHARED_WALLS / "stated.lp"
"""What a topology states, and no other file of a grammar."""

ACCESS, OWN = SHARED_WALLS / "access.lp", SHARED_WALLS / "own.lp"
"""Files that replace the topology for a plan of the user's."""

DISSECTION, BRIEF = TOPOLOGIES / "dissection.lp", RULES / "brief" / "brief.lp"
"""Files that replace the grammar's topology for a house by a brief."""

Places = frozenset[tuple[str, int, int]]
"""Places of rules: file, line and column at which each begins."""

TYPICAL = "typical"
"""Name of the ``#program`` whose rules give way to the user's statements about rooms."""

COMMENT = re.compile(r"%\*.*?(?:\*%|\Z)|%[^\n]*", re.DOTALL)
"""Of clingo's language."""

TYPES = re.compile(r"\btype\s{0,9}\(([\w\s;()]{0,999})\)\s{0,9}\.")
"""Fact that names room types."""

LENGTHS = ("door_width", "door_clearance", "passage", "room_gap")
"""The lengths that the ``.pl`` files of every grammar state, each as a fact of this name."""

IN_PROLOG = {
    **dict.fromkeys((*LENGTHS, "door_margin", "window_margin", "unit_depth"), 1),
    **dict.fromkeys(("house_size", "house_area", "turning", "wall_thickness"), 2),
    **dict.fromkeys(("room_size", "room_area", "whole_area", "window_size"), 3),
    **dict.fromkeys(("piece_size", "opening_size"), 4),
}
"""All predicates that ``.pl`` files may state, and how many arguments each has."""

MOST_BYTES = 1 << 24
"""What is read of a grammar, all its rule files together: those that we know have less than 20 kB."""


@dataclass(frozen=True)
class Grammar:
    """A grammar's name, its rule files and the hash that names their content."""

    name: str
    directory: Path
    own: tuple[Path, ...]
    """The ``.lp`` files: those of shipped grammars that it includes, then those of its directory, each after
    what it includes. So a conflict between both is found at a line of the user's."""
    topology: tuple[Path, ...]
    """The shared ``.lp`` files that come with its topology."""
    topology_name: str
    prolog: tuple[Path, ...]
    """The ``.pl`` files, likewise."""
    hash: str
    gave_way: tuple[Reason, ...] = ()
    """Typical rules that are left out because they contradict the user's statements about rooms."""

    @property
    def asp(self) -> tuple[Path, ...]:
        """All that clingo reads beside the core."""
        return self.topology + self.own

    @property
    def left_out(self) -> Places:
        """Places of the typical rules that are left out."""
        return frozenset((str(each.file), each.line or 1, each.column or 1) for each in self.gave_way)

    @property
    def shares_walls(self) -> bool:
        """True if the rooms of its houses share walls; only the rooms of stars do not."""
        return set(PLANS) <= set(self.topology)

    def name_of(self, file: Path) -> str:
        """Return the short name of one of the grammar's files: see ``name_in``."""
        return name_in(file, self.directory, SHIPPED.resolve())

    def cited(self, rule: Reason) -> str:
        """Return a rule with its place as a house file cites it: without the folders of this machine."""
        return f"{self.name_of(Path(str(rule.file)))}:{rule.line}:{rule.column}: {rule.text}"

    def for_brief(self) -> "Grammar":
        """Return the grammar with the topology of a brief: see ``logic.generation.brief``."""
        own = tuple(file for file in self.own if file.stem != self.topology_name)
        topology = (*PLANS, ADJACENT, DISSECTION, BRIEF)
        return replace(self, own=own, topology=topology, topology_name=DISSECTION.stem)

    @property
    def types(self) -> frozenset[str]:
        """Room types that the grammar's files state as facts, found in the text without solving."""
        texts = (COMMENT.sub("", _content(file, MOST_BYTES).decode("utf-8", "replace")) for file in self.own)
        return frozenset(
            name for text in texts for some in TYPES.findall(text) for name in re.findall(r"\w+", some)
        )

    @property
    def names_contacts(self) -> bool:
        """Whether a rule asks which rooms share a wall."""
        return ADJACENT in self.topology

    def for_own_plan(self) -> "Grammar":
        """The same rules without their topology: those of a user's plan (``logic.request.given_plan``)."""
        own = tuple(file for file in self.own if file.stem != self.topology_name)
        return replace(self, own=own, topology=(ACCESS, STATED, OWN), topology_name=OWN.stem)


def shipped() -> list[str]:
    """Names of the grammars that come with Vitruvius."""
    return sorted(path.name for path in SHIPPED.iterdir() if path.is_dir())


def find_shipped(name: str) -> Grammar:
    """Return the shipped grammar that a file names. Raises ``GrammarError`` for another name: a file may not
    name a path.
    """
    if name not in shipped():
        raise GrammarError(unknown("grammar", name, shipped()))
    return find(name)


def find(grammar: str | Path) -> Grammar:
    """Find a shipped grammar by its name, or a user's by its directory.

    Raises ``GrammarError`` if there is none, or where it lacks ``.lp`` or ``.pl`` files, and for files
    that lie elsewhere, cannot be read, are devices or pipes, are copies of others, hold more than
    ``MOST_BYTES``, or include what they may not.
    """
    directory = folder(grammar)
    # Editors leave hidden files beside those that they edit.
    files = [file for file in sorted(directory.iterdir()) if not (file.name.startswith(".") or file.is_dir())]
    asp, prolog = (tuple(file for file in files if file.suffix == suffix) for suffix in (".lp", ".pl"))
    for file in asp + prolog:
        if not _is_utf8(file):
            raise GrammarError(
                "its name is no UTF-8, which the solvers read: rename it", printable(str(file))
            )
        # What an error quotes of a rule file may be seen by others than the reader of what the link leads to.
        if Path(os.path.realpath(file)).parent != directory:
            raise GrammarError("is a link out of the grammar's directory: copy the file there", file)
    for found, kind in ((asp, ".lp"), (prolog, ".pl")):
        if not found:
            near = next((file.name for file in files if kind in file.name.lower()), "")
            hint = f": rename {near}" if near else f". Copy {SHIPPED / 'home'} and edit it"
            raise GrammarError(f"the grammar has no {kind} file{hint}", directory)
    reading = reading_of(directory)
    asp, prolog = (
        tuple(sorted(reading.follow(files), key=lambda file: directory in file.parents))
        for files in (asp, prolog)
    )
    texts = {file: content.decode("utf-8", "replace") for file, content in reading.contents.items()}
    stated = {file: statements(texts[file], file.suffix) for file in asp + prolog if file in texts}
    for error in reading.errors:
        copy = Path(str(error.file))
        if copy in stated:  # What a copy includes is not beside it, or included already.
            mine = {copy: stated.pop(copy)}
            _require_no_copies(stated | mine, directory, copy)
            _require_nothing_of_the_core(mine, None)
        raise error
    _require_no_copies(stated, directory)
    digest = _hash((file, reading.contents[file]) for file in asp + prolog)
    topology, name = _topology({file: texts[file] for file in asp})
    _require_nothing_of_the_core(stated, name)
    return Grammar(directory.name, directory, asp, topology, name, prolog, digest)


def _require_no_copies(stated: Stated, directory: Path, only: Path | None = None) -> None:
    """Raise ``GrammarError`` for a file, or for this one ``only``, that is a copy of one before it."""
    before: dict[Path, frozenset[str]] = {}
    for file, mine in stated.items():
        if (only in (None, file)) and (first := original(file, mine, before)):
            name = name_in(first, directory, SHIPPED.resolve())
            what = f"states what {name} states, and all rule files of the folder are read"
            if first.parent != directory:
                what = f"states what {name} states, which is included"
            raise GrammarError(f"{what}: keep one of the two", file)
        before[file] = mine


def _require_nothing_of_the_core(stated: Stated, topology: str | None) -> None:
    """Raise ``GrammarError`` for copies of shared files, but that a topology of a user's may be one: that of
    this name, if it is known.
    """
    for file, mine in stated.items():
        if not (copied := original(file, mine, stated_by(RULES))):
            continue
        # A star has no walls, and what comes with another file is no single topology.
        usable = (
            copied.parent == TOPOLOGIES and copied != STAR and "#include" not in copied.read_text("utf-8")
        )
        if not usable:
            why = f"is a copy of {copied}, which is loaded by itself where it is needed: take it away"
            raise GrammarError(why, file)
        if topology and file.stem != topology:
            own = "make it a topology of your own: topology(mine) names a file mine.lp"
            why = f"is a copy of {copied}, and the topology here is {topology}: take it away, or {own}"
            raise GrammarError(why, file)


def reading_of(directory: Path) -> Reading:
    """What is to read a grammar's files and all that they include; it refuses what is not to be read."""
    left = MOST_BYTES

    def read(file: Path) -> bytes:
        nonlocal left
        content = _content(file, left)
        left -= len(content)
        return content

    return Reading(directory, SHIPPED, read)


def _is_utf8(path: Path) -> bool:
    try:
        os.fsencode(path).decode()
    except UnicodeDecodeError:
        return False
    return True


def folder(grammar: str | Path) -> Path:
    """The directory of a grammar, whatever is in it. Raises ``GrammarError`` if there is none."""
    directory = SHIPPED / grammar if str(grammar) in shipped() else Path(grammar)
    if str(grammar) == "-":
        raise GrammarError("-: a grammar is a folder of rule files, and not read from the standard input")
    if directory.is_file():
        meant = f": did you mean {directory.parent}?" if directory.suffix in (".lp", ".pl") else ""
        raise GrammarError(f"is a file, and a grammar is a folder of rule files{meant}", directory)
    if not directory.is_dir():
        raise GrammarError(f"there is no such directory, and {unknown('grammar', grammar, shipped())}")
    return directory.resolve()


def _topology(texts: Mapping[Path, str]) -> tuple[tuple[Path, ...], str]:
    """The shared files of the topology that a fact in these files names, and its name.

    It is read as text, since what comes with it must be known before any rule is, and rules of others are
    parsed in a confined process alone. That one holds that the rules say the same (``loaded.py``).
    """
    own = {file.stem for file in texts}
    known = {file.stem: file for file in sorted(TOPOLOGIES.glob("*.lp"))}
    named: list[str] = []
    first = ""
    plans = PLANS
    for file, source in texts.items():
        text = COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), source)
        if re.search(r"\badjacent\s*\(", text):
            plans = (*PLANS, ADJACENT)
        for found in re.finditer(r"\btopology\s*\(\s*(\w+)\s*\)\s*\.", text):
            before = text[: found.start()].split("\n")
            place, name = (file, len(before), len(before[-1]) + 1), found[1]
            if named:
                raise GrammarError(
                    f"a grammar has one topology, and {first} names {named[0]}: keep one", *place
                )
            if name not in own and name not in known:
                hint = unknown("topology", name, known)
                raise GrammarError(f"{hint}; one of yours is a file {name}.lp beside this one", *place)
            named.append(name)
            first = ":".join(map(str, (file.name, *place[1:])))
    if not named or (named[0] == STAR.stem and STAR.stem not in own):
        return (STAR,), STAR.stem
    return (*plans, GUARD if named[0] in own else known[named[0]]), named[0]


def _content(file: Path, most: int) -> bytes:
    """What a rule file holds, of at most so many bytes."""
    try:
        return content_of(file, most, unpack=False)
    except OSError as error:
        if error.errno == EFBIG:
            words = f"with this file the grammar holds more than {MOST_BYTES >> 20} MiB: it is not read"
            raise GrammarError(words, file) from None
        raise GrammarError(f"cannot be read: {error.strerror}", file) from None


def _hash(rules: Iterable[tuple[Path, bytes]]) -> str:
    """SHA-256 of the grammar's files and of the shared core's: the rules that made a house."""
    digest = hashlib.sha256()
    core = sorted(RULES.rglob("*.[lp][lp]"), key=lambda file: file.name)
    for file, content in (*rules, *((each, each.read_bytes()) for each in core)):
        digest.update(f"{file.name} {len(content)}\n".encode() + content)
    return digest.hexdigest()
