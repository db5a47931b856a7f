"""Conversion of a frozen dataclass's values: to the types of its fields, and to types that JSON has."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from numbers import Integral, Real
from typing import Any, TypeVar, get_args, get_origin

import numpy as np

from vitruvius.logic.spelling import unknown

T = TypeVar("T")

KINDS: dict[Any, tuple[Any, str]] = {
    bool: (bool, "True or False"),
    int: (Integral, "a whole number"),
    float: (Real, "a number"),
    str: (str, "text"),
}
"""Accepted values and their name in messages, by the type of the field."""


class Derived(tuple[Any, ...]):
    """Value that a dataclass computes from its other fields if the given value is ``None``.

    ``settle`` replaces the value by ``None``, so that ``dataclasses.replace`` computes it again.
    """


def settle(instance: Any, of: str = "") -> None:
    """Convert the values of a frozen dataclass to the types of its fields.

    NumPy numbers become Python numbers, lists and arrays become tuples, and a dictionary of fields becomes a
    dataclass. Raises ``ValueError`` for a value of another type; the message begins with ``of``.
    """
    for each in fields(instance):
        value = getattr(instance, each.name)
        if each.default is None and (value is None or isinstance(value, Derived)):
            value = None
        else:
            value = _read(of + each.name, value, each.type)
        object.__setattr__(instance, each.name, value)


def made(kind: type[T], values: Mapping[str, Any], noun: str = "field") -> T:
    """Return a dataclass with the given values. Raises ``ValueError`` for an unknown field."""
    known = [each.name for each in fields(kind)]  # pyright: ignore[reportArgumentType]
    for name in values:
        if name not in known:
            raise ValueError(unknown(noun, name, known))
    return kind(**values)


def stated(value: Any) -> Any:
    """Return a value in JSON types; of a dataclass, only the fields that differ from their defaults."""
    if isinstance(value, Derived):
        return None
    if is_dataclass(value):
        pairs = [(each, stated(getattr(value, each.name))) for each in fields(value)]
        return {each.name: found for each, found in pairs if found != stated(_default(each))}
    if isinstance(value, Mapping):
        return {name: stated(each) for name, each in value.items()}
    if isinstance(value, tuple | list):
        return [stated(each) for each in value]
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def _default(field: Field[Any]) -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()


def _read(name: str, value: Any, kind: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if get_origin(kind) is tuple:
        return _tuple(name, value, get_args(kind))
    if is_dataclass(kind) and isinstance(value, Mapping):
        return made(kind, value, f"field of {name}")  # pyright: ignore[reportArgumentType]
    expected, words = KINDS.get(kind, (object, ""))
    if isinstance(kind, type) and is_dataclass(kind):
        expected, words = kind, f"a {kind.__name__} or a dictionary of its fields"
    if not isinstance(value, expected) or (isinstance(value, bool) and kind in (int, float)):
        raise ValueError(f"{name} must be {words}, not {value!r}")
    return value


def _tuple(name: str, value: Any, kinds: tuple[Any, ...]) -> tuple[Any, ...]:
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise ValueError(f"{name} must be a list, not {value!r}")
    if kinds[1:] == (Ellipsis,):
        kinds = kinds[:1] * len(value)
    if len(value) != len(kinds):
        raise ValueError(f"{name} must have {len(kinds)} values, not {value!r}")
    pairs = zip(value, kinds, strict=True)
    return tuple(_read(f"{name}[{k}]", each, kind) for k, (each, kind) in enumerate(pairs))
