"""Answers of the playground's worker, without the page around it."""

from collections.abc import Mapping
from typing import Any

from playwright.sync_api import Page

PARTS = """([grammar, files, request]) => new Promise((resolve, reject) => {
    window.solvers ??= new Worker("worker.js");
    const parts = [];
    solvers.onmessage = ({ data: { part, done, error } }) => {
        if (part) parts.push(part);
        if (done) resolve(parts);
        if (error) reject(new Error(error));
    };
    solvers.postMessage({ id: performance.now(), grammar, files, request });
})"""


def answered(
    page: Page, grammar: str, files: Mapping[str, str], request: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return the parts of a sheet of houses, from a worker that stays with the page."""
    return page.evaluate(PARTS, [grammar, files, request])
