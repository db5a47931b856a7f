"""Statements that a grammar's .lp files may contain: rules for layouts that picks can sample, and no code."""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from clingo.ast import ASTType

from vitruvius.logic.encoding import illegible, shown
from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import TYPICAL
from vitruvius.logic.includes import EXAMPLES, SAYS, below
from vitruvius.logic.language.asp.integers import too_large
from vitruvius.logic.language.asp.statements import Statement
from vitruvius.logic.spelling import closest

CHOICES = {ASTType.Aggregate, ASTType.HeadAggregate, ASTType.Disjunction}
STAGES = ("house", "room")
"""The two programs of a layout. ``base`` belongs to both."""

UNITS = "units"
"""Program that precedes the two in a topology with units."""

DIRECTIVES = {
    "external": "a grammar holds only rules: #external atoms are false in every house",
    "script": "a grammar holds only rules, no scripts",
    "minimize": "layouts are sampled, not optimised: use weight/2 or a constraint",
    "show": "the core alone shows what makes a layout: leave #show out",
    "project": "layouts are sampled by picks: leave #project out",
    "heuristic": "layouts are sampled by picks, whatever the heuristic: use the weights of option/3",
    "edge": "a grammar holds rules: leave #edge out, and forbid cycles by a constraint",
    "theory": "a grammar holds rules without theories",
    "include": SAYS["elsewhere"].format(example=EXAMPLES[".lp"]),
}
"""Reasons against directives in a grammar. For includes the reason is a place below the first rule."""

CHOICE = "a choice is made by option/3, as in option(colour,(red;blue),1): see rules/pick.lp"
"""Message for a choice in a head."""

OBJECTIONS = {
    ASTType.External: DIRECTIVES["external"],
    ASTType.Script: DIRECTIVES["script"],
    ASTType.Minimize: DIRECTIVES["minimize"],
    ASTType.ShowSignature: DIRECTIVES["show"],
    ASTType.ShowTerm: DIRECTIVES["show"],
    ASTType.ProjectSignature: DIRECTIVES["project"],
    ASTType.ProjectAtom: DIRECTIVES["project"],
    ASTType.Heuristic: DIRECTIVES["heuristic"],
    ASTType.Edge: DIRECTIVES["edge"],
    ASTType.TheoryDefinition: DIRECTIVES["theory"],
}


UNREAD = re.compile(r'"(?:\\.|[^"\\\n])*+"?|%\*.*?(?:\*%|\Z)|%[^\n]*', re.DOTALL)
"""Strings and comments of clingo's language."""


def audit(statements: Iterable[Statement], stages: Sequence[str] = STAGES) -> Iterator[GrammarError]:
    """Yield an error for each statement without effect, or with a choice outside the picks of ``pick.lp``.

    ``stages``: the programs in addition to ``base``.
    """
    for statement in statements:
        if why := _objection(statement.node, stages):
            yield statement.error(why)


def _objection(node: Any, stages: Sequence[str]) -> str:
    if node.ast_type == ASTType.Program and (node.parameters or node.name not in {"base", TYPICAL, *stages}):
        meant = closest(node.name, [*stages, TYPICAL])
        others = f"there are {', '.join(stages[:-1])} and {stages[-1]}, and base for "
        others += "both" if len(stages) == 2 else "all"
        hint = f"did you mean {meant}?" if meant else others
        return f"#program {node.name} is part of no layout: {hint}"
    if node.ast_type == ASTType.Rule and node.head.ast_type == ASTType.TheoryAtom:
        return OBJECTIONS[ASTType.TheoryDefinition]
    if node.ast_type == ASTType.Rule and node.head.ast_type in CHOICES:
        return CHOICE
    return OBJECTIONS.get(node.ast_type, "")


def unreadable(file: Path) -> Iterator[GrammarError]:
    """Yield errors for the text of a file: no text, or an include that clingo would follow.

    Other errors are for text at which clingo would stop without a message, and for numbers that clingo would
    misread.
    """
    content = file.read_bytes()
    if wrong := illegible(content):
        line, column, why = wrong
        yield GrammarError(why, file, line, column)
        return
    if file.suffix != ".lp":
        return
    text = content.decode()
    if text.startswith("\ufeff"):
        yield GrammarError(
            "a byte order mark, which clingo does not read: save as UTF-8 without it", file, 1, 1
        )
        return
    text = below(text, file.suffix)
    code = UNREAD.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
    yield from too_large(code, file)
    for number, line in enumerate(code.split("\n"), start=1):
        for column, letter in enumerate(line, start=1):
            if not letter.isascii():
                yield GrammarError(f"{shown(letter)}: names are of plain letters", file, number, column)
    for number, line in enumerate(text.split("\n"), start=1):
        # In comments and strings, too, so that nothing depends on where they end.
        if include := re.search(r"#\s*include\b", line):
            yield GrammarError(DIRECTIVES["include"], file, number, include.start() + 1)
