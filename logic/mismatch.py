"""Messages for a JSON value of the wrong type: the place, the permitted values, and the given value."""

import json
import re
from collections.abc import Iterable
from typing import Any

import msgspec
from msgspec import inspect

from vitruvius.logic.spelling import unknown

MAX_SHOWN = 40
"""Number of characters of a wrong value that a message quotes."""

WORDS = {
    inspect.BoolType: "true or false",
    inspect.FloatType: "a number",
    inspect.IntType: "a whole number",
    inspect.StrType: "a text",
    inspect.DictType: "an object",
}
"""Words for types without parts."""

BOUNDS = {"<=": "at most", ">=": "at least", "<": "below", ">": "above"}


def mismatch(error: msgspec.ValidationError, value: Any, kind: Any) -> str:
    """Return the message for an error of ``msgspec.convert(value, kind)``.

    An example: ``rooms[0].outside[0]: there is no value South: did you mean south? There are east, north``.
    """
    reason, _, place = str(error).partition(" - at `$")
    place = place.rstrip("`").lstrip(".")
    permitted = inspect.type_info(kind)
    for key, index in re.findall(r"(\w+)|\[(\d+)\]", place):
        value = value[key or int(index)]
        permitted = _part(permitted, key, int(index or 0))
    words = _words(reason, value, permitted)
    return f"{place}: {words}" if place else words


def _words(reason: str, value: Any, permitted: inspect.Type) -> str:
    """Return the message for a value and msgspec's ``reason``."""
    kinds = [*_kinds(permitted)]
    if named := re.fullmatch(r"Object (contains unknown|missing required) field `(.*)`", reason):
        fields = [field for kind in kinds if isinstance(kind, inspect.StructType) for field in kind.fields]
        keys = [field.encode_name for field in fields]
        return f"{named[2]} is missing" if "missing" in reason else unknown("key", named[2], keys)
    items = [kind.item_type for kind in kinds if isinstance(kind, inspect.VarTupleType)]
    literals = [kind for kind in (*kinds, *items) if isinstance(kind, inspect.LiteralType)]
    choices = [choice for literal in literals for choice in literal.values]
    given = json.dumps(value, ensure_ascii=False, default=repr)
    given = given if len(given) <= MAX_SHOWN else f"{given[:MAX_SHOWN]}..."
    if isinstance(value, str) and value in choices:
        return f"must be a list: write [{given}]"
    if isinstance(value, str) and literals == kinds:
        return unknown("value", value, map(str, choices))
    if "regex" in reason:
        return f"must be one line, without a space at its ends, not {given}"
    if bound := re.search(r"( of length)? ([<>]=?) (\S+)$", reason):
        limit = f"{BOUNDS[bound[2]]} {bound[3]}"
        return f"must be {_described(permitted)}, {f'{limit} long' if bound[1] else limit}, not {given}"
    is_measure = isinstance(value, str) and value[:1].isdigit() and "a number" in _described(permitted)
    advice = ": write numbers without quotes and units" if is_measure else ""
    return f"must be {_described(permitted)}, not {given}{advice}"


def _kinds(permitted: inspect.Type) -> Iterable[inspect.Type]:
    """Yield the types of a union, or the type alone, without null."""
    for kind in permitted.types if isinstance(permitted, inspect.UnionType) else (permitted,):
        if not isinstance(kind, inspect.NoneType):
            yield kind.type if isinstance(kind, inspect.Metadata) else kind


def _part(permitted: inspect.Type, key: str, index: int) -> inspect.Type:
    """Return the type of a field, or of an element if there is no ``key``."""
    for kind in _kinds(permitted):
        if key and isinstance(kind, inspect.StructType):
            return next(field.type for field in kind.fields if field.encode_name == key)
        if not key and isinstance(kind, inspect.VarTupleType):
            return kind.item_type
        if not key and isinstance(kind, inspect.TupleType):
            return kind.item_types[index]
    return inspect.AnyType()


def _described(permitted: inspect.Type) -> str:
    """Return words for the values of a type, as in ``a number or [a number, a number]``."""
    return " or ".join(map(_one, _kinds(permitted)))


def _one(kind: inspect.Type) -> str:
    if isinstance(kind, inspect.LiteralType):
        return f"one of {', '.join(map(str, kind.values))}"
    if isinstance(kind, inspect.VarTupleType):
        return f"a list, each {_described(kind.item_type)}"
    if isinstance(kind, inspect.TupleType):
        parts = [_described(each) for each in kind.item_types]
        if parts == 2 * [WORDS[inspect.FloatType]]:
            return "[least, most]"
        return f"a list of {len(parts)}, each {parts[0]}"
    if isinstance(kind, inspect.StructType):
        return f"an object of {', '.join(field.encode_name for field in kind.fields)}"
    return WORDS.get(type(kind), "another value")
