"""``docs/studies.md``: each study and its options: ``python -m benchmarks.page``."""

from argparse import ArgumentParser

from benchmarks import GROUPS, STUDIES
from vitruvius.help import grouped
from vitruvius.page import sections

HEAD = """\
# The studies

`./run bench NAME` in a checkout runs a study. A study writes its figures as JSON into the folder of `--out`,
and most write a page and a report there, too. An installed package has no studies. `./run bench --help` lists
them, and `./run bench NAME --help` the options of one.
"""


def page() -> str:
    """Return the page, in Markdown."""
    parts = [HEAD]
    for title, names in grouped(STUDIES, GROUPS).items():
        parts.append(f"- {title}: {', '.join(f'[{name}](#bench-{name})' for name in names)}")
    return "\n".join([*parts, *sections(STUDIES, GROUPS, "bench ")]) + "\n"


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    print(page(), end="")
