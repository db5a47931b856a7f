"""Signals end a command whatever it is doing, and once."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from logic.stopping import Terminated, at_signals, end

PASSED_OVER = """
import os
try:
    os.kill(os.getpid(), {number})
    sum(range(1000))
except BaseException:
    {then}
"""
"""A module that is imported as a signal comes, as libraries are that try what they can import."""

ENDS = {signal.SIGTERM: Terminated, signal.SIGHUP: Terminated, signal.SIGINT: KeyboardInterrupt}
"""As docs/command-line.md has the exit codes."""


@pytest.mark.parametrize("then", ["pass", "raise ImportError('no such thing') from None"])
@pytest.mark.parametrize("number", ENDS)
def test_a_signal_during_an_import_is_not_lost(
    number: signal.Signals, then: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "passes_over.py").write_text(PASSED_OVER.format(number=int(number), then=then))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "passes_over", raising=False)
    before = signal.getsignal(number)

    def work() -> None:
        with at_signals(end):
            __import__("passes_over")
            time.sleep(5)

    with pytest.raises(ENDS[number]):
        work()
    assert signal.getsignal(number) == before


def test_what_is_made_is_kept_while_it_is_written() -> None:
    """Beside imports a signal is heeded once: what it ends is written in peace."""
    written = []

    def work() -> None:
        with at_signals(end):
            try:
                os.kill(os.getpid(), signal.SIGTERM)
                time.sleep(5)
            except KeyboardInterrupt:
                time.sleep(0.5)
                written.append("all")
                raise

    with pytest.raises(Terminated):
        work()
    assert written


def test_a_lost_terminal_leaves_the_houses_that_were_made() -> None:
    words = ["generate", "--rooms", "1", "--count", "1000"]
    running = subprocess.Popen(
        [sys.executable, "-m", "vitruvius.cli", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stdout
    first = running.stdout.readline()
    running.send_signal(signal.SIGHUP)
    rest, said = running.communicate(timeout=60)
    assert (running.returncode, said) == (143, "terminated\n")
    assert all(json.loads(line)["unit"] == "m" for line in (first, *rest.splitlines()))
