"""Reference of the rule language: a page made from the core's comments and from recipes.

A documentation comment is ``%*! name(Argument,..): what it says *%`` in an ``.lp`` file, PlDoc in a ``.pl``
file. Its indented lines are an example. A predicate without documentation is internal to the core.
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from clingo.ast import ASTType, parse_files

from vitruvius.logic.grammar import ADJACENT, PLANS, RULES, STAR, STATED, TOPOLOGIES
from vitruvius.logic.layout.program import CORE

PAGE = Path(__file__).with_name("reference.md")
"""The page's text, with places for generated parts."""

FAMILY = "family"
RECIPES = Path(__file__).with_name("recipes")
"""Folder of recipes: ``.lp`` files, with ``.pl`` files of the same name if they need lengths.

A recipe is for `family`, or for the shipped grammar that its folder names.
"""


@dataclass(frozen=True)
class Entry:
    """Predicate or constant that a grammar may state or use."""

    name: str
    arguments: tuple[str, ...]
    text: str
    example: str

    def __str__(self) -> str:
        """Return a row of a table."""
        word = f"{self.name}({', '.join(self.arguments)})" if self.arguments else self.name
        example = "<br>".join(f"`{line}`" for line in self.example.splitlines())
        return f"| `{word}` | {self.text} | {example} |"


@dataclass(frozen=True)
class Recipe:
    """Recipe: one or two files that a user copies into a grammar. The first line is the title."""

    name: str
    files: tuple[Path, ...]
    grammar: str
    """Shipped grammar for a copy of which the recipe is."""

    def __str__(self) -> str:
        """Return the names of its files, and their content, which begins with the title."""
        first, *others = (
            file.read_text(encoding="utf-8").removeprefix("%# ").rstrip() for file in self.files
        )
        names = ", ".join(str(file.relative_to(RECIPES)) for file in self.files)
        return "\n".join([f"% {names}: {first}", *(f"% {self.name}.pl\n{each}" for each in others)])


def recipes() -> list[Recipe]:
    """Return all recipes, by subject and by name."""
    found = [
        Recipe(
            file.stem,
            (file, *file.parent.glob(f"{file.stem}.pl")),
            folder.name if folder != RECIPES else FAMILY,
        )
        for folder in (RECIPES, *RECIPES.iterdir())
        for file in folder.glob("*.lp")
    ]
    return sorted(found, key=lambda recipe: (_about(recipe), recipe.name))


def _about(recipe: Recipe) -> str:
    if recipe.grammar != FAMILY:
        return "Walls that rooms share"
    if len(recipe.files) > 1:
        return "Types, pieces and lengths"
    return "Furniture of a room" if "#program room." in str(recipe) else "A house's rooms"


def asp_entries(*topologies: str) -> dict[str, list[Entry]]:
    """Return the documentation in the core's ``.lp`` files, by ``#program``.

    ``base`` holds only predicates that a grammar states, ``topology`` those that a topology states. The
    result is about these topologies, or about all.
    """
    entries: dict[str, list[Entry]] = {
        "base": [],
        "topology": [],
        "units": [],
        "house": [],
        "room": [],
        "pick": [],
    }
    stated: set[tuple[str, int]] = set()
    part = "base"

    def take(statement: Any) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            stated_there = statement.location.begin.filename == str(STATED)
            part = "topology" if stated_there else statement.name
        elif statement.ast_type == ASTType.Defined:
            stated.add((statement.name, statement.arity))
        elif statement.ast_type == ASTType.Comment and part in entries:
            found = re.fullmatch(r"%\*! (\w+)(?:\((.*?)\))?: (.*?)((?:\n    .*)*) \*%", statement.value, re.S)
            # A topology may include another.
            if found and (entry := _entry(*found.groups(""))) not in entries[part]:
                entries[part].append(entry)

    named = [file for file in sorted(TOPOLOGIES.glob("*.lp")) if file.stem in topologies or not topologies]
    for file in (CORE, *((*PLANS, ADJACENT) if named != [STAR] else ()), *named):
        parse_files([str(file)], take)
    entries["base"] = [each for each in entries["base"] if (each.name, len(each.arguments)) in stated]
    return entries


def prolog_entries() -> list[Entry]:
    """Return the predicates of ``.pl`` files that ``rules/language/grammar_files.pl`` declares."""
    source = (RULES / "language" / "grammar_files.pl").read_text(encoding="utf-8")
    declared = set(re.findall(r"grammar:(\w+)/", source))
    found = re.findall(r"^%!  (\w+)\((.*)\).*\n((?:%.*\n)*?)((?:%       .*\n)*)\n", source, re.M)
    return [
        _entry(name, re.sub("[?+-]", "", arguments), *(re.sub("^%", "", text, flags=re.M) for text in texts))
        for name, arguments, *texts in found
        if name in declared
    ]


def _entry(name: str, arguments: str, text: str, example: str) -> Entry:
    lines = [line.strip() for line in example.strip().splitlines()]
    return Entry(name, tuple(re.findall(r"\w+", arguments)), " ".join(text.split()), "\n".join(lines))


def goals() -> list[str]:
    """Return the goals that a clause in a grammar's ``.pl`` files may call: ``rules/language/lint.pl``."""
    return re.findall(
        r"\bpure\(\(?(\S+?)\)?/\d\)\.", (RULES / "language" / "lint.pl").read_text(encoding="utf-8")
    )


def page() -> str:
    """Return the whole page, in Markdown."""
    parts = {name: _table(entries) for name, entries in asp_entries().items()}
    parts["lengths"] = _table(prolog_entries())
    parts["goals"] = ", ".join(f"`{goal}`" for goal in goals())
    groups = groupby(recipes(), _about)
    parts["recipes"] = "\n\n".join(
        "\n".join([f"### {about}", "```prolog", "\n\n".join(map(str, group)), "```"])
        for about, group in groups
    )
    limits = json.loads((RULES / "language" / "inexpressible.json").read_text(encoding="utf-8"))
    parts["inexpressible"] = "\n".join(f"| {each['topic']} | {each['says']} |" for each in limits)
    return re.sub("<!-- (\\w+) -->", lambda place: parts[place[1]], PAGE.read_text(encoding="utf-8"))


def _table(entries: Iterable[Entry]) -> str:
    return "\n".join(["| | meaning | example |", "|---|---|---|", *map(str, entries)])


@dataclass(frozen=True)
class Rules:
    """Print the reference of the rule language: predicates, recipes, and its limits."""

    def run(self) -> None:
        """Print the reference as Markdown."""
        print(page(), end="")
