"""The modules of ``logic`` import each other in one direction."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import logic

FOLDER = Path(logic.__file__).parent


def test_no_module_imports_itself_through_others() -> None:
    """Inside functions too; ``prepare`` raises ``CycleError`` with the circle."""
    imports = {}
    for file in FOLDER.glob("*.py"):
        nodes = [node for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.ImportFrom)]
        name = "logic" if file.stem == "__init__" else f"logic.{file.stem}"
        imports[name] = {node.module for node in nodes if (node.module or "").split(".")[0] == "logic"}
    assert imports["logic.generation.builder"]
    TopologicalSorter(imports).prepare()
