"""Detection of rule files that copy another file, whole or with changes."""

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
"""Patterns of quoted text (as a group) and of comments, for the files of each language."""

END = re.compile(r"\.(?=\s|\Z)")
"""End of a statement, which neither ``1..3`` nor ``0.8`` contains."""


Stated = Mapping[Path, frozenset[str]]
"""Statements of each rule file."""


def statements(text: str, suffix: str) -> frozenset[str]:
    """Return the statements of a rule file with this suffix, without comments and white space.

    The function reads the file as text, because only a confined process parses the rules of users.
    """
    code = QUOTED_OR_COMMENT[suffix].sub(lambda found: found[1] or " ", text)
    each = ("".join(part.split()) for part in END.split(code))
    return frozenset(part for part in each if part and not part.startswith("#program"))


@cache
def stated_by(folder: Path) -> Stated:
    """Return the statements of the rule files in a folder, which do not change while the process runs."""
    files = sorted(folder.rglob("*.[lp][lp]"))
    return {file: statements(file.read_text("utf-8"), file.suffix) for file in files}


def original(file: Path, mine: frozenset[str], others: Stated) -> Path | None:
    """Return the first of the ``others`` that a file copies, or None.

    A file is a copy if the two files share more than half of all their statements.
    """
    for other, theirs in others.items():
        if other.suffix == file.suffix and 2 * len(mine & theirs) > len(mine | theirs):
            return other
    return None
