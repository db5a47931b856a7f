"""Server of a folder of static files, for this machine alone."""

from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from vitruvius.logic.browser.loopback import LOOPBACK, refused_port

HEADERS = {
    "Cache-Control": "no-cache",
    "Content-Security-Policy": "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "connect-src 'self'; worker-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
"""HTTP headers. ``wasm-unsafe-eval`` allows WebAssembly and nothing else.

The solvers have one thread each. Therefore they need no shared memory, the page needs no cross-origin
isolation (COOP, COEP), and any web server can serve it.
"""


class Handler(SimpleHTTPRequestHandler):
    """Handler for the files of a folder, with the types that browsers need.

    The types do not depend on this system's table.
    """

    extensions_map = {  # noqa: RUF012 (declared so by the base class)
        "": "application/octet-stream",
        ".css": "text/css",
        ".html": "text/html",
        ".js": "text/javascript",
        ".json": "application/json",
        ".wasm": "application/wasm",
    }

    def end_headers(self) -> None:
        """Add the headers of ``HEADERS``."""
        for name, value in HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def list_directory(self, path: object) -> None:
        """Refuse to list a folder."""
        self.send_error(404)

    def log_message(self, format: str, *args: object) -> None:
        """Write no log."""


class Server(ThreadingHTTPServer):
    """Server with a thread for each request."""

    daemon_threads = True

    def server_bind(self) -> None:
        """Bind without a look-up of this machine's name, which may take seconds."""
        self.socket.bind(self.server_address)
        self.server_name, self.server_port = self.socket.getsockname()


def listening(folder: Path, port: int) -> Server:
    """Return a server of this folder that is ready for ``serve_forever``.

    Raises ``RequestError`` for a port that another program uses, or that this user may not use.
    """
    try:
        return Server((LOOPBACK, port), partial(Handler, directory=str(folder)))
    except OSError as error:
        raise refused_port(port, error) from None
