"""Training settings as a TOML file: ``train --print-config`` prints one, ``train --config FILE`` reads it.

Its keys are the fields of a preset's config, and ``preset``, ``name`` and ``houses``. TOML has no None: the
word "none" stands for it.
"""

import re
import textwrap
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

import msgspec

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.opener import content_of
from vitruvius.logic.spelling import unknown
from vitruvius.options import Option, options_of

NONE = "none"

MOST_BYTES = 1 << 18
"""Largest size of an uncompressed file, in bytes."""

MAX_DOTS, MAX_INTEGER = 256, 1 << 63
"""Largest number of dots in a line, each of which may start a nested table, and largest absolute value of an
integer."""

BESIDE = "preset", "name", "houses"
"""Keys that are not fields of a config."""


class SettingsError(VitruviusError):
    """Error for a TOML file of settings that is absent or malformed, or has an invalid key or value."""

    exit_code = 5


def written(config: TrainConfig, options: list[Option], **beside: str | None) -> str:
    """Return the file: every field with its sentence, and the given values of ``BESIDE``."""
    import tomli_w

    lines = ["# vitruvius train --config FILE; options on the command line win over what is here.", ""]
    lines += [tomli_w.dumps({key: value}).strip() for key, value in beside.items() if value]
    # values as they will be read again: 1 becomes 1.0 for a field that is a float
    values, title = asdict(msgspec.convert(asdict(config), type(config))), ""
    for option in options:
        if option.name not in values:
            continue
        if option.group != title:
            title = option.group
            lines += ["", f"# - {title} " + "-" * (70 - len(title))]
        value = values[option.name]
        lines += textwrap.wrap(option.help, 100, initial_indent="# ", subsequent_indent="# ")
        lines.append(tomli_w.dumps({option.name: NONE if value is None else value}).strip())
    return "\n".join(lines) + "\n"


def read(path: Path, preset: Any = None) -> tuple[Any, TrainConfig, dict[str, str]]:
    """Return a file's preset, its config, and its other values of ``BESIDE``.

    The argument ``preset`` replaces the file's preset; the file's other settings stay. Raises
    ``SettingsError``, by file and line.
    """
    text = _text(path)
    for number, line in enumerate(text.splitlines(), start=1):
        if line.count(".") > MAX_DOTS:
            raise SettingsError(
                f"{path}:{number}: more than {MAX_DOTS} dots in a line: no setting has so many"
            )
    try:
        found = tomllib.loads(text)
        if _has_long_integer(found):
            raise ValueError("an integer of more than 64 bits")
    except RecursionError:
        raise SettingsError(f"{path}: no TOML: nested too deeply") from None
    except ValueError as error:
        reason, _, place = str(error).partition(" (at line ")
        line = f":{place.partition(',')[0]}" if place[:1].isdigit() else ""
        raise SettingsError(f"{path}{line}: no TOML: {reason}") from None

    def refuse(key: str, words: str) -> NoReturn:
        number = _line(text, key)
        raise SettingsError(f"{path}:{number}: {words}" if number else f"{path}: {words}") from None

    for key in BESIDE:
        if key in found and not isinstance(found[key], str):
            refuse(key, f"{key}: expected text, not {found[key]!r}")
    beside = {key: found.pop(key) for key in BESIDE if key in found}
    preset = preset or beside.pop("preset", "pqn")
    if preset not in PRESETS:
        refuse("preset", unknown("preset", preset, PRESETS))
    base = PRESETS[preset]
    known = {option.name: option for option in options_of(base)}
    for key, value in found.items():
        if isinstance(value, dict):
            refuse(key, f"[{key}]: settings stand at the top of the file, in no table")
        if key not in known:
            refuse(key, f"preset {preset}: {unknown('setting', key, [*known, *BESIDE])}")
        if known[key].choices and value not in known[key].choices:
            refuse(key, unknown(key, value, known[key].choices))
    given = {key: None if value == NONE and known[key].optional else value for key, value in found.items()}
    try:
        config = msgspec.convert(asdict(base) | given, type(base))
    except msgspec.ValidationError as error:
        reason, _, place = str(error).partition(" - at `$.")
        key = re.match(r"\w*", place or reason)
        name = key[0] if key and key[0] in given else ""
        refuse(name, f"{name}: {reason[0].lower()}{reason[1:]}" if place else reason)
    return preset, config, {key: value for key, value in beside.items() if key != "preset"}


def _text(path: Path) -> str:
    """Return the file's content. Raises ``SettingsError``."""
    try:
        return content_of(path, MOST_BYTES).decode()
    except OSError as error:
        raise SettingsError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise SettingsError(f"{path}: no TOML: it is no text in UTF-8") from None


def _has_long_integer(value: Any) -> bool:
    """Return True if a value, or a value inside it, is an integer of more than 64 bits."""
    if isinstance(value, dict | list):
        return any(map(_has_long_integer, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int) and abs(value) > MAX_INTEGER


def _line(text: str, key: str) -> int | None:
    """Return the line, from 1, with a key at the top level of the file."""
    pattern = re.compile(rf"""["']?{re.escape(key)}["']?\s*(=|\.|\])""") if key else None
    lines = enumerate(text.splitlines(), start=1)
    return next((number for number, line in lines if pattern and pattern.match(line.lstrip(" \t["))), None)
