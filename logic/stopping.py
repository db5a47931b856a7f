"""Signals that ask a process to end: Ctrl-C, SIGTERM of schedulers and ``kill``, SIGHUP of terminals."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from types import FrameType
from typing import Any

AGAIN_S = 0.2
"""Seconds after which ``act`` runs again if a signal came during an import, which may have swallowed it."""


class Terminated(KeyboardInterrupt):
    """Request by a signal to end the process. Finished results are kept."""

    exit_code = 128 + signal.SIGTERM

    def __init__(self) -> None:
        """Set the message."""
        super().__init__("terminated")


ENDS = {signal.SIGTERM: Terminated, signal.SIGINT: KeyboardInterrupt}
"""Exception for each signal."""

HAS_ALARM = hasattr(signal, "setitimer")
"""True on POSIX, which has SIGHUP, too; False on Windows."""

if HAS_ALARM:
    ENDS[signal.SIGHUP] = Terminated


@contextmanager
def at_signals(act: Callable[[KeyboardInterrupt], object]) -> Iterator[None]:
    """Call ``act`` with the signal's exception at the first signal of each kind within the block.

    A second signal ends the process at once; a second Ctrl-C raises ``KeyboardInterrupt``.
    """
    with ExitStack() as stack:
        for number, kind in ENDS.items():
            then = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
            stack.enter_context(_at(number, partial(act, kind()), then))
        yield


@contextmanager
def heeded_after(seconds: float = 2.0) -> Iterator[None]:
    """Delay a signal that comes within the block until the block ends, so that no output line is cut.

    If the reader does not take the line, the signal acts after ``seconds``. A second signal acts at once.
    """
    before = {number: act for number in ENDS if callable(act := signal.getsignal(number))}
    if threading.current_thread() is not threading.main_thread() or not before or not HAS_ALARM:
        yield
        return
    came: list[int] = []

    def heed(number: int, frame: FrameType | None) -> None:
        if came:
            before[signal.Signals(came.pop())](number, frame)
        elif number != signal.SIGALRM:
            came.append(number)
            signal.setitimer(signal.ITIMER_REAL, seconds)

    alarm = signal.signal(signal.SIGALRM, heed)
    for number in before:
        signal.signal(number, heed)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, act in {**before, signal.SIGALRM: alarm}.items():
            signal.signal(number, act)
        heed(signal.SIGALRM, None)


def end(by: KeyboardInterrupt) -> None:
    """Raise the exception."""
    raise by


@contextmanager
def _at(number: signal.Signals, act: Callable[[], object], then: Any) -> Iterator[None]:
    """Call ``act`` at a signal within the block; ``then`` handles a second signal.

    While a module is imported, libraries may swallow the exception of ``act`` or raise another one. In this
    case ``act`` is called again. The block does nothing outside the main thread, which alone receives
    signals, and nothing if the signal is ignored.
    """
    before = signal.getsignal(number)
    if threading.current_thread() is not threading.main_thread() or before == signal.SIG_IGN:
        yield
        return

    def heed(_: int, frame: FrameType | None) -> None:
        nonlocal importing
        signal.signal(number, then)
        if importing := HAS_ALARM and _imports(frame):
            signal.signal(signal.SIGALRM, heed)
            signal.setitimer(signal.ITIMER_REAL, AGAIN_S)
        act()

    importing = False
    signal.signal(number, heed)
    try:
        yield
    except Exception:
        if importing:
            act()
        raise
    finally:
        if HAS_ALARM:
            signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(number, before)


def _imports(frame: FrameType | None) -> bool:
    """Return True if this frame, or a frame that waits for it, imports a module."""
    while frame:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
