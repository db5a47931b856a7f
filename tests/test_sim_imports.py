"""Imports run one way: logic <- sim <- agent, and sim takes little of logic."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
ALLOWED = {"House", "load", "generate"}


def imported(package: str) -> set[tuple[str, str]]:
    """(module, name) of everything that a package's files import."""
    found = set()
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {(alias.name, "") for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found |= {(node.module or "", alias.name) for alias in node.names}
    return found


@pytest.mark.parametrize(("package", "above"), [("logic", {"sim", "agent"}), ("sim", {"agent"})])
def test_no_package_imports_one_above_it(package, above):
    assert not {module for module, _ in imported(package) if module.split(".")[0] in above}


def test_sim_takes_of_logic_houses_and_nothing_else():
    taken = {(module, name) for module, name in imported("sim") if module.split(".")[0] == "logic"}
    assert {module for module, _ in taken} == {"logic"}
    assert {name for _, name in taken} <= ALLOWED


def test_taichi_is_imported_in_one_place():
    users = [path.name for path in (ROOT / "sim").glob("*.py") if "import taichi" in path.read_text()]
    assert users == ["runtime.py"]
