"""Explanations of parts of a house, which a solver process finds."""

from collections.abc import Iterator
from pathlib import Path

from vitruvius.logic.errors import GrammarError, HouseFileError, LimitReached
from vitruvius.logic.grammar import find, find_shipped
from vitruvius.logic.house.house import House
from vitruvius.logic.house.part_names import target_in
from vitruvius.logic.why.answer import Why
from vitruvius.logic.workers.messages import Explain, Explained, Open
from vitruvius.logic.workers.solver import answers

MAKING = 60.0
"""Seconds in which to generate the house again and derive the part.

The caller's ``seconds`` limit only the search that follows.
"""


def explain_house(
    house: House, target: str, *, grammar: str | Path | None = None, seconds: float = 60.0
) -> Why:
    """Explain a part of a house by the rules that generated the house.

    ``target`` names the part: a room (``R3``), or a piece or companion (``R3.bed``; ``R3.bed2`` or
    ``R3.bed.2`` for the second one in the file's order). In a star it may be a room's door (``R3.door``) or
    the main room (``main``). In a plan it may be a door between two rooms (``R1-R3``), the ``entrance``, a
    window (``R3.window``), or a unit (``U1`` for the unit of the first rooms).

    The house is generated again from its provenance. ``grammar`` is the directory of its rules if they are
    not shipped.

    Raises ``RequestError`` for a target that the house does not have. Raises ``HouseFileError`` for a house
    without provenance, and if the rules generate another house, because the rules or the house changed.
    Raises ``GrammarError`` for wrong rules, and ``LimitReached`` if the house is not generated again in
    ``MAKING`` seconds. ``seconds`` limits the search for alternatives that follows; the answer's ``limit``
    then says so.
    """
    parts = explained(house, target, grammar=grammar, seconds=seconds)
    whole = next(parts)
    for part in parts:
        whole = whole.joined(part)
    return whole


def explained(
    house: House, target: str, *, grammar: str | Path | None = None, seconds: float = 60.0
) -> Iterator[Why]:
    """Yield the answer of ``explain_house`` part by part as it is found, the derivation first."""
    target_in(house, target)
    made = house.provenance
    if made is None:
        raise HouseFileError("the house file does not name its rules: use a file written by generate")
    try:
        rules = find(grammar) if grammar else find_shipped(made.grammar)
    except GrammarError as error:
        raise HouseFileError(f"{error}. Name the rules that generated the house with --grammar") from None
    question = Explain(target=target, house=house.to_dict(), searching=seconds)
    opening = Open(grammar=str(rules.directory), cell=float(made.request.get("cell", 0.0)))
    late = f"{target} reached the limit of {seconds:g} seconds: raise it with --seconds"
    others = tried = found = 0
    begun = ended = False
    try:
        for answer in answers(opening, question, Explained, seconds, late, MAKING):
            part = answer.why
            others, tried = others + part.others, tried + part.tried
            found += sum(not each.known for choice in part.choices for each in choice.instead)
            begun = True
            yield part
    except LimitReached:
        if not begun:
            raise
        ended = True
    share = (
        f"the reasons against {found} of {others} other values were not found in their share of {seconds:g} "
        "seconds"
    )
    if ended or tried < others:
        yield Why(target, "", limit=f"{late}. {tried} of {others} other values were tried")
    elif found:
        yield Why(target, "", limit=f"{target}: {share}: raise it with --seconds")
