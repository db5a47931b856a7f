"""Descriptions of tasks in words, which are the same in reports, tables, plots and games."""

import json
from collections.abc import Callable, Sequence
from dataclasses import fields

from vitruvius.logic.looks.looks import spaced
from vitruvius.logic.spelling import article, numbered
from vitruvius.sim.allowed import class_names
from vitruvius.sim.tasks.furniture import Habit, Object
from vitruvius.sim.tasks.remembering import Visit
from vitruvius.sim.tasks.tasks import (
    PAPER_TASKS,
    AnyTask,
    Collect,
    Order,
    Points,
    Reach,
    Roam,
    Rooms,
    Targets,
    at_once,
    task,
)
from vitruvius.sim.tasks.terms import Terms, terms_of


def in_words(targets: Targets, named: Callable[[str], str] = spaced) -> str:
    """Return a task as a phrase: "find a bed", "reach a kitchen", "targets in secondary rooms".

    ``named`` returns the name of a type. Text that names a class, or that is no task, is returned as it is:
    the function imports no class.
    """
    if isinstance(targets, str) and targets in PAPER_TASKS:
        return f"{in_words(targets.removeprefix('paper-'))}, paper's"
    given = _read(targets)
    if isinstance(given, dict) and (names := [*class_names({"terms": given.get("terms")})]):
        plain = {key: value for key, value in given.items() if key != "terms"}
        return f"{in_words(plain, named)}, terms {spaced(names[0].rpartition(':')[2])}"
    if any(class_names(given)):
        return _own(given)
    try:
        asked = task(given)
    except ValueError:
        return _own(given) if isinstance(given, dict) else str(given)
    words = _shipped(asked, named)
    several = f", {at_once(asked)} at once" if at_once(asked) > 1 else ""
    return words + several + _starts(asked, named) + _terms(asked) if words else _own(given)


def _shipped(asked: AnyTask, named: Callable[[str], str]) -> str:
    """Return one of our tasks in words; an empty text for another task."""
    match asked:
        case Collect(main=True, secondary=True):
            words = "targets in all rooms"
        case Collect(main=main):
            words = "targets in the main room" if main else "targets in secondary rooms"
        case Order(rooms=rooms):
            words = f"targets in rooms of type {', then '.join(named(room) for room in rooms)}"
        case Rooms(rooms=rooms):
            words = f"targets in rooms of type {_listed([named(room) for room in rooms], 'or')}"
        case Reach(room=room):
            words = f"reach {article(named(room))}"
        case Object(piece=piece):
            words = f"find {article(named(piece))}"
        case Habit(share=share, seed=seed):
            usual = Habit()
            said = [f"share {share:g}"] * (share != usual.share) + [f"seed {seed}"] * (seed != usual.seed)
            words = ", ".join(["targets in habitual places", *said])
        case Roam(terms=Visit(types=types)):
            names = _listed([named(room) for room in types], "and")
            words = f"visit rooms of type {names}" if types else "visit all rooms"
        case Roam():
            words = "no targets"
        case Points(points=points):
            order = ", in order" if asked.in_order else ""
            words = f"targets at {numbered(len(points), 'given place')}{order}"
        case _:
            words = ""
    return words


def _starts(asked: AnyTask, named: Callable[[str], str]) -> str:
    """Return the words for the rooms where episodes start, or no words for the main room or hub."""
    starts = getattr(asked, "starts", ())
    if starts == "all":
        return ", from all rooms"
    return f", from rooms of type {_listed([named(each) for each in starts], 'or')}" if starts else ""


def _terms(asked: AnyTask) -> str:
    """Return words for the terms that differ from plain terms, without the rooms to visit."""
    terms, words = terms_of(asked), []
    visits = isinstance(asked, Roam) and isinstance(terms, Visit)
    for each in fields(terms):
        value = getattr(terms, each.name)
        if value != each.default and not (visits and each.name == "types"):
            words.append(f"{spaced(each.name)} {value}")
    if type(terms) is not Terms and not visits:
        words.insert(0, f"terms {spaced(type(terms).__name__)}")
    return "".join(f", {each}" for each in words)


def _read(targets: Targets) -> Targets:
    """Return the dictionary of a JSON text; return anything else unchanged."""
    try:
        given = json.loads(targets) if isinstance(targets, str) else targets
    except (ValueError, RecursionError):
        return targets
    return given if isinstance(given, dict) else targets


def _own(targets: Targets) -> str:
    """Return a user's own task in words: its class, and its arguments."""
    if isinstance(targets, dict):
        arguments = [f"{spaced(name)} {value}" for name, value in targets.items() if name != "task"]
        return ", ".join([_own(str(targets.get("task"))), *arguments])
    name = targets if isinstance(targets, str) else type(targets).__name__
    return f"task {spaced(name.rpartition(':')[2])}"


def _listed(names: Sequence[str], last: str) -> str:
    return f" {last} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
