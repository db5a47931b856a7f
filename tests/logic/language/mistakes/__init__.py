"""Kinds of mistakes, in a table for each place where they are made."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mistake:
    """One edit of a copy of a shipped grammar, and what is said of it."""

    title: str
    file: str
    old: str
    """What is replaced in the file: it stands there once; empty to append ``new`` as a line of its own."""
    new: str
    says: str
    """Words of the message, its hint included; ``line [file: words]`` is the line that begins so."""
    at: str = ""
    """The text of ``new`` that the message points at, by line and column; empty for its beginning."""
    severity: str = "error"
    grammar: str = "family"
