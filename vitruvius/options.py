"""Options of a command, derived from its dataclass, for the help and for one-line errors.

tyro converts the arguments to the dataclass. This module lists the options first, and refuses a wrong
argument in one line, for which tyro would print many.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import tyro

from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import closest, unknown

METAVARS = {int: "N", float: "X", str: "TEXT", Path: "PATH"}
"""Placeholders of values in help, by type."""

DASH = "a dash is a standard stream"
"""Mark of a field, by ``Annotated``, whose value may be ``-``: the standard input, or output of ``--out``."""

Streamed = Annotated[Path, DASH]
"""Path of a file that may be ``-``."""


@dataclass(frozen=True)
class Option:
    """Option of a command, or an argument without a name."""

    name: str
    """Name of the field."""
    type: Any
    """Type of one value: bool, int, float, str or Path."""
    help: str
    """Description in one or more sentences."""
    group: str
    """Title of the option's group."""
    default: Any = MISSING
    choices: tuple[str, ...] = ()
    shown: str = ""
    """Placeholder of the value in help, if it differs from the type's."""
    positional: bool = False
    several: bool = False
    """True if the option takes values one after the other."""
    repeated: bool = False
    """True if the option is given once for each value."""
    optional: bool = False
    """True if the option accepts the word None."""
    dash: bool = False
    """True if ``-`` is a standard stream."""

    @property
    def flag(self) -> str:
        """Flag, as in ``--keep-rooms``."""
        return "--" + self.name.replace("_", "-")

    @property
    def metavar(self) -> str:
        """Placeholder of the value in help."""
        if self.choices and not self.shown:
            return "{" + ",".join(self.choices) + "}"
        return self.shown or (self.name.upper() if self.positional else METAVARS[self.type])

    def require(self, value: str) -> None:
        """Raise ``RequestError`` for a value that the option cannot have."""
        if self.optional and value == "None":
            return
        shown = value if self.positional else f"{self.flag} {value}"
        if self.type in (str, Path) and not value.strip():
            named = self.metavar if self.positional else self.flag
            raise RequestError(f"{named}: is empty: give {self.metavar}: {self.help}")
        if self.type is Path and value == "-" and not self.dash:
            way = "written to standard output" if self.writes else "read from standard input"
            raise RequestError(f"{shown}: is not {way}: give a path: {self.help}")
        if self.choices and value not in self.choices:
            raise RequestError(f"{shown}: {unknown(self.shown.lower() or self.name, value, self.choices)}")
        if self.type in (int, float):
            try:
                self.type(value)
            except ValueError:
                kind = "whole number" if self.type is int else "number"
                raise RequestError(f"{self.flag} {value}: give a {kind}, as in {self._example()}") from None

    @property
    def writes(self) -> bool:
        """True if the option names an output."""
        return self.name == "out"

    def _example(self) -> str:
        """Return the option with a value that it may have."""
        default = self.default if isinstance(self.default, int | float) else 3 if self.type is int else 0.5
        return f"{self.flag} {default}"


def options_of(command: Any) -> list[Option]:
    """Return the options of a command: a dataclass, or an instance of one whose values are the defaults.

    A field that holds a dataclass stands for the fields of that dataclass. A class's ``groups`` has the
    titles of groups of options, by the first field of each group.
    """
    found, title = list[Option](), "Options"
    kind = command if isinstance(command, type) else type(command)
    hints, sentences = get_type_hints(kind, include_extras=True), _sentences(kind)
    groups = {name: words for each in kind.__mro__ for name, words in vars(each).get("groups", {}).items()}
    for each in fields(kind):
        default = getattr(command, each.name) if command is not kind else _default(each)
        if is_dataclass(default):
            found += options_of(default)
            continue
        title = groups.get(each.name, title)
        found.append(_option(each.name, hints[each.name], default, sentences.get(each.name, ""), title))
    return found


def require(prog: str, arguments: Sequence[str], options: Sequence[Option]) -> None:
    """Raise ``RequestError`` for arguments that the command does not accept.

    Such arguments are an unknown option, an invalid value, an extra word, or a missing word or option.
    """
    loose, given, dashes = list[str](), set[str](), list[str]()
    left = list(arguments)
    while left:
        word = left.pop(0)
        if not word.startswith("--"):
            loose.append(word)
            continue
        flag, has_value, value = word.partition("=")
        option = _named(prog, flag.replace("_", "-"), options)
        values = [value] if has_value else []
        if option.type is bool and has_value:
            raise RequestError(f"{word}: {option.flag} takes no value: leave it out")
        most = 0 if option.type is bool or has_value else len(left) if option.several else 1
        while most and left and not left[0].startswith("--"):
            values.append(left.pop(0))
            most -= 1
        if not values and option.type is not bool and not option.several:
            raise RequestError(
                f"{option.flag}: give a value, as in {option.flag} {option.metavar}: {option.help}"
            )
        for each in values:
            option.require(each)
        given.add(option.name)
        if option.dash and not option.writes and "-" in values:
            dashes.append(f"{option.flag} -")
    _require_loose(prog, loose, options)
    if len(dashes) + loose.count("-") > 1:
        both = " and ".join([*["-"] * loose.count("-"), *dashes])
        raise RequestError(
            f"{prog}: {both}: standard input can be read only once: name a file for the others"
        )
    for option in options:
        if option.default is MISSING and not option.positional and option.name not in given:
            raise RequestError(f"{prog}: give {option.flag} {option.metavar}: {option.help}")


def _named(prog: str, flag: str, options: Iterable[Option]) -> Option:
    """Return the option of a flag. Raises ``RequestError`` that suggests what was meant."""
    known = {option.flag: option for option in options if not option.positional}
    off = {f"--no-{name[2:]}": option for name, option in known.items() if option.type is bool}
    found = (known | off).get(flag)
    if found is None:
        close = closest(flag[2:], [each[2:] for each in (*known, *off, "--help")])
        hint = f"did you mean --{close}?" if close else f"see {prog} --help"
        raise RequestError(f"{prog}: there is no option {flag}: {hint}")
    return found


def _require_loose(prog: str, words: Sequence[str], known: Sequence[Option]) -> None:
    """Raise ``RequestError`` for too few, too many or wrong arguments without names."""
    options = [option for option in known if option.positional]
    for word in words:
        flag = f"--{word.lstrip('-').partition('=')[0].casefold()}"
        if flag in [option.flag for option in known if not option.positional] and not Path(word).exists():
            meant = f"--{word.lstrip('-')}"
            raise RequestError(f"{prog}: {word}: did you mean {meant}?")
    if len(words) > len(options) and not any(option.several for option in options):
        surplus = words[len(options)]
        raise RequestError(f"{prog}: unexpected argument {surplus}: see {prog} --help")
    for word, option in zip(words, options, strict=False):
        option.require(word)
    for option in options[len(words) :]:
        if option.default is MISSING:
            raise RequestError(f"{prog}: give {option.metavar}: {option.help}")


def _option(name: str, hint: Any, default: Any, sentence: str, group: str) -> Option:
    """Return an option from its dataclass field."""
    marks = list[Any]()
    optional = several = False
    while origin := get_origin(hint):
        if origin is Annotated:
            hint, *more = get_args(hint)
            marks += more
        elif origin in (Union, UnionType):
            [hint] = (each for each in get_args(hint) if each is not NoneType)
            optional = True
        elif origin is tuple:
            hint, several = get_args(hint)[0], True
        elif origin is Literal:
            break
    choices = tuple(map(str, get_args(hint))) if get_origin(hint) is Literal else ()
    repeated = tyro.conf.UseAppendAction in marks
    return Option(
        name,
        str if choices else hint,
        " ".join(
            [
                *sentence.replace("``", "").split(),
                *(mark.help for mark in marks if getattr(mark, "help", None)),
            ]
        ),
        group,
        default,
        choices,
        shown=next((mark.metavar for mark in marks if getattr(mark, "metavar", None)), ""),
        positional=tyro.conf.Positional in marks,
        several=several and not repeated,
        repeated=repeated,
        optional=optional,
        dash=DASH in marks,
    )


def _default(each: Any) -> Any:
    """Return the default of a dataclass's field, or ``MISSING``."""
    return each.default_factory() if each.default_factory is not MISSING else each.default


@cache
def _sentences(kind: type) -> dict[str, str]:
    """Return the docstrings of a dataclass's fields, its own and the inherited ones, by field."""
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        if is_dataclass(each):
            [body] = ast.parse(textwrap.dedent(inspect.getsource(each))).body
            assert isinstance(body, ast.ClassDef)
            found |= {ast.unparse(field.target): sentence for field, sentence in _documented(body)}
    return found


def _documented(kind: ast.ClassDef) -> Iterator[tuple[ast.AnnAssign, str]]:
    """Yield the fields of a class, each with the docstring below it."""
    for field, following in pairwise(kind.body):
        if isinstance(field, ast.AnnAssign):
            match following:
                case ast.Expr(ast.Constant(str() as sentence)):
                    yield field, sentence
