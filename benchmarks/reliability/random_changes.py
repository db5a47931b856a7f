"""Random changes of a file's content: of its bytes, its tokens, or the values of its JSON."""

import json
import random
import re
from typing import Any

VALUES = (
    *(None, True, -1, 0, 1e300, 5e-324, 10**30, 10**400, "", "\x1b[2J", "<b>", "\ud800", "a\nb", "x" * 400),
    *([], {}, [[[]]], "NaN", float("nan"), float("inf"), 0.5, 2**31, 2**63, -(2**63)),
)
"""Unusual values."""

TOKENS = re.compile(rb"\w+|\s+|[^\w\s]+")

ODD = (
    *(
        b"(",
        b")",
        b"{",
        b"}",
        b"[",
        b"]",
        b",",
        b".",
        b":",
        b":-",
        b"%*",
        b"*%",
        b"'",
        b'"',
        b"#",
        b"_",
        b"&a",
    ),
    *(
        b"*a",
        b"!!int",
        b"<<",
        b"<g>",
        b"</g>",
        b"\n",
        b"\0",
        b"\xff",
        b"0",
        b"-1",
        b"9e99",
        b"1" * 400,
        b"..",
    ),
)
"""Unusual tokens."""

MOST_BYTES = 1 << 16
"""Largest size of a changed content, in bytes."""


def changed(content: bytes, rng: random.Random, is_json: bool = False, others: list[bytes] = ()) -> bytes:  # pyright: ignore[reportArgumentType]
    """Return the content with some changes, which may contain tokens of ``others``."""
    kind = rng.random()
    if is_json and kind < 0.6 and (found := changed_json(content, rng)) is not None:
        content = found
    elif kind < 0.85:
        content = changed_tokens(content, TOKENS.findall(rng.choice(others)) if others else [], rng)
    if kind >= 0.75:
        content = changed_bytes(content, rng)
    return content[:MOST_BYTES]


def changed_bytes(text: bytes, rng: random.Random) -> bytes:
    """Change, delete, insert or repeat some bytes, or truncate the content."""
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(text) + 1), rng.randint(1, 9)
        kind = rng.randrange(5)
        if kind == 0:
            text = text[:at] + rng.randbytes(length) + text[at + length :]
        elif kind == 1:
            text = text[:at] + text[at + length :]
        elif kind == 2:
            text = text[:at] + rng.randbytes(length) + text[at:]
        elif kind == 3:
            text = text[:at] + text[at : at + 40] * length + text[at:]
        elif rng.random() < 0.2:
            text = text[:at]
    return text


def changed_tokens(text: bytes, pool: list[bytes], rng: random.Random) -> bytes:
    """Delete, repeat, exchange or replace some tokens."""
    tokens = TOKENS.findall(text)
    for _ in range(rng.randint(1, 4) if tokens else 0):
        at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
        kind = rng.randrange(4)
        if kind == 0:
            tokens[at] = b""
        elif kind == 1:
            tokens[at] *= 2
        elif kind == 2:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        else:
            tokens[at] = rng.choice(ODD if not pool or rng.random() < 0.3 else pool)
    return b"".join(tokens)


def changed_json(content: bytes, rng: random.Random) -> bytes | None:
    """Change some values of JSON, or of a line of JSON Lines. Return None if the content is neither."""
    lines = content.splitlines()
    try:
        record = json.loads(content)
        at, lines = 0, [content]
    except (ValueError, RecursionError):
        if not lines:
            return None
        at = rng.randrange(len(lines))
        try:
            record = json.loads(lines[at])
        except (ValueError, RecursionError):
            return None
    whole = [record]
    changed_record(whole, rng)
    lines[at : at + 1] = [json.dumps(each).encode("utf-8", "surrogatepass") for each in whole]
    return b"\n".join(lines)


def changed_record(record: Any, rng: random.Random) -> None:
    """Change, delete or repeat some values of a record, or move them to another key, in place."""
    for _ in range(rng.randint(1, 3)):
        node: Any = record
        while True:
            keys = list(node) if isinstance(node, dict) else list(range(len(node)))
            if not keys:
                break
            key = rng.choice(keys)
            if isinstance(node[key], dict | list) and rng.random() < 0.8:
                node = node[key]
                continue
            kind, value = rng.randrange(5), node[key]
            if kind == 0:
                node[key] = rng.choice(VALUES)
            elif kind == 1 and isinstance(value, int | float) and abs(value) < 1e300:
                node[key] = value * rng.choice((-1, 0, 1e-9, 0.5, 2, 100, 1e6)) + rng.choice((0, 1e-7, 1, 9))
            elif kind == 2:
                del node[key]
            elif kind == 3:
                node[key] = node[rng.choice(keys)]
            elif isinstance(node, dict):
                node[str(rng.choice([*keys, "R0", "x", "floor", "unit", "type"]))] = value
            else:
                node.insert(key, value)
            break
