"""Command ``vitruvius regenerate``: it generates rows of a set again."""

import json
from dataclasses import dataclass
from typing import ClassVar

import tyro

from vitruvius.commands.common import print_line, say_warnings
from vitruvius.logic.spelling import numbered
from vitruvius.logic.terminal import say
from vitruvius.options import Streamed


@dataclass(frozen=True)
class Regenerate:
    """Generate rows of a set again, from their provenance and the rules in the set."""

    groups: ClassVar = {"row": "Rows and rules"}

    file: tyro.conf.Positional[Streamed]
    """Folder of a set, a file of rows (Parquet or JSON Lines), or - for rows as JSON Lines."""

    row: tuple[int, ...] = ()
    """Indices of the rows, from 0, as in --row 3 57; by default all."""

    grammar: str | None = None
    """Rules for rows that come without their set: a folder, or the name of a shipped grammar; by default the
    shipped grammar that the rows name."""

    def run(self) -> int:
        """Print the houses; return 1 if one differs from its row's."""
        from vitruvius.logic.dataset.regenerate import regenerated
        from vitruvius.logic.house.house import House

        say_warnings()
        as_before = others = 0
        for again in regenerated(self.file, self.row, self.grammar):
            if isinstance(again.made, House):
                print_line(json.dumps(again.made.to_dict()))
            if again.differs:
                others += 1
                say(again.differs)
            else:
                as_before += 1
        say(f"{numbered(as_before + others, 'row')} regenerated: {as_before} identical, {others} different")
        return 1 if others else 0
