"""A grammar is a directory of rule files: ``.lp`` for clingo, ``.pl`` for SWI-Prolog, all at its top.

A file may include one of a shipped grammar: see ``includes.py``. It may name a topology, the rules for how
rooms touch or connect: a file of ``rules/topologies``, or its own file of that name.
"""

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from errno import EFBIG
from pathlib import Path

from vitruvius.logic.copies import Stated, original, stated_by, statements
from vitruvius.logic.errors import GrammarError, Reason
from vitruvius.logic.includes import Reading, name_in
from vitruvius.logic.opener import content_of
from vitruvius.logic.spelling import printable, unknown

SHIPPED = Path(__file__).resolve().parent / "grammars"
RULES = Path(__file__).resolve().parent / "rules"

TOPOLOGIES, SHARED_WALLS = RULES / "topologies", RULES / "shared_walls"
STAR = TOPOLOGIES / "star.lp"
"""Topology of a grammar that names none."""

ADJACENT = SHARED_WALLS / "adjacent.lp"
"""Rules for which rooms share a wall.

They are read only if a rule names ``adjacent``, since they add choices.
"""

GUARD = SHARED_WALLS / "topology.lp"
"""Constraints that hold for every topology of a user."""

PLANS = tuple(SHARED_WALLS / name for name in ("access.lp", "differences.lp", "stated.lp"))
"""Rules of all topologies but the star: rooms share walls, and the walls have doors."""

STATED = SHARED_WALLS / "stated.lp"
"""Predicates that a topology states and no other file of a grammar."""

ACCESS, OWN = SHARED_WALLS / "access.lp", SHARED_WALLS / "own.lp"
"""Files that replace the topology for a plan of the user."""

DISSECTION, BRIEF = TOPOLOGIES / "dissection.lp", RULES / "brief" / "brief.lp"
"""Files that replace the grammar's topology for a house by a brief."""

Places = frozenset[tuple[str, int, int]]
"""Places of rules: file, line and column of each rule's first character."""

TYPICAL = "typical"
"""Name of the ``#program`` whose rules give way to the user's statements about rooms."""

COMMENT = re.compile(r"%\*.*?(?:\*%|\Z)|%[^\n]*", re.DOTALL)
"""Comment of clingo's language."""

TYPES = re.compile(r"\btype\s{0,9}\(([\w\s;()]{0,999})\)\s{0,9}\.")
"""Pattern of a fact that names room types."""

LENGTHS = ("door_width", "door_clearance", "passage", "room_gap")
"""Lengths that the ``.pl`` files of every grammar state, each as a fact with that name."""

IN_PROLOG = {
    **dict.fromkeys((*LENGTHS, "door_margin", "window_margin", "unit_depth"), 1),
    **dict.fromkeys(("house_size", "house_area", "turning", "wall_thickness"), 2),
    **dict.fromkeys(("room_size", "room_area", "whole_area", "window_size"), 3),
    **dict.fromkeys(("piece_size", "opening_size"), 4),
}
"""Predicates that ``.pl`` files may state, with the number of arguments of each."""

MOST_BYTES = 1 << 24
"""Largest size of all rule files of a grammar together, in bytes. The known grammars have less than 20 kB."""


@dataclass(frozen=True)
class Grammar:
    """Grammar: its name, its rule files and the hash of their content."""

    name: str
    directory: Path
    own: tuple[Path, ...]
    """The ``.lp`` files: first those of shipped grammars that it includes, then those of its directory.

    Each file follows the files that it includes. Therefore a conflict between two files is reported at a line
    of the user.
    """
    topology: tuple[Path, ...]
    """Shared ``.lp`` files that come with its topology."""
    topology_name: str
    prolog: tuple[Path, ...]
    """The ``.pl`` files, in the same order."""
    hash: str
    gave_way: tuple[Reason, ...] = ()
    """Typical rules that are left out because they contradict the user's statements about rooms."""

    @property
    def is_shipped(self) -> bool:
        """True for a grammar that comes with Vitruvius; tests hold that lint has no finding about it."""
        return self.directory.parent == SHIPPED

    @property
    def asp(self) -> tuple[Path, ...]:
        """All ``.lp`` files that clingo reads in addition to the core."""
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

    def borrows(self, file: Path) -> bool:
        """Return True for an included file of a shipped grammar: it may name types that are absent here."""
        return SHIPPED in file.parents and self.directory.resolve() not in file.parents

    def cited(self, rule: Reason) -> str:
        """Return a rule with its place as a house file cites it, without the folders of this machine."""
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
        """True if a rule uses ``adjacent``, so that the solver must know which rooms share a wall."""
        return ADJACENT in self.topology

    def for_own_plan(self) -> "Grammar":
        """Return the grammar without its topology, for a user's plan: see ``logic.request.given_plan``."""
        own = tuple(file for file in self.own if file.stem != self.topology_name)
        return replace(self, own=own, topology=(ACCESS, STATED, OWN), topology_name=OWN.stem)


def shipped() -> list[str]:
    """Return the names of the grammars that come with Vitruvius."""
    return sorted(path.name for path in SHIPPED.iterdir() if path.is_dir())


def find_shipped(name: str) -> Grammar:
    """Return the shipped grammar that a house file names.

    Raises ``GrammarError`` for another name, since a file may not name a path.
    """
    if name not in shipped():
        raise GrammarError(unknown("grammar", name, shipped()))
    return find(name)


def find(grammar: str | Path) -> Grammar:
    """Return a shipped grammar by its name, or a user's grammar by its directory.

    Raises ``GrammarError`` if there is no such grammar, if it lacks ``.lp`` or ``.pl`` files, or if its files
    hold more than ``MOST_BYTES``. Raises it, too, for a file that lies elsewhere, cannot be read, is a device
    or a pipe, copies another file, or includes a file that it may not.
    """
    directory = folder(grammar)
    # Editors leave hidden files beside the edited files.
    files = [file for file in sorted(directory.iterdir()) if not (file.name.startswith(".") or file.is_dir())]
    asp, prolog = (tuple(file for file in files if file.suffix == suffix) for suffix in (".lp", ".pl"))
    for file in asp + prolog:
        if not _is_utf8(file):
            raise GrammarError(
                "its name is not UTF-8, which the solvers need: rename it", printable(str(file))
            )
        # An error message may quote a rule file to people who may not read the target of a link.
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
        if copy in stated:  # What a copy includes is absent beside it, or included already.
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
    """Raise ``GrammarError`` for the first file that copies an earlier file.

    With ``only``, check that file alone.
    """
    before: dict[Path, frozenset[str]] = {}
    for file, mine in stated.items():
        if (only in (None, file)) and (first := original(file, mine, before)):
            name = name_in(first, directory, SHIPPED.resolve())
            what = f"repeats what {name} states, and all rule files of the folder are read"
            if first.parent != directory:
                what = f"repeats what {name} states, which is included"
            raise GrammarError(f"{what}: keep one of the two", file)
        before[file] = mine


def _require_nothing_of_the_core(stated: Stated, topology: str | None) -> None:
    """Raise ``GrammarError`` for a copy of a shared file.

    One copy is allowed: the user's own topology. The fact ``topology`` must name that file, if the fact is
    known.
    """
    for file, mine in stated.items():
        if not (copied := original(file, mine, stated_by(RULES))):
            continue
        # A star has no walls, and a file with includes is no single topology.
        usable = (
            copied.parent == TOPOLOGIES and copied != STAR and "#include" not in copied.read_text("utf-8")
        )
        if not usable:
            why = f"is a copy of {copied}, which is loaded automatically: delete the copy"
            raise GrammarError(why, file)
        if topology and file.stem != topology:
            own = "make it a topology of your own: topology(mine) names a file mine.lp"
            why = f"is a copy of {copied}, and the topology here is {topology}: delete the copy, or {own}"
            raise GrammarError(why, file)


def reading_of(directory: Path) -> Reading:
    """Return a reader for a grammar's files and their includes. It refuses files beyond the size limit."""
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
    """Return the directory of a grammar, whatever it contains. Raises ``GrammarError`` if there is none."""
    directory = SHIPPED / grammar if str(grammar) in shipped() else Path(grammar)
    if str(grammar) == "-":
        raise GrammarError("-: a grammar is a folder of rule files, which standard input cannot hold")
    if directory.is_file():
        meant = f": did you mean {directory.parent}?" if directory.suffix in (".lp", ".pl") else ""
        raise GrammarError(f"is a file, but a grammar is a folder of rule files{meant}", directory)
    if not directory.is_dir():
        raise GrammarError(
            f"{grammar}: there is no such directory, and {unknown('grammar', grammar, shipped())}"
        )
    return directory.resolve()


def _topology(texts: Mapping[Path, str]) -> tuple[tuple[Path, ...], str]:
    """Return the shared files of the topology that a fact in these files names, and its name.

    The files are read as text: their topology must be known before any rule is parsed, and only a confined
    process parses the rules of users. That process checks that the rules name the same topology
    (``loaded.py``).
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
    """Return the content of a rule file. Raises ``GrammarError`` for more than ``most`` bytes."""
    try:
        return content_of(file, most, unpack=False)
    except OSError as error:
        if error.errno == EFBIG:
            words = f"with this file the grammar holds more than {MOST_BYTES >> 20} MiB: it is not read"
            raise GrammarError(words, file) from None
        raise GrammarError(f"cannot be read: {error.strerror}", file) from None


def _hash(rules: Iterable[tuple[Path, bytes]]) -> str:
    """Return the SHA-256 of the grammar's files and of the shared core: the rules that generate houses."""
    digest = hashlib.sha256()
    core = sorted(RULES.rglob("*.[lp][lp]"), key=lambda file: file.name)
    for file, content in (*rules, *((each, each.read_bytes()) for each in core)):
        digest.update(f"{file.name} {len(content)}\n".encode() + content)
    return digest.hexdigest()
