"""Page ``docs/command-line.md``: usage and help of each command. ``python -m vitruvius.page`` prints it."""

import pkgutil
from collections.abc import Iterator
from pathlib import Path

import msgspec

from vitruvius.answers.agents import ANSWERS
from vitruvius.cli import COMMANDS, GROUPS, command_help, top
from vitruvius.help import grouped

WIDTH = 90
"""Columns of the help that the page quotes."""


def page() -> str:
    """Return the page, in Markdown."""
    head = Path(__file__).with_name("command_line.md").read_text("utf-8")
    parts = [head.replace("TABLE\n", "\n".join(_table()) + "\n").rstrip(), "", *quoted(top(WIDTH))]
    for title, names in grouped(COMMANDS, GROUPS).items():
        parts += [f"## {title}", ""]
        for name in names:
            if name == "bench":
                parts += ["### bench", "`./run bench NAME` runs a study: see [The studies](studies.md).", ""]
            else:
                parts += [f"### {name}", *quoted(command_help([name], width=WIDTH))]
    return "\n".join(parts).rstrip() + "\n"


def quoted(text: str) -> list[str]:
    """Return the lines of a text as a block of code."""
    return ["```", text, "```", ""]


def _table() -> Iterator[str]:
    """Yield a table of the keys of each command's answer."""
    yield "| command | keys of its answer |"
    yield "|---|---|"
    for name, place in ANSWERS.items():
        fields = msgspec.structs.fields(pkgutil.resolve_name(place))
        yield f"| `{name}` | {', '.join(f'`{field.encode_name}`' for field in fields)} |"


if __name__ == "__main__":
    print(page(), end="")
