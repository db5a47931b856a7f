"""SWI-Prolog in this process: predicates of the core are called with terms, and answer in JSON.

Terms are built through pyswip's C interface. This module never makes Prolog text, so that no name in a rule
file or in a request can become code. A process has one engine of SWI-Prolog. Therefore this module runs only
in a worker process (``logic.workers.worker``).
"""

import json
from collections.abc import Sequence
from ctypes import byref, c_char_p
from functools import cache
from pathlib import Path
from typing import Any

from clingo import Symbol, SymbolType

from vitruvius.logic.errors import MissingProgram, VitruviusError
from vitruvius.logic.installation import prolog_command

try:
    from pyswip import core as swi
except Exception as error:  # pyswip raises many kinds where it finds no usable SWI-Prolog.
    reason = " ".join(str(error).split()) or "not found"
    raise MissingProgram(f"SWI-Prolog cannot be used ({reason}): {prolog_command()}") from None

OLDEST = 90000
"""Oldest version of SWI-Prolog whose CLP(R) answers as the rules need."""

FLAGS = swi.PL_Q_NODEBUG | swi.PL_Q_CATCH_EXCEPTION


class Term:
    """Compound term."""

    def __init__(self, name: str, *arguments: Any) -> None:
        """Set a name, and arguments as for ``ask``."""
        self.name, self.arguments = name, arguments


class PrologError(Exception):
    """Error that a predicate has raised, with the term as its text."""


def require() -> None:
    """Raise ``MissingProgram`` if SWI-Prolog is too old, or comes without library(clpr)."""
    number = swi.PL_version(swi.PL_VERSION_SYSTEM)
    version = f"SWI-Prolog {number // 10000}.{number // 100 % 100}.{number % 100}"
    if number < OLDEST:
        raise MissingProgram(f"{version} is too old, 9.0 or later is needed: {prolog_command()}")
    try:
        run("use_module", Term("library", "clpr"), module="system")
    except PrologError:
        raise MissingProgram(f"{version} lacks library(clpr): {prolog_command()}") from None


_loaded = set[Path]()


def load(file: Path, compiled: Path | None = None) -> None:
    """Load a file of the core, or the same file as SWI-Prolog has compiled it, unless it is loaded."""
    if file not in _loaded:
        run("use_module", str(compiled or file), module="system")
        _loaded.add(file)


def flag(name: str) -> str:
    """Return the text of a flag of SWI-Prolog."""
    return _called("system", "current_prolog_flag", [name], answers=True)


def run(predicate: str, *arguments: Any, module: str) -> None:
    """Call a predicate with arguments as for ``ask``."""
    _called(module, predicate, arguments, answers=False)


def ask(predicate: str, *arguments: Any, module: str = "core") -> Any:
    """Return the answer of a predicate: JSON, in the argument that follows these.

    An argument is a number, a name, a symbol of clingo, a ``Term``, or a list of these. Raises
    ``PrologError`` if the predicate raises an error.
    """
    return json.loads(_called(module, predicate, arguments, answers=True))


def _called(module: str, predicate: str, arguments: Sequence[Any], answers: bool) -> str:
    """Return the text of the last argument, which the predicate binds if it ``answers``."""
    frame = swi.PL_open_foreign_frame()
    terms, answer = _terms(arguments, answers), len(arguments)
    called = swi.PL_predicate(predicate, answer + answers, module)
    query = swi.PL_open_query(None, FLAGS, called, terms)
    try:
        if swi.PL_next_solution(query):
            return _text(terms + answer, swi.CVT_ATOMIC) if answers else ""
        if error := swi.PL_exception(query):
            raise PrologError(_text(error, swi.CVT_WRITE))
        raise VitruviusError(f"SWI-Prolog has no answer to {predicate}{tuple(arguments)}"[:200])
    finally:
        swi.PL_cut_query(query)
        swi.PL_discard_foreign_frame(frame)


def _text(term: int, kind: int) -> str:
    with swi.PL_STRINGS_MARK():
        text = c_char_p()
        swi.PL_get_chars(term, byref(text), kind | swi.REP_UTF8)
        return (text.value or b"").decode()


def _terms(values: Sequence[Any], more: bool = False) -> int:
    """Return the first of consecutive new terms: one for each value, and with ``more`` an unbound one."""
    terms = swi.PL_new_term_refs(len(values) + more)
    for place, value in enumerate(values):
        _put(terms + place, value)
    return terms


def _put(term: int, value: Any) -> None:
    """Set a new term to a value."""
    match value:
        case Symbol():
            swi.PL_recorded(_record(value), term)
        case str():
            text = value.encode()
            swi.PL_put_chars(term, swi.PL_ATOM | swi.REP_UTF8, len(text), text)
        case int():
            swi.PL_put_integer(term, value)
        case float():
            swi.PL_unify_float(term, value)
        case Term():
            functor = _functor(value.name, len(value.arguments))
            swi.PL_cons_functor_v(term, functor, _terms(value.arguments))
        case _:
            swi.PL_put_nil(term)
            for element in reversed([*value]):
                swi.PL_cons_list(term, _terms([element]), term)


@cache
def _record(symbol: Symbol) -> int:
    """Return a copy of a symbol's term, cached since a grammar has few atoms, each in many layouts."""
    term = swi.PL_new_term_ref()
    if symbol.type is SymbolType.Number:
        _put(term, symbol.number)
    elif symbol.type is SymbolType.Function and symbol.name and symbol.arguments and symbol.positive:
        _put(term, Term(symbol.name, *symbol.arguments))
    else:
        _put(term, str(symbol))
    return swi.PL_record(term)


@cache
def _functor(name: str, arity: int) -> int:
    return swi.PL_new_functor(swi.PL_new_atom(name), arity)
