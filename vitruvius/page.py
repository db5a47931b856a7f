"""Page ``docs/command-line.md``: usage and help of each command. ``python -m vitruvius.page`` prints it."""

import pkgutil
from collections.abc import Iterator
from pathlib import Path

import msgspec

from benchmarks import STUDIES
from vitruvius.answers.agents import ANSWERS
from vitruvius.cli import COMMANDS, GROUPS, command_help, studies, top
from vitruvius.help import grouped

WIDTH = 90
"""Columns of the help that the page quotes."""


def page() -> str:
    """Return the page, in Markdown."""
    head = Path(__file__).with_name("command_line.md").read_text("utf-8")
    parts = [head.replace("TABLE\n", "\n".join(_table()) + "\n").rstrip(), "", *_quoted(top(WIDTH))]
    for title, names in grouped(COMMANDS, GROUPS).items():
        parts += [f"## {title}", ""]
        for name in names:
            parts += [
                f"### {name}",
                *_quoted(studies(WIDTH) if name == "bench" else command_help([name], width=WIDTH)),
            ]
    parts += ["## Studies: `vitruvius bench`", ""]
    for name in STUDIES:
        parts += [f"### bench {name}", *_quoted(command_help(["bench", name], width=WIDTH))]
    return "\n".join(parts).rstrip() + "\n"


def _quoted(text: str) -> list[str]:
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
