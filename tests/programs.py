"""Programs that a test starts, and how long it waits for what comes at once on an idle machine."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PATIENCE = 300.0
"""Seconds after which a process hangs: far more than it takes beside others that are at work, too."""


def finished(command: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """A program that was run to its end, whatever its exit code, and what it said."""
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False, **options)
