"""Pages for this machine alone: a port of its loopback interface, and the browser that shows a page."""

import errno
import os
import webbrowser

from vitruvius.logic.errors import RequestError
from vitruvius.logic.terminal import say

LOOPBACK = "127.0.0.1"


def require_port(port: int) -> None:
    """Raise ``RequestError`` for a number that is no port."""
    if not 0 <= port < 2**16:
        raise RequestError(f"--port {port}: ports are 0 to {2**16 - 1}")


def refused_port(port: int, error: OSError) -> RequestError:
    """Return the error for a port that another program uses, or that this user may not use."""
    why = f"cannot be used: {os.strerror(error.errno or 0)}"
    if error.errno == errno.EADDRINUSE:
        why = "is in use"
    return RequestError(f"--port {port}: {why}: choose another, or leave it out")


def announce(words: str, address: str, browser: bool) -> None:
    """Print a page's address, and open the page in this machine's browser if ``browser`` is True."""
    say(f"{words}\n  {address}\nCtrl-C ends it.")
    if browser and not webbrowser.open(address):
        say("no browser could be started here: open the address in one")
