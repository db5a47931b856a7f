"""Command ``vitruvius info``: it describes a file, a folder or a name."""

from dataclasses import dataclass
from typing import Annotated, Any

import msgspec
import tyro

from vitruvius.commands.common import print_answer, say_warnings
from vitruvius.help import columns, entry
from vitruvius.info.descriptions import Kind
from vitruvius.info.recognise import recognised
from vitruvius.logic.spelling import printable

TITLES = {
    "houses": "houses",
    "set": "set of houses, for vitruvius train and check",
    "plan": "plan, for vitruvius generate --plan",
    "agent": "agent, for vitruvius evaluate",
    "run": "training run, for vitruvius train --resume",
    "games": "games that people played, for vitruvius play --replay",
    "scores": "scores, for vitruvius evaluate --scores",
    "trace": "trace of an episode",
    "grammar": "grammar, for vitruvius generate --grammar",
    "settings": "settings, for vitruvius train --preset or --config",
}
"""Title of each kind."""

HIDDEN = {"kind", "name", "config"}
"""Fields that only programs read."""

ALIKE = {"formats", "topologies", "grammars"}
"""Counts of houses that are left out if all houses are alike."""

LARGE = {"houses", "shards", "there", "bytes", "parameters", "steps", "of_steps", "games", "length"}
"""Numbers that are grouped by thousands."""


class About(msgspec.Struct, frozen=True):
    """Answer of ``info``: all that the name stands for; a path is one thing, a name may be several."""

    found: list[Kind]


@dataclass(frozen=True)
class Info:
    """Describe a file, a folder, or a name that comes with Vitruvius: houses, a grammar, an agent, a run.

    The command reads house files of every format, sets of houses, plans for generate, checkpoints, folders of
    train, games, scores, traces, folders of rules and TOML settings. It executes no code from them.
    The description has counts, seeds, hashes, versions and the command that wrote the file.
    """

    thing: tyro.conf.Positional[Annotated[str, tyro.conf.arg(metavar="FILE")]]
    """A path, the name of a bank, a grammar, an agent or a preset, or - for the standard input."""

    json: bool = False
    """Print one answer as JSON, for programs."""

    def run(self) -> int:
        """Print the description."""
        say_warnings()
        found: list[Any] = recognised(self.thing)
        if self.json:
            print_answer("info", About(found))
            return 0
        print("\n\n".join(_text(msgspec.to_builtins(each)) for each in found))
        return 0


def _text(record: dict[str, Any]) -> str:
    """Return the description of a thing, with a row for each of its fields."""
    rows = [(key.replace("_", " "), _words(key, value)) for key, value in record.items() if key not in HIDDEN]
    rows = [(key, printable(words)) for key, words in rows if words]
    longest = max(len(key) for key, _ in rows)
    title = f"{printable(record['name'])}: {TITLES[record['kind']]}"
    return "\n".join([title, *(line for row in rows for line in entry(*row, longest, columns()))])


def _words(key: str, value: Any) -> str:
    """Return a value in words; empty if there is nothing to say."""
    match value:
        case bool():
            words = "yes" if value else "no"
        case (least, most) if key == "rooms":
            words = f"{least} to {most}" if least < most else str(least)
        case int() if key in LARGE:
            words = f"{value:,}"
        case float():
            words = f"{value:,.2f}"
        case dict() if len(value) == 1 and key in ALIKE:
            words = next(iter(value))
        case dict():
            words = ", ".join(f"{name} {_inner(each)}" for name, each in value.items())
        case tuple() | list():
            words = ", ".join(map(_inner, value))
        case _:
            words = "" if value is None else str(value)
    return words


def _inner(value: Any) -> str:
    """Return a value within another, in words."""
    if isinstance(value, dict):
        return f"({_words('', value)})"
    return f"{value:g}" if isinstance(value, float) else str(value)
