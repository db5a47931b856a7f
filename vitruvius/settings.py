"""A training run as a TOML file: ``train --print-config`` prints one, ``train --config FILE`` reads it.

Its keys are the fields of a preset's config, and ``preset``, ``name`` and ``houses``. TOML has no
None: the word "none" stands for it.
"""

import re
import textwrap
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

import msgspec

from agent.algorithms.table import PRESETS
from agent.learning.config import TrainConfig
from logic.errors import VitruviusError
from logic.opener import content_of
from logic.spelling import unknown
from vitruvius.options import Option, options_of

NONE = "none"

MOST_BYTES = 1 << 18
"""Size of an uncompressed file, in bytes."""

MAX_DOTS, MAX_INTEGER = 256, 1 << 63
"""Number of dots in a line, each of which may start a nested table, and absolute value of an integer."""

BESIDE = "preset", "name", "houses"
"""Keys that are no fields of a config."""


class SettingsError(VitruviusError):
    """A TOML file of settings is absent, is none, or has a key or a value that no run can have."""

    exit_code = 5


def written(config: TrainConfig, options: list[Option], **beside: str | None) -> str:
    """The file: every field with its sentence, and of ``BESIDE`` what is given."""
    import tomli_w

    lines = ["# vitruvius train --config FILE; options on the command line win over what is here.", ""]
    lines += [tomli_w.dumps({key: value}).strip() for key, value in beside.items() if value]
    # As it is read again: 1 is 1.0 where a number is asked for.
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
    """The preset that a file names, its config, and what else of ``BESIDE`` it has. Another ``preset`` takes
    the place of the file's: what the file says besides is kept.

    Raises ``SettingsError``, by file and line.
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
    """The file's content. Raises ``SettingsError``."""
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
    """The line, from 1, on which a key of the file's top stands."""
    pattern = re.compile(rf"""["']?{re.escape(key)}["']?\s*(=|\.|\])""") if key else None
    lines = enumerate(text.splitlines(), start=1)
    return next((number for number, line in lines if pattern and pattern.match(line.lstrip(" \t["))), None)
