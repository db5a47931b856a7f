"""Imports run one way: between packages, between the folders of each, and without a cycle of modules."""

import ast
import re
import sys
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import vitruvius
import vitruvius.logic
from tests.programs import finished
from vitruvius import environments, sim
from vitruvius.sim.environment.arguments import BACKENDS
from vitruvius.sim.tracing import COMPILERS

ROOT = Path(__file__).parents[1]

PACKAGES = ("logic", "sim", "agent", "vitruvius", "benchmarks")
"""Packages from the lowest up: a package imports only those before it."""

FOLDERS = {
    "logic": (
        *(
            "encoding",
            "installation",
            "opener",
            "spelling",
            "mismatch",
            "errors",
            "plain",
            "stopping",
            "copies",
            "includes",
            "grammar",
            "terminal",
            "cluster",
        ),
        *(
            "house",
            "looks",
            "files",
            "checking",
            "shapes",
            "readers",
            "request",
            "layout",
            "placement",
            "language",
            "generation",
            "proofs",
            "why",
        ),
        *("workers", "dataset", "drawing", "exports", "browser"),
    ),
    "sim": (
        *(
            "cache",
            "allowed",
            "actions",
            "fields",
            "drive",
            "parts",
            "config",
            "compiler",
            "tracing",
            "huge_pages",
            "runtime",
            "arrays",
            "geometry",
            "film",
        ),
        *("backends", "tasks", "world", "environment", "oracle", "adapters"),
    ),
    "agent": (
        *("avoidance", "progress", "banks"),
        *(
            "planner",
            "policies",
            "learning",
            "baselines",
            "algorithms",
            "runs",
            "evaluation",
            "recording",
            "play",
            "report",
        ),
    ),
}
"""Folders and modules at the top of each package, from the lowest up: each imports only those before it."""

PLANNER = (
    *("core", "mapping", "viewpoints", "paths", "goal", "step", "setup", "lattice", "driving", "planner"),
    *("belief_map", "local_map", "map_window"),
)
"""Folders and modules of ``agent.planner``, from the lowest up."""

OF_LOGIC = {"House", "generate", "load"}
"""Public names of ``logic`` that the simulator imports."""

DRAWN = {"canvas", "frame", "labels", "palettes"}
"""Modules with which the simulator draws episodes."""


@cache
def modules() -> dict[str, Path]:
    """Return the files of our packages, by module name."""
    found = {}
    for file in (file for package in PACKAGES for file in (ROOT / package).rglob("*.py")):
        parts = file.relative_to(ROOT).with_suffix("").parts
        name = ".".join(parts if parts[0] in ("benchmarks", "vitruvius") else ("vitruvius", *parts))
        found[name.removesuffix(".__init__")] = file
    return found


def place(name: str) -> tuple[str, str]:
    """Return the package of a module, and the folder or module at the top of that package."""
    first, *parts = name.split(".")
    if first == "vitruvius" and parts and parts[0] in PACKAGES:
        first, *parts = parts
    return first, parts[0] if parts else ""


@cache
def named(file: Path) -> tuple[frozenset[str], frozenset[str]]:
    """Return the modules of our packages that a file imports, and those that it names in strings.

    Imports count inside functions, too. A table of commands or sections names modules in strings:
    ``"vitruvius.agent.report.plans:section"``.
    """
    known, imported, said = modules(), set[str](), set[str]()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names if alias.name in known}
        elif isinstance(node, ast.ImportFrom) and node.module in known:
            for alias in node.names:
                within = f"{node.module}.{alias.name}"
                imported.add(within if within in known else node.module)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            name, colon, _ = node.value.partition(":")
            if colon and name in known:
                said.add(name)
    return frozenset(imported), frozenset(said)


@cache
def graph(strings: bool = True) -> dict[str, frozenset[str]]:
    """Return the modules of ours that each module imports, and with ``strings`` those that it names."""
    found = {name: named(file) for name, file in modules().items()}
    return {
        name: (imported | said if strings else imported) - {name} for name, (imported, said) in found.items()
    }


def test_no_module_imports_itself_through_others() -> None:
    """``prepare`` raises ``CycleError`` with the cycle. A table may name what reads it."""
    assert "vitruvius.logic.generation.builder" in graph()["vitruvius.logic.workers.worker"]
    TopologicalSorter(graph(strings=False)).prepare()


def test_no_package_imports_one_above_it() -> None:
    upwards = [
        (name, other)
        for name, others in graph().items()
        for other in others
        if PACKAGES.index(place(other)[0]) > PACKAGES.index(place(name)[0])
    ]
    assert not upwards


@pytest.mark.parametrize("package", FOLDERS)
def test_no_folder_imports_one_above_it(package: str) -> None:
    order = FOLDERS[package]
    inside = {name: folder for name in graph() for of, folder in [place(name)] if of == package and folder}
    assert {*inside.values()} == {*order}
    upwards = [
        (name, other)
        for name, folder in inside.items()
        for other in graph()[name]
        if place(other) == (package, "")
        or (other in inside and order.index(inside[other]) > order.index(folder))
    ]
    assert not upwards


def test_the_folders_of_the_planner_import_one_way() -> None:
    prefix = "vitruvius.agent.planner."
    inside = {name: name.removeprefix(prefix).split(".")[0] for name in graph() if name.startswith(prefix)}
    assert {*inside.values()} == {*PLANNER}
    assert not [
        (name, other)
        for name, folder in inside.items()
        for other in graph()[name]
        if other in inside and PLANNER.index(inside[other]) > PLANNER.index(folder)
    ]


def test_the_simulator_takes_houses_of_logic_and_draws_by_its_plans() -> None:
    taken = {
        (name, node.module, alias.name)
        for name, file in modules().items()
        if place(name)[0] == "sim"
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("vitruvius.logic")
        for alias in node.names
    }
    assert {what for _, module, what in taken if module == "vitruvius.logic"} <= OF_LOGIC
    drawing = {f"vitruvius.logic.drawing.{each}" for each in DRAWN}
    others = {
        "vitruvius.logic",
        "vitruvius.logic.errors",
        "vitruvius.logic.installation",
        "vitruvius.logic.files.writing",
        "vitruvius.logic.looks.looks",
        "vitruvius.logic.spelling",
    }
    assert {module for _, module, _ in taken} == drawing | others
    assert {name for name, module, _ in taken if module in drawing} == {"vitruvius.sim.film"}


def test_a_folder_has_one_sentence_and_about_a_dozen_modules() -> None:
    for package, folders in FOLDERS.items():
        for folder in folders:
            init = ROOT / package / folder / "__init__.py"
            if init.parent.is_dir():
                assert ast.get_docstring(ast.parse(init.read_text())), init
                assert len([*init.parent.glob("*.py")]) <= 18, init.parent


@pytest.mark.parametrize("name", COMPILERS)
def test_a_compiler_is_imported_in_one_place(name: str) -> None:
    users = [
        path.relative_to(ROOT)
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if re.search(rf"^ *(import|from) {name}\b", path.read_text(), re.M)
    ]
    files = {"taichi": ["patches.py", "taichi.py"]}.get(name, [f"{name}.py"])
    assert sorted(users) == [Path("sim/compiler", file) for file in files]


def test_the_package_has_the_public_names_of_logic_and_the_environments_of_the_simulator() -> None:
    assert vitruvius.__all__ == vitruvius.logic.__all__
    assert all(getattr(vitruvius, name) is getattr(vitruvius.logic, name) for name in vitruvius.__all__)
    assert list(environments.BACKENDS) == list(BACKENDS)


def test_environments_are_registered_also_after_a_search_for_gymnasium_alone() -> None:
    code = (
        "import vitruvius; from importlib.util import find_spec; find_spec('gymnasium'); import gymnasium; "
    )
    code += "import sys; print('Vitruvius/House-v0' in gymnasium.registry, 'taichi' in sys.modules)"
    assert finished([sys.executable, "-P", "-c", code]).stdout == "True False\n"


def test_the_public_names_of_the_simulator_are_these() -> None:
    """A module that needs another library is imported by its full name."""
    houses = ["HouseEnv", "HouseRotation", "HouseVectorEnv"]
    tasks = ["Points", "Reach", "Rooms", "Task"]
    classes = ["Collect", "Config", "FixedTask", *houses, "Oracle", *tasks]
    functions = ["allow", "shortest_path"]
    assert sim.__all__ == ["DEFAULT", "PAPER", *classes, *functions]
    assert all(hasattr(sim, name) for name in sim.__all__)
