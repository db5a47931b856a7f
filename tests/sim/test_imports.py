"""Imports run one way: logic <- sim <- agent, and sim takes little of logic."""

import ast
from pathlib import Path

import pytest

import sim

ROOT = Path(__file__).parents[2]
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


def test_sim_imports_from_logic_only_houses_how_plans_draw_them_what_writes_files_and_the_hints_of_messages():
    taken = {(module, name) for module, name in imported("sim") if module.split(".")[0] == "logic"}
    assert {name for module, name in taken if module == "logic"} <= ALLOWED
    drawing = {
        "logic.drawing.canvas",
        "logic.drawing.labels",
        "logic.house.looks",
        "logic.drawing.palettes",
        "logic.drawing.plan",
    }
    assert {module for module, _ in taken} == {"logic", "logic.house.files", "logic.spelling", *drawing}
    users = {path.name for path in (ROOT / "sim").rglob("*.py") if "logic.drawing.plan" in path.read_text()}
    assert users == {"film.py"}


def test_taichi_is_imported_in_one_place():
    users = [path.name for path in (ROOT / "sim").rglob("*.py") if "import taichi" in path.read_text()]
    assert users == ["runtime.py"]


def test_the_public_names_are_these():
    """What needs a library that is not ours is imported by its own name: ``stable_baselines``."""
    tasks = ["Points", "Reach", "Rooms", "Task"]
    classes = ["Collect", "Config", "Cover", "FixedTask", "HouseEnv", "HouseVectorEnv", "Oracle", *tasks]
    functions = ["check_autoreset_modes", "check_vector_env", "shortest_path"]
    assert sim.__all__ == ["DEFAULT", "PAPER", *classes, *functions]
    assert all(hasattr(sim, name) for name in sim.__all__)
