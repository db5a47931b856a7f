"""Page ``docs/command-line.md``: each command and its options. ``python -m vitruvius.page`` prints it."""

import pkgutil
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path

import msgspec

from vitruvius.answers.agents import ANSWERS
from vitruvius.cli import COMMANDS, GROUPS
from vitruvius.help import Table, grouped, option_name, sentence, usage
from vitruvius.options import Option, options_of

DOCS = Path(__file__).parents[1] / "docs"
WIDTH = 120
"""Columns of the page's paragraphs."""

MIN_SHARING = 3
"""Smallest number of commands that share an option which the page describes only once."""


def page() -> str:
    """Return the page, in Markdown."""
    head = Path(__file__).with_name("command_line.md").read_text("utf-8").rstrip()
    table = {name: entry for name, entry in COMMANDS.items() if name != "bench"}
    return (
        "\n".join([head.replace("TABLE\n", "\n".join(_overview()) + "\n"), *sections(table, GROUPS)]) + "\n"
    )


def sections(table: Table, groups: Mapping[str, str], prefix: str = "") -> Iterator[str]:
    """Yield a section for each group of commands, and a table of the options that many of them share."""
    kinds = {name: pkgutil.resolve_name(place) for name, (place, _) in table.items()}
    options = {name: options_of(kind.like([]) if name == "train" else kind) for name, kind in kinds.items()}
    counts = Counter(_description(option) for each in options.values() for option in each)
    shared = {text for text, count in counts.items() if text[1] and count >= MIN_SHARING}
    yield from ["", "## Shared options", *_rows("option", sorted(shared))]
    for title, names in grouped(table, groups).items():
        yield from ["", f"## {title}"]
        for name in names:
            yield from ["", f"### {prefix}{name}"]
            yield from _section(f"vitruvius {prefix}{name}", kinds[name].__doc__, options[name], shared)


def _section(prog: str, about: str, options: Sequence[Option], shared: set[tuple[str, str]]) -> Iterator[str]:
    """Yield the description of a command, and a table of its options."""
    own = [option for option in options if _description(option) not in shared]
    also = [_mention(option) for option in options if _description(option) in shared]
    line = usage(prog, options)
    given = f"`{line}`: " if line != usage(prog, []) else ""
    for part in (given + about).strip().split("\n\n"):
        yield from [*textwrap.wrap(_linked(part), WIDTH, break_on_hyphens=False), ""]
    rows = [*_grouped_rows(own), *([("[shared](#shared-options)", ", ".join(also))] if also else [])]
    if rows:
        yield from _rows("option", rows)


def _grouped_rows(options: Iterable[Option]) -> Iterator[tuple[str, str]]:
    """Yield the rows of options, below the titles of their groups."""
    for title, members in groupby(options, lambda each: "" if each.positional else each.group):
        if title not in ("", "Options"):
            yield f"**{title}**", ""
        for option in members:
            yield f"`{option_name(option)}`", option.help + _hints(option)


def _description(option: Option) -> tuple[str, str]:
    """Return an option's name and description, which the options of several commands may share."""
    return f"`{option_name(option)}`", "" if option.positional else option.help


def _mention(option: Option) -> str:
    """Return the name of a shared option, with its default in this command."""
    return f"`{option.flag}`{_hints(option)}"


def _hints(option: Option) -> str:
    """Return what the help adds to an option's description, with the default as code."""
    return re.sub(r"(?<=default: )(.+)(?=\)$)", r"`\1`", sentence(option).removeprefix(option.help))


def _rows(head: str, rows: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield a table of two columns."""
    yield from [f"| {head} | meaning |", "|---|---|"]
    for name, text in rows:
        cells = (cell.replace("|", r"\|") for cell in (name, _linked(text)))
        yield f"| {' | '.join(cells)} |"


def _linked(text: str) -> str:
    """Return a text on one line, with options as code, and with pages of docs as links."""
    text = re.sub(r"`[^`]+`|(?<!\w)--\w[\w-]*", _as_code, " ".join(text.replace("``", "`").split()))
    return re.sub(r"\bdocs/([\w-]+\.md)", lambda found: f"[{_title(found[1])}]({found[1]})", text)


def _as_code(found: re.Match[str]) -> str:
    """Return an option as code; code stays as it is."""
    return found[0] if found[0].startswith("`") else f"`{found[0]}`"


@cache
def _title(name: str) -> str:
    """Return the title of a page of docs."""
    return (DOCS / name).read_text("utf-8").partition("\n")[0].lstrip("# ")


def _overview() -> Iterator[str]:
    """Yield a table of the commands: purpose, and keys of the answer with ``--json``."""
    yield from ["| command | purpose | keys of its answer |", "|---|---|---|"]
    for name, (_, about) in COMMANDS.items():
        fields = msgspec.structs.fields(pkgutil.resolve_name(ANSWERS[name])) if name in ANSWERS else ()
        keys = ", ".join(f"`{field.encode_name}`" for field in fields)
        yield f"| [`{name}`]({'studies.md' if name == 'bench' else f'#{name}'}) | {about} | {keys} |"


if __name__ == "__main__":
    print(page(), end="")
