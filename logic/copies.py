"""Rule files that state what another file states already: copies, whole or with changes."""

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

QUOTED_OR_COMMENT = {
    ".lp": re.compile(r'("(?:\\.|[^"\\\n])*+"?)|%\*.*?(?:\*%|\Z)|%[^\n]*', re.DOTALL),
    ".pl": re.compile(
        r"""(0'(?:\\.|''|.)|"(?:\\.|""|[^"\\])*+"?|'(?:\\.|''|[^'\\])*+'?)|%[^\n]*|/\*.*?(?:\*/|\Z)""",
        re.DOTALL,
    ),
}
"""What is quoted, as a group, and the comments, in the files of each language."""

END = re.compile(r"\.(?=\s|\Z)")
"""Where a statement ends: not in ``1..3``, nor in ``0.8``."""


Stated = Mapping[Path, frozenset[str]]
"""The statements of rule files."""


def statements(text: str, suffix: str) -> frozenset[str]:
    """The statements of a rule file with this suffix, without comments and white space.

    They are read as text, since rules of others are parsed in a confined process alone.
    """
    code = QUOTED_OR_COMMENT[suffix].sub(lambda found: found[1] or " ", text)
    each = ("".join(part.split()) for part in END.split(code))
    return frozenset(part for part in each if part and not part.startswith("#program"))


@cache
def stated_by(folder: Path) -> Stated:
    """The statements of the rule files below a folder, which do not change while the process runs."""
    files = sorted(folder.rglob("*.[lp][lp]"))
    return {file: statements(file.read_text("utf-8"), file.suffix) for file in files}


def original(file: Path, mine: frozenset[str], others: Stated) -> Path | None:
    """The first of the ``others`` that a file is a copy of: more than half of the statements of both stand in
    both.
    """
    for other, theirs in others.items():
        if other.suffix == file.suffix and 2 * len(mine & theirs) > len(mine | theirs):
            return other
    return None
