"""Checks of all pages: nothing is wider than the screen or cut off on paper, and axe reports nothing."""

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import FloatRect, Locator, Page

from vitruvius.logic.browser.playground.npm import installed
from vitruvius.logic.errors import MissingProgram

WIDTHS = 320, 390, 768, 1280
"""Widths of screens, in CSS pixels."""

PAPER = 718
"""Width of A4 between margins of 1 cm, in CSS pixels."""

CUT = """() => [...document.querySelectorAll("body *")].filter((each) => {
    const { display, visibility, overflowX, overflowY } = getComputedStyle(each);
    if (!each.checkVisibility() || each.closest("svg, dialog, select, textarea")) return false;
    const wide = overflowX !== "visible" && each.scrollWidth > each.clientWidth + 1;
    const high = overflowY !== "visible" && each.scrollHeight > each.clientHeight + 1;
    return wide || high || each.getBoundingClientRect().right > document.documentElement.clientWidth + 1;
}).map((each) => `${each.tagName} ${each.className}: ${each.textContent.trim().slice(0, 60)}`)"""
"""Script that lists elements whose content is cut off, or that reach beyond the right edge."""


@cache
def axe() -> str:
    """Return the text of axe-core, which ``tests/axe/package-lock.json`` names."""
    try:
        packages = installed(Path(__file__).with_name("axe"), "axe-core, which judges pages,")
    except MissingProgram as missing:
        pytest.skip(str(missing))
    return (packages / "axe-core" / "axe.min.js").read_text()


def findings(page: Page) -> list[str]:
    """Return axe's violations, with its best practices and its rule on names that match labels.

    Contrast in a dark theme is checked, too.
    """
    page.evaluate(axe())
    every = {"rules": {"label-content-name-mismatch": {"enabled": True}}, "preload": False}
    found: dict[str, Any] = page.evaluate("(how) => axe.run(document, how)", every)
    page.emulate_media(color_scheme="dark")
    dark = page.evaluate("() => axe.run(document, { runOnly: ['color-contrast'], preload: false })")
    page.emulate_media(color_scheme="light")
    found["violations"] += dark["violations"]
    return [
        f"{each['id']}: {node['target']} {node['html'][:120]} {node['failureSummary'][-120:]}"
        for each in found["violations"]
        for node in each["nodes"]
    ]


def too_wide(page: Page) -> list[int]:
    """Return the widths in ``WIDTHS`` that are narrower than the page."""
    found = []
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 844})
        if page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth"):
            found.append(width)
    return found


def cut_on_paper(page: Page) -> list[str]:
    """Return what is cut off when the page is printed, in a dark theme."""
    page.emulate_media(media="print", color_scheme="dark")
    page.set_viewport_size({"width": PAPER, "height": 1000})
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    return page.evaluate(CUT)


def box(place: Locator) -> FloatRect:
    """Return the box of an element on the screen."""
    found = place.bounding_box()
    assert found
    return found


def answered_under_the_finger(phone: Page, tapped: Locator) -> None:
    """Tap an element and check: the answer is at the foot of the screen, the element stays above it."""
    tapped.tap()
    answer = box(phone.locator("#answer"))
    assert answer["y"] > 844 / 3
    assert answer["y"] + answer["height"] == pytest.approx(844, abs=1)
    asked = box(tapped)
    assert asked["y"] >= 0
    assert asked["y"] + asked["height"] <= answer["y"]


def line_is_seen(phone: Page) -> None:
    """Check that the requested line of a rule file is on the screen, above the answer if there is one."""
    answer = phone.locator("#answer")
    foot = box(answer)["y"] if answer.is_visible() else 844
    line = box(phone.locator("#code .here"))
    assert 0 <= line["y"] < foot - 10
