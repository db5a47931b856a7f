"""Kinds of mistakes, in a table for each place of mistakes."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Mistake:
    """Edit of a copy of a shipped grammar, and the message about it."""

    title: str
    file: str
    old: str
    """Text to replace in the file, which occurs once; if empty, ``new`` is appended as a line."""
    new: str
    says: str
    """Words of the message with its hint. ``line [file: words]`` stands for the line that begins so."""
    at: str = ""
    """Text in ``new`` to which the message points, by line and column; empty for its beginning."""
    severity: str = "error"
    grammar: str = "family"
