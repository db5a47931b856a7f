"""Layout of help: commands in groups, and the options of each command in groups, at any width."""

import os
import shutil
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import MISSING
from itertools import groupby
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vitruvius.options import Option

Table = Mapping[str, tuple[str, str]]
"""Commands by name: the class of each, and its description."""

LEAST, MOST = 60, 100
"""Smallest and largest width of a page, in columns."""

INDENT, GAP = 2, 2
"""Columns before a name, and between the longest name and its sentence."""

LONGEST = 22
"""Largest width of a name whose sentence starts on the same line, in columns; otherwise it starts below."""


def grouped(table: Table, groups: Mapping[str, str]) -> dict[str, list[str]]:
    """Return the names of commands by group; ``groups`` has each title by the group's first command."""
    title, found = "Commands", dict[str, list[str]]()
    for name in table:
        title = groups.get(name, title)
        found.setdefault(title, []).append(name)
    return found


def of_table(
    prog: str, about: str, table: Table, groups: Mapping[str, str], end: str = "", width: int | None = None
) -> str:
    """Return help that lists commands."""
    width = width or columns()
    parts = [f"usage: {prog} COMMAND [OPTIONS]", "", *_wrapped(about, width, 0), ""]
    longest = max(map(len, table))
    for title, names in grouped(table, groups).items():
        parts.append(_heading(title))
        for name in names:
            parts += entry(name, table[name][1], longest, width)
        parts.append("")
    parts += _wrapped(f"{prog} COMMAND --help: the purpose and options of a command.", width, 0)
    return "\n".join([*parts, *(["", end] if end else [])])


def of_command(prog: str, about: str, options: Iterable["Option"], width: int | None = None) -> str:
    """Return the help of one command: description, arguments, options."""
    options, width = list(options), width or columns()
    positional = [option for option in options if option.positional]
    named = [option for option in options if not option.positional]
    parts = [f"usage: {usage(prog, options)}", ""]
    for paragraph in about.replace("``", "").strip().split("\n\n"):
        parts += [*_wrapped(paragraph, width, 0), ""]
    groups = {"Arguments": positional} if positional else {}
    for title, members in groupby(named, lambda option: option.group):
        groups[title] = [*groups.get(title, []), *members]
    entries = {title: [(option_name(each), sentence(each)) for each in groups[title]] for title in groups}
    longest = max(
        (len(name) for each in entries.values() for name, _ in each if len(name) <= LONGEST), default=0
    )
    for title, members in entries.items():
        parts.append(_heading(title))
        for name, text in members:
            parts += entry(name, text, longest, width)
        parts.append("")
    return "\n".join(parts).rstrip()


def usage(prog: str, options: Iterable["Option"]) -> str:
    """Return the line of usage of a command, as in ``convert FILE --out PATH [OPTIONS]``."""
    positional = [_argument(option) for option in options if option.positional]
    required = [option_name(each) for each in options if not each.positional and each.default is MISSING]
    return " ".join([prog, *positional, *required, "[OPTIONS]"])


def sentence(option: "Option") -> str:
    """Return an option's description, with its default."""
    hints = ["repeatable"] if option.repeated else []
    default = option.default
    if default is MISSING:
        hints.append("required")
    elif isinstance(default, bool):
        hints += ["default: yes"] if default else []
    elif isinstance(default, tuple):
        hints += [f"default: {' '.join(map(str, default))}"] if default else []
    elif default not in (None, ""):
        hints.append(f"default: {default:g}" if isinstance(default, float) else f"default: {default}")
    return " ".join([option.help, *([f"({'; '.join(hints)})"] if hints else [])])


def columns() -> int:
    """Return the width of a page: the terminal's, within limits."""
    return min(max(shutil.get_terminal_size().columns, LEAST), MOST)


def _argument(option: "Option") -> str:
    """Return an argument as in the line of usage."""
    name = f"{option.metavar} ..." if option.several else option.metavar
    return name if option.default is MISSING or name.startswith("[") else f"[{name}]"


def option_name(option: "Option") -> str:
    """Return an option as in ``--seed N``, ``--resume`` or ``--[no-]map``."""
    if option.positional:
        return option.metavar.strip("[]")
    if option.type is bool:
        return f"--[no-]{option.flag[2:]}" if option.default else option.flag
    return f"{option.flag} {option.metavar}{' ...' if option.several else ''}"


def entry(name: str, text: str, longest: int, width: int) -> Iterator[str]:
    """Yield the lines of a name and, next to it or below, its sentence."""
    indent = INDENT + longest + GAP
    lines = _wrapped(text, width, indent)
    if len(name) <= longest:
        yield f"{' ' * INDENT}{name:<{longest + GAP}}{lines[0].strip()}"
        yield from lines[1:]
    else:
        yield f"{' ' * INDENT}{name}"
        yield from lines


def _wrapped(text: str, width: int, indent: int) -> list[str]:
    """Return the text in lines with an indent; at least one line."""
    margin = " " * indent
    text = " ".join(text.split())
    return textwrap.wrap(
        text, width, initial_indent=margin, subsequent_indent=margin, break_on_hyphens=False
    ) or [margin]


def _heading(title: str) -> str:
    """Return a title, bold on a terminal that shows bold: see https://no-color.org."""
    plain = not sys.stdout.isatty() or "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb"
    return title if plain else f"\x1b[1m{title}\x1b[0m"
