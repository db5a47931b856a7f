"""The playground, served."""

import threading
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from tests.conftest import opened_page
from vitruvius.logic.browser.playground import folder
from vitruvius.logic.browser.playground.server import Server, listening
from vitruvius.logic.errors import MissingProgram


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Iterator[Server]:
    """Serve the page's folder as ``vitruvius playground`` does."""
    made = tmp_path_factory.mktemp("playground") / "page"
    try:
        folder.write(made)
    except MissingProgram as missing:
        pytest.skip(str(missing))
    with listening(made, 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()


@pytest.fixture(scope="module")
def at(site: Server) -> str:
    """Return the page's address."""
    return f"http://{site.server_name}:{site.server_port}/"


@pytest.fixture(scope="module")
def opened(browser: Browser, at: str) -> Iterator[Page]:
    """Open a document beside the page, from which tests ask the page's worker.

    The document stays for all tests of a module, and starts no other solvers.
    """
    with opened_page(browser) as page:
        page.goto(f"{at}page.css")
        yield page
