"""Picture of ARCHITECTURE.md, drawn from the code: ``./run python -m tests.docs.architecture``.

Each package has a band, and each of its folders a box, from the lowest to the highest. A box has the first
sentence of the folder's ``__init__`` and the folders of its package that it imports directly. An arrow leads
from a folder to the next if the next one imports it.
"""

import ast
import re
import textwrap
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from tests.test_imports import FOLDERS, PACKAGES, ROOT, graph, place

FILE = ROOT / "docs" / "architecture.svg"

WIDTH, COLUMNS, GAP, MARGIN = 960, 4, 20, 16
BOX = (WIDTH - 2 * MARGIN - (COLUMNS - 1) * GAP) / COLUMNS, 92
HEAD, ROWS, SINGLE = 34, 12, 22
"""Pixels of a band's title, between rows, and of the line that names modules outside folders."""

LETTERS = 31
"""Letters in a line of a box, by the widest of the usual fonts."""

COLOURS = {
    "logic": ("#e4efe7", "#2f6b46"),
    "sim": ("#e3ecf7", "#2b5a8c"),
    "agent": ("#f6eadb", "#8a5a17"),
    "benchmarks": ("#f1e6f3", "#6f3c7b"),
    "vitruvius": ("#ececec", "#444444"),
}
"""Colours of each package: its boxes and its words."""

GIVES = {
    "logic": "rules become houses: those of rules/ and grammars/, by clingo and SWI-Prolog",
    "sim": "houses become environments",
    "agent": "agents act and learn in them",
    "benchmarks": "studies measure all of it",
    "vitruvius": "commands for all of it",
}


def arrows(package: str) -> dict[str, set[str]]:
    """Return the imports between a package's top-level folders and modules, by importer."""
    found: dict[str, set[str]] = {}
    for module, others in graph().items():
        of, folder = place(module)
        if of == package and folder:
            own = found.setdefault(folder, set())
            own |= {place(other)[1] for other in others if place(other)[0] == package} - {""}
    return {name: others - {name} for name, others in found.items()}


def below(name: str, imported: dict[str, set[str]]) -> set[str]:
    """Return all folders that a folder imports, by itself or through others."""
    return imported[name].union(*(below(other, imported) for other in imported[name]))


def direct(name: str, imported: dict[str, set[str]]) -> list[str]:
    """Return the folders that a folder imports and that none of its other imports import."""
    others = imported[name]
    return sorted(others - set[str]().union(*(below(other, imported) for other in others)))


def order(package: str, imported: dict[str, set[str]]) -> list[str]:
    """Return the folders and modules of a package, from the lowest up."""
    return [*FOLDERS[package]] if package in FOLDERS else sorted(imported)


def sentence(folder: Path) -> str:
    """Return the first sentence of a folder's docstring, in words."""
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text())) or ""
    return re.sub("`+", "", " ".join(text.partition("\n\n")[0].split())).partition(". ")[0].rstrip(".")


def word(text: str, x: float, y: float, size: int, colour: str, style: str = "") -> str:
    """Return a line of text."""
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{colour}"{style}>{escape(text)}</text>'


def box(name: str, says: str, uses: Sequence[str], x: float, y: float, package: str) -> Iterator[str]:
    """Yield a folder's box: its name, its sentence, and its imports."""
    (fill, ink), (width, height) = COLOURS[package], BOX
    yield f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height}" rx="6" fill="{fill}"/>'
    yield word(f"{name}/", x + 10, y + 20, 14, ink, ' font-weight="bold"')
    for line, part in enumerate(textwrap.wrap(says, LETTERS)):
        yield word(part, x + 10, y + 38 + 15 * line, 12, "#222222")
    if uses:
        yield word("imports " + ", ".join(uses), x + 10, y + height - 8, 11, ink, ' font-style="italic"')


def arrow(x: float, y: float, colour: str) -> str:
    """Return an arrow from one box to the next."""
    way = f"M{x + 3:g} {y:g} h{GAP - 7:g} m-5 -5 l5 5 l-5 5"
    return f'<path d="{way}" fill="none" stroke="{colour}" stroke-width="2"/>'


def band(package: str, top: float) -> tuple[list[str], float]:
    """Return a package's band, and where the next one begins."""
    imported = arrows(package)
    names = order(package, imported)
    folders = [name for name in names if (ROOT / package / name).is_dir()]
    single = [name for name in names if name not in folders]
    shapes = [
        word(package, MARGIN, top + 20, 18, COLOURS[package][1], ' font-weight="bold"'),
        word(GIVES[package], MARGIN + 135, top + 20, 13, "#222222"),
    ]
    top += HEAD
    for number, name in enumerate(folders):
        x = MARGIN + number % COLUMNS * (BOX[0] + GAP)
        y = top + number // COLUMNS * (BOX[1] + ROWS)
        uses = [each for each in direct(name, imported) if each in folders] if package in FOLDERS else []
        shapes += box(name, sentence(ROOT / package / name), uses, x, y, package)
        if number % COLUMNS and folders[number - 1] in uses:
            shapes.append(arrow(x - GAP, y + BOX[1] / 2, COLOURS[package][1]))
    top += -(-len(folders) // COLUMNS) * (BOX[1] + ROWS)
    if single:
        shapes.append(word(f"and the modules {', '.join(single)}", MARGIN, top + 12, 12, "#444444"))
        top += SINGLE
    return shapes, top + ROWS


def picture() -> str:
    """Return the picture of all packages, from the lowest, which imports none, to the command line."""
    shapes: list[str] = []
    top: float = MARGIN
    for package in PACKAGES:
        drawn, top = band(package, top)
        shapes += drawn
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {top:g}" width="{WIDTH}" '
            f'height="{top:g}" font-family="system-ui, Segoe UI, Helvetica, Arial, sans-serif">',
            '<rect width="100%" height="100%" fill="#ffffff"/>',
            *shapes,
            "</svg>\n",
        ]
    )


if __name__ == "__main__":
    FILE.write_text(picture())
