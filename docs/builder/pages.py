"""Pages that the build makes from code, so that they always match it."""

import ast
import json
import os
import sys
from base64 import b64decode
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FunctionType
from typing import Any

ROOT = Path(__file__).parents[2]
AGENT = (
    *(
        "vitruvius.agent.learning.environments",
        "vitruvius.agent.avoidance",
        "vitruvius.agent.policies.policies",
        "vitruvius.agent.runs.checkpoint",
        "vitruvius.agent.banks",
    ),
    *(
        "vitruvius.agent.learning.config",
        "vitruvius.agent.evaluation.episodes",
        "vitruvius.agent.evaluation.protocol",
        "vitruvius.agent.evaluation.result",
    ),
)
"""Modules that users' programs import from ``agent``, as those in ``examples/`` do."""


def fenced(text: str, language: str = "text") -> str:
    """Return a block of code, whatever fences it contains."""
    return f"````{language}\n{text.strip()}\n````\n"


def schema(_: Path) -> str:
    """Return the page of the JSON Schema of a house, with a table for each of its objects."""
    objects = json.loads((ROOT / "docs" / "house.schema.json").read_text())["$defs"]
    page = [
        "# Schema of house files",
        "",
        "This page is made of [house.schema.json](../house.schema.json), which",
    ]
    page += ["`vitruvius schema` prints. What the fields mean: [house files](../house-file.md).", ""]
    for name in sorted(objects, key=lambda name: name != "House"):
        page += [f"## {name}", "", _words(objects[name]["description"]), ""]
        if "properties" not in objects[name]:
            page += [f"It is {_kind(objects[name])}.", ""]
            continue
        page += ["| field | is | |", "|---|---|---|"]
        for field, kind in objects[name]["properties"].items():
            page.append(f"| `{field}` | {_kind(kind)} | {_default(field, kind, objects[name])} |")
        page.append("")
    return "\n".join(page)


def _words(docstring: str) -> str:
    return " ".join(docstring.split()).replace("``", "`")


def _default(field: str, kind: dict[str, Any], owner: dict[str, Any]) -> str:
    if field in owner["required"]:
        return "required"
    return f"by default `{json.dumps(kind['default'])}`" if "default" in kind else "optional"


def _kind(kind: dict[str, Any]) -> str:
    """Return the type of a value, in words."""
    words = {
        "$ref": lambda: _link(kind["$ref"].rpartition("/")[2]),
        "anyOf": lambda: " or ".join(map(_kind, kind["anyOf"])),
        "enum": lambda: " or ".join(f"`{json.dumps(value)}`" for value in kind["enum"]),
        "prefixItems": lambda: f"a list of {len(kind['prefixItems'])}, each {_kind(kind['prefixItems'][0])}",
        "items": lambda: f"a list of {_kind(kind['items'])}{_bounds(kind, 'minItems', 'maxItems')}",
        "additionalProperties": lambda: f"an object of {_kind(kind['additionalProperties'])} by name",
        "pattern": lambda: f"a string: `{kind['pattern']}`{_characters(kind)}",
        "type": lambda: f"{_article(kind['type'])}{_bounds(kind, 'minimum', 'maximum')}",
    }
    return next(say() for key, say in words.items() if key in kind)


def _link(name: str) -> str:
    return f"[{name}](#{name.lower()})"


def _article(name: str) -> str:
    return "`null`" if name == "null" else f"an {name}" if name[0] in "aeiou" else f"a {name}"


def _characters(kind: dict[str, Any]) -> str:
    return f", at most {kind['maxLength']} characters" if "maxLength" in kind else ""


def _bounds(kind: dict[str, Any], least: str, most: str) -> str:
    if most not in kind:
        return ""
    return f", {kind[least]:g} to {kind[most]:g}" if least in kind else f", {kind[most]:g} at most"


def package(name: str, about: str, *more: str) -> Callable[[Path], str]:
    """Return a function that makes a page of the docstrings of a package's exports and of some modules."""

    def page(_: Path) -> str:
        names = [_identifier(name, each) for each in import_module(name).__all__]
        return "\n\n".join([f"# Python: {name}", about, *(f"::: {each}" for each in [*names, *more]), ""])

    return page


def modules(name: str, about: str, *names: str) -> Callable[[Path], str]:
    """Return a function that makes a page of the docstrings of some modules."""
    return lambda _: "\n\n".join([f"# Python: {name}", about, *(f"::: {each}" for each in names), ""])


def _identifier(package: str, name: str) -> str:
    """Return the module path of a class or function: a package may have a module of the same name."""
    value = getattr(import_module(package), name)
    return f"{value.__module__}.{name}" if isinstance(value, type | FunctionType) else f"{package}.{name}"


def notebook(path: Path) -> Callable[[Path], str]:
    """Return a function that runs a notebook from top to bottom and makes a page of it, with its pictures."""

    def page(folder: Path) -> str:
        cells = enumerate(executed(ROOT / path).cells)
        text = "".join(_cell(number, cell, folder) for number, cell in cells)
        return text.replace(
            "\n", f"\n\nThis page is [a notebook]({path.name}), run when the site was built.\n", 1
        )

    return page


def executed(path: Path) -> Any:
    """Return a notebook with the outputs of all its cells, run in a new folder; fail if a cell fails."""
    import nbformat
    from nbclient import NotebookClient
    from traitlets.config import Config

    cells = nbformat.read(path, as_version=4)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    os.environ["PATH"] = os.pathsep.join([f"{sys.prefix}/bin", os.environ.get("PATH", "")])
    with TemporaryDirectory() as folder:
        # Sockets in the folder: other users could listen on a port.
        sockets = Config(KernelManager={"transport": "ipc", "ip": f"{folder}/kernel"})
        where = {"metadata": {"path": folder}}
        return NotebookClient(cells, config=sockets, timeout=300, resources=where).execute()


def _cell(number: int, cell: Any, folder: Path) -> str:
    """Return a cell as Markdown; its pictures become files in the folder."""
    if cell.cell_type == "markdown":
        return f"{cell.source}\n\n"
    outputs = (_output(f"cell-{number}-{each}", output, folder) for each, output in enumerate(cell.outputs))
    return fenced(cell.source, "python") + "\n" + "".join(outputs)


def _output(name: str, output: Any, folder: Path) -> str:
    """Return a cell's output in the form that pages show best."""
    data = output.get("data", {})
    pictures = {"image/svg+xml": "svg", "image/png": "png", "image/gif": "gif"}
    for kind in data.keys() & pictures.keys():
        file = folder / f"{name}.{pictures[kind]}"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data[kind].encode() if kind == "image/svg+xml" else b64decode(data[kind]))
        return f"![What the cell shows]({file.name})\n\n"
    if "text/html" in data:
        return f"<div>{data['text/html']}</div>\n\n"
    return fenced(output.get("text") or data.get("text/plain", "")) + "\n"


def source(path: Path, text: str) -> str:
    """Return a file of code as a page."""
    language = {".lp": "prolog", ".pl": "prolog", ".py": "python", ".toml": "toml"}[path.suffix]
    return f"---\ntitle: {path.name}\n---\n# `{path}`\n\n{fenced(text, language)}"


def listing(folder: Path, line: Callable[[Path, str], str]) -> str:
    """Return a folder as a page: its files, each with the first line of its description."""
    path = folder.relative_to(ROOT)
    files = [line(path / "index.md", item) for item in _items(folder)]
    return f"# `{path}/`\n\n| file | |\n|---|---|\n" + "\n".join(files) + "\n"


def _items(folder: Path) -> Iterator[str]:
    for file in sorted(folder.iterdir()):
        if file.suffix == ".py":
            says = ast.get_docstring(ast.parse(file.read_text())) or ""
            yield f"| [{file.name}]({file.name}) | {says.partition(chr(10))[0].replace('``', '`')} |"
        elif file.suffix in {".lp", ".pl"}:
            yield f"| [{file.name}]({file.name}) | {file.read_text().partition(chr(10))[0].lstrip('%#! ')} |"


MADE: dict[str, Callable[[Path], str]] = {
    "docs/try.md": lambda _: (ROOT / "docs" / "builder" / "try.txt").read_text(),
    "docs/reference/schema.md": schema,
    "docs/reference/vitruvius.md": package("vitruvius", "Houses: make, check, explain, read and write them."),
    "docs/reference/sim.md": package(
        "vitruvius.sim",
        "Environments, tasks, baselines, backends.",
        "vitruvius.sim.actions",
        "vitruvius.sim.backends.backend",
    ),
    "docs/reference/agent.md": modules(
        "vitruvius.agent", "What programs of your own take from `agent`.", *AGENT
    ),
    "examples/first_steps.md": notebook(Path("examples/first_steps.ipynb")),
}
"""Pages by path; each function makes a page, and may write pictures into the folder that it gets."""
