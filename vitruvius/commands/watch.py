"""Options and work of ``vitruvius watch``. Cheap to import, as the other commands are."""

import secrets
from dataclasses import dataclass

import tyro

from vitruvius.logic.errors import RequestError


@dataclass(frozen=True)
class Watch:
    """Show the houses of a grammar in a browser, redrawn whenever one of its files is saved. Ctrl-C ends it.

    The page is served to this machine alone, at an address with a random token.
    """

    grammar: tyro.conf.Positional[str] = "home"
    """Name of a shipped grammar, or a directory of rules."""

    port: int = 0
    """Port of the address; 0 for any free port."""

    open: bool = False
    """Open the address in this machine's browser."""

    seconds: float = 20.0
    """Time limit in seconds for a house, and for an answer about a house."""

    def run(self) -> int:
        """Serve the page until Ctrl-C."""
        from vitruvius.logic.browser.loopback import LOOPBACK, announce
        from vitruvius.logic.browser.watch.server import Server, listening
        from vitruvius.logic.browser.watch.session import Session
        from vitruvius.logic.grammar import folder

        if not 0 < self.seconds < 1e6:
            raise RequestError(f"--seconds {self.seconds:g}: must be above 0 and below a million")
        directory, token = folder(self.grammar), secrets.token_urlsafe(16)
        with listening(self.port) as door:
            session = Session(directory, self.grammar, self.seconds)
            address = f"http://{LOOPBACK}:{door.getsockname()[1]}/{token}/"
            announce(f"{directory}: its houses are at", address, self.open)
            Server(session, token).run(sockets=[door])
        return 0
