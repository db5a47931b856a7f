"""Options and work of ``vitruvius playground``. Cheap to import, as the other commands are."""

from dataclasses import dataclass
from pathlib import Path

from vitruvius.logic.terminal import say


@dataclass(frozen=True)
class Playground:
    """Serve a page that makes houses in the browser, without a solver on this machine. Ctrl-C ends it.

    With --out write it as a folder to publish with any web server. npm fetches its solvers once, 7 MB.
    """

    out: Path | None = None
    """Folder to write the page into, instead of serving it; the folder must be new or empty."""

    port: int = 0
    """Port of the address; 0 for any free port."""

    open: bool = False
    """Open the address in this machine's browser."""

    def run(self) -> int:
        """Write the folder, or serve it until Ctrl-C."""
        from tempfile import TemporaryDirectory

        from vitruvius.logic.browser.loopback import announce, require_port
        from vitruvius.logic.browser.playground.folder import size, write
        from vitruvius.logic.browser.playground.server import listening

        if self.out is not None:
            write(self.out)
            say(
                f"{self.out}: {size(self.out) / 1e6:.1f} MB: publish the folder unchanged; its page is "
                "index.html"
            )
            return 0
        require_port(self.port)
        with TemporaryDirectory() as made:
            folder = Path(made, "page")
            write(folder)
            with listening(folder, self.port) as server:
                address = f"http://{server.server_name}:{server.server_port}/"
                announce("The playground is at", address, self.open)
                server.serve_forever()
        return 0
