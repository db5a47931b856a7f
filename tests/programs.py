"""Programs that a test starts, and the time limit for answers that are immediate on an idle machine."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PATIENCE = 300.0
"""Seconds after which a process counts as hanging: far more than it needs on a busy machine."""


def finished(command: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a program to its end, whatever its exit code, and return its output."""
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False, **options)
