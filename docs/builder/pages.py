"""Pages that are made from code when the site is built, so that they cannot drift from it."""

import ast
import io
import json
import os
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parents[2]
WIDTH = "84"
"""Characters of a line of help: what a block of code shows without a scroll bar."""

AGENT = (
    *("agent.world", "agent.actions", "agent.avoidance", "agent.policies", "agent.checkpoint", "agent.banks"),
    *("agent.config", "agent.evaluation.episodes", "agent.evaluation.protocol", "agent.evaluation.result"),
)
"""What programs of a user's own take from ``agent``, as those in ``examples/`` do."""


def fenced(text: str, language: str = "text") -> str:
    """A block of code, whatever fences it has in it."""
    return f"````{language}\n{text.strip()}\n````\n"


def commands(_: Path) -> str:
    """The help of every command and of every study."""
    from agent.cli import COMMANDS
    from benchmarks import STUDIES

    page = ["# Commands", "This page is the output of `--help`; `./run` and `vitruvius` take the same.", ""]
    page += [fenced(_help())]
    for name in COMMANDS:
        page += [f"## {name}", fenced(_help(name))]
        if name == "bench":
            page += [f"### bench {study}\n{fenced(_help(name, study))}" for study in STUDIES]
    return "\n".join(page)


def _help(*words: str) -> str:
    """What a command prints when it is asked for help."""
    from agent.cli import main

    said = io.StringIO()
    os.environ["COLUMNS"] = WIDTH
    with redirect_stdout(said):
        try:
            main([*words, "--help"])
        except SystemExit as end:
            assert not end.code, f"{words} --help ended with {end.code}"
    return said.getvalue()


def schema(_: Path) -> str:
    """The JSON Schema of a house, a table for each of its objects."""
    objects = json.loads((ROOT / "docs" / "house.schema.json").read_text())["$defs"]
    page = ["# Schema of house files", "", "This page is made of [house.schema.json](../house.schema.json), which"]
    page += ["`vitruvius schema` prints. What the fields mean: [house files](../house-file.md).", ""]
    for name in sorted(objects, key=lambda name: name != "House"):
        page += [f"## {name}", "", _words(objects[name]["description"]), ""]
        page += ["| field | is | |", "|---|---|---|"]
        for field, kind in objects[name]["properties"].items():
            page.append(f"| `{field}` | {_kind(kind)} | {_default(field, kind, objects[name])} |")
        page.append("")
    return "\n".join(page)


def _words(docstring: str) -> str:
    return " ".join(docstring.split()).replace("``", "`")


def _default(field: str, kind: dict[str, Any], owner: dict[str, Any]) -> str:
    return "required" if field in owner["required"] else f"by default `{json.dumps(kind['default'])}`"


def _kind(kind: dict[str, Any]) -> str:
    """What a value may be, in words."""
    if "$ref" in kind:
        name = kind["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "anyOf" in kind:
        return " or ".join(_kind(each) for each in kind["anyOf"])
    if "enum" in kind:
        return " or ".join(f"`{json.dumps(value)}`" for value in kind["enum"])
    if "prefixItems" in kind:
        return f"a list of {len(kind['prefixItems'])}: {' and '.join(map(_kind, kind['prefixItems']))}"
    if kind["type"] == "array":
        return f"a list of {_kind(kind['items'])}{_bounds(kind, 'minItems', 'maxItems')}"
    if kind.get("additionalProperties"):
        return f"an object of {_kind(kind['additionalProperties'])} by name"
    if "pattern" in kind:
        return f"a string: `{kind['pattern']}`, at most {kind['maxLength']} characters"
    article = "an" if kind["type"][0] in "aeiou" else "a"
    nothing = {"null": "`null`"}.get(kind["type"])
    return nothing or f"{article} {kind['type']}{_bounds(kind, 'minimum', 'maximum')}"


def _bounds(kind: dict[str, Any], least: str, most: str) -> str:
    if most not in kind:
        return ""
    return f", {kind[least]:g} to {kind[most]:g}" if least in kind else f", {kind[most]:g} at most"


def package(name: str, modules: tuple[str, ...], about: str) -> Callable[[Path], str]:
    """The docstrings of a package's public interface."""
    return lambda _: "\n\n".join([f"# Python: {name}", about, *(f"::: {module}" for module in modules), ""])


def notebook(path: Path) -> Callable[[Path], str]:
    """A notebook that is run from top to bottom while the site is built, as a page with its pictures."""

    def page(folder: Path) -> str:
        cells = enumerate(executed(ROOT / path).cells)
        text = "".join(_cell(number, cell, folder) for number, cell in cells)
        return text.replace("\n", f"\n\nThis page is [a notebook]({path.name}), run when the site was built.\n", 1)

    return page


def executed(path: Path) -> Any:
    """A notebook with the outputs of all its cells, which ran in a folder of their own; fails where one does."""
    import nbformat
    from jupyter_client import AsyncKernelManager
    from nbclient import NotebookClient

    cells = nbformat.read(path, as_version=4)
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    with TemporaryDirectory() as folder:
        # Through sockets in the folder: no port, on which others might listen.
        kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=f"{folder}/kernel")
        return NotebookClient(cells, km=kernel, timeout=300, resources={"metadata": {"path": folder}}).execute()


def _cell(number: int, cell: Any, folder: Path) -> str:
    """A cell as Markdown; its pictures become files in the folder."""
    if cell.cell_type == "markdown":
        return f"{cell.source}\n\n"
    outputs = (_output(f"cell-{number}-{each}", output, folder) for each, output in enumerate(cell.outputs))
    return fenced(cell.source, "python") + "\n" + "".join(outputs)


def _output(name: str, output: Any, folder: Path) -> str:
    """What a cell shows, of all its forms the one that pages show best."""
    data = output.get("data", {})
    pictures = {"image/svg+xml": "svg", "image/png": "png"}
    for kind in data.keys() & pictures.keys():
        file = folder / f"{name}.{pictures[kind]}"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data[kind].encode() if kind == "image/svg+xml" else b64decode(data[kind]))
        return f"![What the cell shows]({file.name})\n\n"
    if "text/html" in data:
        return f"<div>{data['text/html']}</div>\n\n"
    return fenced(output.get("text") or data.get("text/plain", "")) + "\n"


def source(path: Path, text: str) -> str:
    """A file of code as a page."""
    language = {".lp": "prolog", ".pl": "prolog", ".py": "python", ".toml": "toml"}[path.suffix]
    return f"---\ntitle: {path.name}\n---\n# `{path}`\n\n{fenced(text, language)}"


def listing(folder: Path, line: Callable[[Path, str], str]) -> str:
    """A folder as a page: its files and what each says of itself."""
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
    "docs/reference/commands.md": commands,
    "docs/reference/schema.md": schema,
    "docs/reference/logic.md": package("logic", ("logic",), "Houses: make, check, explain, read and write them."),
    "docs/reference/sim.md": package("sim", ("sim", "sim.backend"), "Environments, tasks, backends."),
    "docs/reference/agent.md": package("agent", AGENT, "What programs of your own take from `agent`."),
    "docs/tutorials/first_house.md": notebook(Path("docs/tutorials/first_house.ipynb")),
}
"""By path: the page, made for a folder into which pictures may go."""
