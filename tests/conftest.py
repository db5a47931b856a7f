"""Configuration of both parts of the tests, with a browser and a display.

A test that takes long, and seldom finds what others do not, is marked ``pytest.mark.second_part(reason)``.
``./run test`` runs the first part; ``./run test --all`` both, as ``.ci/run`` does. A file or folder of the
second part that the command line names runs as any other does.

``./run test`` installs the browser and the display, which tests of pages and windows need.
"""

import fcntl
import gc
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from playwright.sync_api import Browser, Page, sync_playwright

TESTS = Path(__file__).parent

WHOLE_FILE = "\npytestmark = pytest.mark.second_part("
"""Line of a file whose tests are all in the second part."""

# The duration of a case is no claim, particularly not while other tests run.
settings.register_profile("tests", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tests")

# A browser for tests alone: without a sandbox, which root may not have, and without requests to its vendor.
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option ``--all``, which includes the second part."""
    parser.addoption("--all", action="store_true", help="the second part of the tests too")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Skip the import of files of the second part that is left out."""
    if collection_path.suffix != ".py" or not _is_left_out(collection_path, config):
        return None
    return True if WHOLE_FILE in collection_path.read_text() else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect tests of the second part that are in files of the first."""
    left_out = {
        item for item in items if item.get_closest_marker("second_part") and _is_left_out(item.path, config)
    }
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]


def pytest_collection_finish() -> None:
    """Freeze imported objects, so that the garbage collector does not search them again and again."""
    gc.freeze()


def pytest_sessionfinish() -> None:
    """Let Taichi store the kernels that this process has compiled, one process after the other.

    Taichi itself waits a quarter of a second for another process that writes, and xdist ten seconds for its
    processes.
    """
    if runtime := sys.modules.get("vitruvius.sim.runtime"):
        with Path(__file__).open() as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            if passing := sys.modules.get("vitruvius.sim.environment.passing"):
                passing.close_all()
            runtime.ti.reset()


def _is_left_out(path: Path, config: pytest.Config) -> bool:
    """Return True if tests of the second part at a path are not requested, by ``--all`` or by their path."""
    asked = [Path(each.partition("::")[0]).resolve() for each in config.args]
    named = [each for each in asked if each.is_relative_to(TESTS) and each != TESTS]
    return not config.getoption("--all") and not any(
        path.is_relative_to(each) or each.is_relative_to(path) for each in named
    )


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Yield the system's Chromium, headless."""
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("no chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield browser
        browser.close()


@contextmanager
def opened_page(browser: Browser, **options: Any) -> Iterator[Page]:
    """Yield a page that fails the test if it logs a warning or an error, throws, or asks another host."""
    errors: list[str] = []
    context = browser.new_context(**options)

    def route(route) -> None:
        url = route.request.url
        if url.startswith(("http://127.0.0.1:", "file:", "data:", "blob:")):
            route.continue_()
        else:
            errors.append(f"asked {url}")
            route.abort()

    context.route("**/*", route)
    page = context.new_page()
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda line: errors.append(line.text) if line.type in {"error", "warning"} else None)
    yield page
    context.close()
    assert not errors


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """Yield such a page on a screen."""
    with opened_page(browser, viewport={"width": 1280, "height": 800}) as page:
        yield page


@pytest.fixture
def phone(browser: Browser) -> Iterator[Page]:
    """Yield such a page on the touch screen of a phone."""
    with opened_page(browser, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True) as page:
        yield page


@pytest.fixture
def display(tmp_path) -> Iterator[dict[str, str]]:
    """Yield the environment of a process with a virtual display of 1280 by 800 pixels."""
    if shutil.which("Xvfb") is None or shutil.which("xdotool") is None:
        pytest.skip("no Xvfb or no xdotool")
    read, write = os.pipe()
    arguments = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24", "-nolisten", "tcp"]
    with subprocess.Popen(arguments, pass_fds=[write], stderr=subprocess.DEVNULL) as server:
        os.close(write)
        with os.fdopen(read) as answer:
            number = answer.readline().strip()
        yield {**os.environ, "DISPLAY": f":{number}", "SDL_VIDEODRIVER": "x11"}
        server.terminate()
