"""Pages of results: their folders, tables in Markdown, and the machine and versions that they name."""

import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import write_whole

if TYPE_CHECKING:
    from vitruvius.agent.evaluation.tables import Table

ROOT = Path(__file__).resolve().parents[2]
"""Folder of the checkout, or of the installed wheel."""

DOCS = ROOT / "docs"

BY_HAND = b"<!-- What follows is written by hand. -->\n"
"""A published page keeps this line, and everything after it."""


def write(files: Mapping[str, bytes], out: Path, publish: bool = False, folder: str = "") -> None:
    """Write a study's page and pictures into its folder, and with ``publish`` into a folder of docs."""
    if publish and not DOCS.is_dir():
        raise RequestError(f"--publish: there is no {DOCS}: pages are published in a checkout of the project")
    for name, content in files.items():
        write_whole(out / name, content)
        if publish:
            page = DOCS / folder / name
            _, mark, by_hand = page.read_bytes().partition(BY_HAND) if page.exists() else (b"", b"", b"")
            write_whole(page, content + b"\n" + mark + by_hand if mark else content)


def write_tables(tables: "Iterable[Table]", path: Path) -> None:
    """Write tables as a page of Markdown, and print the page."""
    page = "\n\n".join(table.markdown() for table in tables)
    write_whole(path, f"{page}\n".encode())
    print(page)


def write_arrays(path: Path, **arrays: Any) -> None:
    """Write arrays by name, for ``np.load``, as a complete file or not at all."""
    content = BytesIO()
    np.savez(content, **arrays)
    write_whole(path, content.getvalue())


def png(figure: Any) -> bytes:
    """Return a figure of matplotlib as the bytes of a PNG file."""
    content = BytesIO()
    figure.savefig(content, format="png")
    return content.getvalue()


def table_rows(rows: Iterable[Iterable[str]]) -> str:
    """Return the rows of a Markdown table."""
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def milliseconds(seconds: float) -> str:
    """Return a time in milliseconds, with meaningful digits only."""
    return f"{1e3 * seconds:,.{0 if seconds >= 1 else 1 if seconds >= 1e-3 else 3}f}"


def median_ms(entry: dict[str, Any] | None) -> str:
    """Return a benchmark's median in milliseconds, or an empty text without a benchmark."""
    return milliseconds(entry["stats"]["median"]) if entry else ""


def machine(info: Mapping[str, Any] | None = None) -> str:
    """Return the processor, its cores and the system, of this machine or from a benchmark's record."""
    if info is None:
        from cpuinfo import get_cpu_info

        brand = get_cpu_info().get("brand_raw", platform.machine())
        info = {"system": platform.system(), "cpu": {"brand_raw": brand, "count": os.cpu_count()}}
    cpu = info.get("cpu", {})
    return f"{cpu.get('brand_raw') or info['machine']}, {cpu.get('count', '?')} cores, {info['system']}"


def versions(*names: str, python: str = platform.python_version(), **more: str) -> str:
    """Return the versions of Python, of distributions by name, and of ``more``, in words."""
    found = {"Python": python} | more | {name: version(name) for name in names}
    return ", ".join(f"{name} {number}" for name, number in found.items())


def revision() -> str:
    """Return the checkout's commit."""
    asked = ["git", "describe", "--always", "--dirty"]
    done = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "unknown"
