"""``docs/studies.md``: the help of each study: ``python -m benchmarks.page``."""

from argparse import ArgumentParser

from benchmarks import GROUPS, STUDIES
from vitruvius.cli import command_help, studies
from vitruvius.help import grouped
from vitruvius.page import WIDTH, quoted

HEAD = """\
# The studies

`./run bench NAME` in a checkout runs a study. A study writes its figures as JSON into the folder of `--out`,
and most write a page and a report there, too. An installed package has no studies. This page has their help;
`./run python -m benchmarks.page` prints it.
"""


def page() -> str:
    """Return the page, in Markdown."""
    parts = [HEAD, *quoted(studies(WIDTH))]
    for title, names in grouped(STUDIES, GROUPS).items():
        parts += [f"## {title}", ""]
        for name in names:
            parts += [f"### bench {name}", *quoted(command_help(["bench", name], width=WIDTH))]
    return "\n".join(parts).rstrip() + "\n"


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    print(page(), end="")
