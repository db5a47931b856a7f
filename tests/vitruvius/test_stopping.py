"""Signals end a command in any state, and once."""

import fcntl
import json
import os
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path

import pytest

from vitruvius.logic.stopping import Terminated, at_signals, end, heeded_after

pytestmark = pytest.mark.second_part("commands are stopped at many times")

PASSED_OVER = """
import os
try:
    os.kill(os.getpid(), {number})
    sum(range(1000))
except BaseException:
    {then}
"""
"""Module in whose import a signal comes, like libraries that try optional imports."""

ENDS = {signal.SIGTERM: Terminated, signal.SIGHUP: Terminated, signal.SIGINT: KeyboardInterrupt}
"""Errors of the signals, with the exit codes of docs/command-line.md."""


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
    """Outside imports a signal is heeded once, and the result is written completely."""
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
    """The houses are whole, also with a slow reader: a pipe holds some, and the command waits."""
    words = ["generate", "--grammar", "home", "--rooms", "8", "--count", "1000"]  # more than Python buffers
    running = subprocess.Popen(
        [sys.executable, "-m", "vitruvius.cli", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert running.stdout
    most = fcntl.fcntl(running.stdout.fileno(), fcntl.F_GETPIPE_SZ)
    held = 0
    while held != (held := _waiting(running.stdout.fileno())) or held < most / 2:
        time.sleep(1)
    running.send_signal(signal.SIGHUP)
    time.sleep(0.2)
    houses, said = running.communicate(timeout=60)
    assert (running.returncode, said) == (143, b"terminated\n")
    assert len(houses) > held
    assert all(json.loads(line)["unit"] == "m" for line in houses.splitlines())


def test_a_reader_that_takes_nothing_is_not_waited_for() -> None:
    out, into = os.pipe()
    held = os.write(into, bytes(fcntl.fcntl(into, fcntl.F_GETPIPE_SZ)))
    begun = time.monotonic()

    def write() -> None:
        with at_signals(end), heeded_after(0.1):
            os.kill(os.getpid(), signal.SIGTERM)
            os.write(into, b"house")

    with pytest.raises(Terminated):
        write()
    assert time.monotonic() - begun < 30
    assert len(os.read(out, held + 1)) == held
    os.close(out)
    os.close(into)


def _waiting(pipe: int) -> int:
    """Return the number of bytes in a pipe."""
    return int.from_bytes(fcntl.ioctl(pipe, termios.FIONREAD, bytes(4)), sys.byteorder)
