"""The playground, served."""

import threading
from collections.abc import Iterator

import pytest

from logic.browser.playground import folder
from logic.browser.playground.server import Server, listening
from logic.errors import MissingProgram


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Iterator[Server]:
    """The page's folder, served as ``vitruvius playground`` serves it."""
    made = tmp_path_factory.mktemp("playground") / "page"
    try:
        folder.write(made)
    except MissingProgram as missing:
        pytest.skip(str(missing))
    with listening(made, 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()


@pytest.fixture
def at(site: Server) -> str:
    """The page's address."""
    return f"http://{site.server_name}:{site.server_port}/"
