"""Answers of commands with ``--json``."""
