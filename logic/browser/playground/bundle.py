"""Data that the page takes from Python, as ``rules.json``: rules, messages and constants."""

from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from itertools import product
from pathlib import Path

from msgspec import structs

from vitruvius.logic.drawing.canvas import text_width
from vitruvius.logic.drawing.palettes import PALETTES
from vitruvius.logic.generation.feasibility import MAX_EXTRA_PIECES
from vitruvius.logic.generation.furnish import BITS, STEP, WALLS
from vitruvius.logic.generation.shared_walls import MOST_TRIES
from vitruvius.logic.generation.tiling import NO_PLAN
from vitruvius.logic.grammar import (
    ADJACENT,
    GUARD,
    LENGTHS,
    PLANS,
    RULES,
    SHIPPED,
    STAR,
    STATED,
    TOPOLOGIES,
    TYPICAL,
    find,
    shipped,
)
from vitruvius.logic.house.promises import PASSAGE
from vitruvius.logic.includes import EXAMPLES, LINES, SAYS
from vitruvius.logic.language.asp.audit import CHOICE, DIRECTIVES, STAGES
from vitruvius.logic.language.asp.facts import NAME, NO_NAME
from vitruvius.logic.language.asp.heads import (
    BY_CONSTRAINT,
    ELSEWHERE,
    MOVED,
    TAKEN,
    UNNAMED,
    choices,
    closed,
    why_closed,
)
from vitruvius.logic.language.asp.integers import GREATEST
from vitruvius.logic.language.asp.statements import place
from vitruvius.logic.language.asp.vocabulary import Signature, Words, core_words
from vitruvius.logic.layout.conditional import ABSENT, LONGEST_MM, left_out_facts
from vitruvius.logic.layout.messages import SYNTAX
from vitruvius.logic.layout.programs import GIVEN_ROOM_CONSTANTS
from vitruvius.logic.looks.looks import folder_looks
from vitruvius.logic.proofs.least import MOST_LAYOUTS
from vitruvius.logic.proofs.proof import MAX_ROOMS_AWAY, MAX_ROOMS_AWAY_IN_STARS
from vitruvius.logic.request.counts import MOST_ROOMS
from vitruvius.logic.request.house_request import INFERENCES

BUILDING = "building"
"""Topology of houses with units, which the page does not generate."""


def bundle() -> dict[str, object]:
    """Return the core's rule files by path, the shipped grammars' files by name, and Python's own data."""
    names = [name for name in shipped() if find(name).topology_name != BUILDING]
    return {
        "version": version("vitruvius"),
        "rules": {_path(file): _text(file) for file in _rule_files(RULES)},
        "grammars": {
            name: {file.name: _text(file) for file in _rule_files(SHIPPED / name)} for name in names
        },
        "shipped": {
            f"{name}/{file.name}": _text(file) for name in shipped() for file in _rule_files(SHIPPED / name)
        },
        "includes": {"lines": {each: line.pattern for each, line in LINES.items()}, "examples": EXAMPLES},
        "others": {name: _others(SHIPPED / name) for name in names},
        "topologies": _topologies(),
        "adjacent": _path(ADJACENT),
        "lengths": LENGTHS,
        "passage": PASSAGE,
        "given": GIVEN_ROOM_CONSTANTS,
        "walls": WALLS,
        "short": {"step": STEP, "bits": BITS},
        "name": NAME.pattern,
        "mostTries": MOST_TRIES,
        "mostRooms": MOST_ROOMS,
        "inferences": INFERENCES,
        "greatest": GREATEST,
        "far": LONGEST_MM,
        "more": MAX_EXTRA_PIECES,
        "mostLayouts": MOST_LAYOUTS,
        "near": {"star": MAX_ROOMS_AWAY_IN_STARS, "plans": MAX_ROOMS_AWAY},
        "leftOut": _named(left_out_facts()),
        "looks": {name: asdict(folder_looks(SHIPPED / name)) for name in names},
        "palette": structs.asdict(PALETTES["colour"]),
        "widths": letter_widths(),
        "programs": (*STAGES, TYPICAL),
        "says": {
            "absent": ABSENT,
            "choice": CHOICE,
            "directives": DIRECTIVES,
            "elsewhere": ELSEWHERE,
            "includes": SAYS,
            "moved": MOVED,
            "noName": NO_NAME,
            "noPlan": NO_PLAN,
            "syntax": [(each.pattern, hint) for each, hint in SYNTAX.items()],
            "taken": TAKEN,
            "unnamed": UNNAMED,
        },
    }


def letter_widths() -> dict[str, float]:
    """Return the widths of Latin letters and signs on plans, and the kerning of pairs of letters.

    The widths are multiples of the font size.
    """
    letters = [chr(code) for code in (*range(0x20, 0x7F), *range(0xA0, 0x180))]
    widths = {letter: text_width(letter, 1) for letter in letters}
    pairs = map("".join, product(map(chr, range(0x20, 0x7F)), repeat=2))
    kerned = {pair: text_width(pair, 1) - widths[pair[0]] - widths[pair[1]] for pair in pairs}
    return widths | {pair: width for pair, width in kerned.items() if width}


def _topologies() -> dict[str, object]:
    """Return the files of each topology, and the words that these files close to a grammar.

    The key is the topology's name, or ``own`` for the topologies of users.
    """
    shared = [file for file in sorted(TOPOLOGIES.glob("*.lp")) if file.stem not in (BUILDING, STAR.stem)]
    files = {STAR.stem: (STAR,), "own": (*PLANS, GUARD), **{file.stem: (*PLANS, file) for file in shared}}
    return {name: _topology(each) for name, each in files.items()}


def _topology(files: Sequence[Path]) -> dict[str, object]:
    core = core_words(tuple(files))
    known = core.used.keys() | core.derived.keys() | core.opened.keys()
    stated = [each for each, use in core.opened.items() if place(use.node)[0] == str(STATED)]
    return {
        "files": [_path(file) for file in files],
        "closed": {f"{each[0]}/{each[1]}": _why_closed(each, core) for each in sorted(closed(core))},
        "stated": _named(stated),
        "known": _named(known),
        "inputs": _named(known - closed(core)),
        "documented": _named(core.documented),
        "choices": _named(set(choices(core))),
        "constants": sorted(core.constants),
        "defined": sorted(core.defined),
    }


def _why_closed(signature: Signature, core: Words) -> str:
    why, stages = why_closed(signature, core)
    return f"{why}: {BY_CONSTRAINT}" if stages else why


def _named(signatures: Sequence[Signature] | set[Signature]) -> list[str]:
    return sorted(f"{name}/{arity}" for name, arity in signatures)


def _path(file: Path) -> str:
    return file.relative_to(RULES).as_posix()


def _rule_files(folder: Path) -> list[Path]:
    files = (file for file in folder.rglob("*") if file.suffix in {".lp", ".pl"})
    return sorted(files, key=lambda file: file.name)  # the order in which a grammar's hash takes them


def _others(folder: Path) -> dict[str, str]:
    """Return the other files of a grammar by name: the looks of its types."""
    return {file.name: _text(file) for file in sorted(folder.glob("*.json"))}


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")
