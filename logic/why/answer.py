"""Answer to the question why a room, a piece or a door of a house is as it is, and its text.

A solver process finds the answer, by ``logic.why.witness``.
"""

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import msgspec

from vitruvius.logic.errors import Reason
from vitruvius.logic.grammar import RULES

INSTEAD = "Alternatives, with all other picks unchanged"

WHERE = {
    "along": "along its wall, from the near end",
    "left": "from the room's left wall, as seen on entering",
    "across": "from the room's left wall, as seen on entering",
    "inwards": "from the wall with the door",
}
"""Meanings of the lengths of places. The names of sizes need no explanation."""


class Derivation(msgspec.Struct, frozen=True):
    """Atom of a layout, the rule that derives it, and the atoms in the rule's body.

    Without a rule the atom is explained above in the same answer. ``means`` is the rules' own comment on the
    atom. ``options`` are the possible values of a pick.
    """

    atom: str
    rule: Reason | None = None
    means: str = ""
    options: tuple[str, ...] = ()
    body: tuple["Derivation", ...] = ()

    def all(self) -> Iterator["Derivation"]:
        """Yield this derivation and all below it, each before its own body."""
        yield self
        for each in self.body:
            yield from each.all()


class Alternative(msgspec.Struct, frozen=True):
    """Another value of a choice with all other picks fixed: possible, or with the reasons against it.

    ``because`` is a minimal conflict. ``also`` lists other choices that must all change to make the value
    possible; if empty, no change helps. Results that are not ``known`` in time are left out.
    """

    value: str
    possible: bool
    also: tuple[str, ...] = ()
    because: tuple[Reason, ...] = ()
    known: bool = True


class Choice(msgspec.Struct, frozen=True):
    """Choice with its value and the alternatives."""

    name: str
    value: str
    instead: tuple[Alternative, ...] = ()


class Length(msgspec.Struct, frozen=True):
    """Length of the house (metres), its least and greatest possible value, and the reasons for both."""

    name: str
    value: float
    least: float
    greatest: float
    no_less: tuple[Reason, ...]
    no_more: tuple[Reason, ...]


class Bound(msgspec.Struct, frozen=True):
    """Linear constraint that is tight in the house, in words, and the reasons for it."""

    text: str
    because: tuple[Reason, ...]


class Why(msgspec.Struct, frozen=True):
    """Explanation of a part of a house. Its text is the output of ``vitruvius explain HOUSE --why``.

    The choices have ``others`` other values, of which ``tried`` were tried. ``limit`` states what ended the
    search early, if anything.
    """

    target: str
    about: str
    derivations: tuple[Derivation, ...] = ()
    choices: tuple[Choice, ...] = ()
    lengths: tuple[Length, ...] = ()
    tight: tuple[Bound, ...] = ()
    others: int = 0
    tried: int = 0
    limit: str = ""

    def joined(self, more: "Why") -> "Why":
        """Return this answer together with the next part."""
        choices = {choice.name: choice for choice in self.choices}
        for choice in more.choices:
            before = choices[choice.name].instead if choice.name in choices else ()
            choices[choice.name] = msgspec.structs.replace(choice, instead=(*before, *choice.instead))
        return msgspec.structs.replace(
            self,
            derivations=(*self.derivations, *more.derivations),
            choices=tuple(choices.values()),
            lengths=(*self.lengths, *more.lengths),
            tight=(*self.tight, *more.tight),
            others=self.others + more.others,
            tried=self.tried + more.tried,
            limit=more.limit or self.limit,
        )

    def __str__(self) -> str:
        """Return the answer, section by section."""
        return "\n".join(as_text([self]))


def as_text(parts: Iterable[Why]) -> Iterator[str]:
    """Yield the lines of an answer, part by part as it comes."""
    title, name = "", ""
    for number, part in enumerate(parts):
        if number == 0:
            yield f"{part.target}: {part.about}"
        sections: dict[str, Iterable[Iterator[str]]] = {
            "Derived from facts and picks": [_tree(each, 1) for each in part.derivations],
            "Lengths, and their possible ranges": map(_length, part.lengths),
            "Bounds that are tight: both sides are equal here (floor: what the furniture leaves free)": map(
                _bound, part.tight
            ),
            INSTEAD: [_choice(each, each.name != name) for each in part.choices],
        }
        for heading, paragraphs in sections.items():
            for line in (line for paragraph in paragraphs for line in paragraph):
                if heading != title:
                    yield from ("", heading)
                    title = heading
                yield line
        name = part.choices[-1].name if part.choices else name


# Text


def place(reason: Reason) -> str:
    """Return a place as in ``rooms.lp:9``, or ``rules/room/room.lp:9`` for the core."""
    return f"{file_name(reason.file or '')}:{reason.line}"


def file_name(file: str | Path) -> str:
    """Return the short name of a rule file: ``rooms.lp``, or ``rules/room/room.lp`` for the core."""
    file = Path(file)
    return f"rules/{file.relative_to(RULES)}" if RULES in file.parents else file.name


def _stated(reason: Reason) -> str:
    return f"{place(reason)}: {reason.text}" if reason.file else reason.text


def _tree(node: Derivation, depth: int) -> Iterator[str]:
    """Yield the lines of a derivation without the core's own facts, which define words."""
    indent = "  " * depth
    if depth == 1 and node.means:
        yield from textwrap.wrap(node.means, 110, initial_indent=indent, subsequent_indent=indent)
    if node.rule is None:
        yield f"{indent}{node.atom:<{46 - len(indent)}} see above"
        return
    body, said = node.body, _stated(node.rule)
    if node.options:
        # The rule of all picks adds nothing to the options and their own rule.
        option = next(each for each in body if each.atom.startswith("option("))
        rule = _stated(option.rule) if option.rule else "see above"
        body, said = option.body, f"picked out of {_series(node.options)}; {rule}"
    yield f"{indent}{node.atom:<{46 - len(indent)}} {said}"
    if node.options and node.means:
        yield from textwrap.wrap(
            node.means, 110, initial_indent=f"{indent}  ", subsequent_indent=f"{indent}  "
        )
    for each in body:
        if each.rule is None or each.body or RULES not in Path(each.rule.file or "").parents:
            yield from _tree(each, depth + 1)


def _series(values: Sequence[str]) -> str:
    """Return values as text, as ``1..4`` for consecutive whole numbers."""
    numbers = [int(value) for value in values if value.isdigit()]
    if len(values) == len(numbers) > 2 and numbers[-1] - numbers[0] == len(numbers) - 1:
        return f"{values[0]}..{values[-1]}"
    return ", ".join(values)


def _choice(choice: Choice, new: bool) -> Iterator[str]:
    """Yield a ``new`` choice, or the reasons against more values of the previous one."""
    able = [each.value for each in choice.instead if each.possible]
    others = f", or {_series(able)}" if able else ""
    if new:
        yield f"  {choice.name} = {choice.value}{others}"
    for each in choice.instead:
        if not each.possible:
            yield f"    {each.value}: {_how(each)}"
            yield from _reasons(each.because, "  ") if each.because else ()


def _how(other: Alternative) -> str:
    """Return the conditions under which another value would be possible."""
    if not other.because and not other.known:
        return "not with all other picks unchanged; the reason was not found in time"
    also = " and ".join(other.also)
    how = f"only if {also} changed too" if also else "impossible" if other.known else "not so"
    return f"{how}, because of"


def _length(length: Length) -> Iterator[str]:
    value, least, greatest = (f"{metres:.3f}" for metres in (length.value, length.least, length.greatest))
    where = f" ({WHERE[length.name]})" if length.name in WHERE else ""
    if least == greatest:
        yield f"  {length.name:<8} {value} m, no other{where}"
        yield from _reasons(length.no_less, "")
        return
    end = ", the least" if value == least else ", the greatest" if value == greatest else ""
    yield f"  {length.name:<8} {value} m{end}, of {least} to {greatest}{where}"
    if length.no_less == length.no_more:
        yield from _reasons(length.no_less, "")
    else:
        yield from _reasons(length.no_less, "no less: ")
        yield from _reasons(length.no_more, "no more: ")


def _bound(bound: Bound) -> Iterator[str]:
    yield f"  {bound.text}"
    yield from _reasons(bound.because, "")


def _reasons(reasons: Sequence[Reason], label: str) -> Iterator[str]:
    """Yield rules and clauses, a line each, then the atoms of the layout."""
    lines = [_stated(each) for each in reasons if each.file]
    atoms = [each.text for each in reasons if not each.file]
    if atoms:
        lines += textwrap.wrap(
            f"{'with ' if lines else ''}{', '.join(atoms)}", 100, subsequent_indent="     "
        )
    for number, line in enumerate(lines or ["the core alone: rules/room/room.pl"]):
        yield f"    {label if number == 0 else ' ' * len(label)}{line}"
