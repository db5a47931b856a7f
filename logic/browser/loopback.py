"""Pages for this machine alone: a port of its loopback interface, and the browser that shows them."""

import errno
import os
import webbrowser

from logic.errors import RequestError
from logic.terminal import say

LOOPBACK = "127.0.0.1"


def require_port(port: int) -> None:
    """Raise ``RequestError`` for what is no port."""
    if not 0 <= port < 2**16:
        raise RequestError(f"--port {port}: ports are 0 to {2**16 - 1}")


def refused_port(port: int, error: OSError) -> RequestError:
    """Why a port cannot be had: another program has it, or it is not for this user."""
    why = f"cannot be used: {os.strerror(error.errno or 0)}"
    if error.errno == errno.EADDRINUSE:
        why = "is in use"
    return RequestError(f"--port {port}: {why}: choose another, or leave it out")


def announce(words: str, address: str, browser: bool) -> None:
    """Say where a page is, and open it in this machine's ``browser`` if that is asked for."""
    say(f"{words}\n  {address}\nCtrl-C ends it.")
    if browser and not webbrowser.open(address):
        say("no browser could be started here: open the address in one")
