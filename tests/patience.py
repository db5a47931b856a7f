"""How long a test waits for what comes at once on an idle machine."""

PATIENCE = 300.0
"""Seconds after which a process hangs: far more than it takes beside others that are at work, too."""
