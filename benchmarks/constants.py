"""The numbers of the agent's map by name, to be set before its kernel is compiled."""

import ast
import importlib
import inspect
import pkgutil
from types import ModuleType

import agent.planner
from logic.errors import RequestError
from logic.spelling import closest

MODULES: dict[str, ModuleType] = {"map": agent.planner} | {
    each.name: importlib.import_module(f"agent.planner.{each.name}")
    for each in pkgutil.iter_modules(agent.planner.__path__)
}
"""By their last names."""

_TREES = {name: ast.parse(inspect.getsource(module)).body for name, module in MODULES.items()}


def _known() -> dict[str, float]:
    """The modules' numbers by ``module.NAME``, but for those that other constants were made of on import."""
    names = [
        (short, node)
        for short, tree in _TREES.items()
        for statement in tree
        if isinstance(statement, ast.Assign | ast.AnnAssign)
        for node in ast.walk(statement)
        if isinstance(node, ast.Name)
    ]
    used = {node.id for _, node in names if isinstance(node.ctx, ast.Load)}
    return {
        f"{short}.{node.id}": value
        for short, node in names
        if isinstance(node.ctx, ast.Store) and node.id not in used
        if isinstance(value := vars(MODULES[short]).get(node.id), int | float)
    }


KNOWN = _known()


def constants(text: str) -> dict[str, float]:
    """The numbers of ``THOUGHT=48,views.PLENTY=300`` by ``module.NAME``; a whole one stays whole.

    Raises ``RequestError`` for an unknown name, one that several modules have, or what is no number.
    """
    found = {}
    for each in text.split(","):
        name, _, value = each.strip().partition("=")
        places = [place for place in KNOWN if name in (place, place.partition(".")[2])]
        if not places:
            near = closest(name, [*KNOWN, *(place.partition(".")[2] for place in KNOWN)])
            raise RequestError(
                f"--set {text}: {name or 'nothing'} is no number of agent.planner that can be set"
                + (f". Did you mean {near}?" if near else "")
            )
        if len(places) > 1:
            raise RequestError(f"--set {text}: there is more than one {name}. Say {' or '.join(places)}")
        (place,) = places
        try:
            found[place] = type(KNOWN[place])(value)
        except ValueError:
            raise RequestError(
                f"--set {text}: {name} needs a number such as it has, {KNOWN[place]}, not {value!r}"
            ) from None
    return found


def change(numbers: dict[str, float]) -> None:
    """Set numbers by ``module.NAME``, there and in the modules that import them from there."""
    for place, number in numbers.items():
        short, _, name = place.partition(".")
        home = MODULES[short]
        setattr(home, name, number)
        for other, tree in _TREES.items():
            for statement in tree:
                if isinstance(statement, ast.ImportFrom) and statement.module == home.__name__:
                    for alias in statement.names:
                        if alias.name == name:
                            setattr(MODULES[other], alias.asname or name, number)
