"""Work of ``vitruvius generate --count-layouts``."""

import time
from typing import Any

from rich.progress import TextColumn

from vitruvius.commands.common import counts
from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import numbered
from vitruvius.logic.terminal import progress_bar


def count_layouts(command: Any) -> int:
    """Print the number of layouts of the rooms and of each type's furniture; return 4 if too many."""
    from vitruvius.answers.houses import Layouts
    from vitruvius.logic import count_layouts as layouts

    for option, given in (("--keep", command.keep), ("--plan", command.plan), ("--brief", command.brief)):
        if given:
            raise RequestError(f"--count-layouts counts those of whole houses: leave out {option}")
    if (rooms := command.number_of_rooms()) is None:
        raise RequestError("--count-layouts counts those of some rooms: say how many, as in --rooms 6")
    if command.out:
        raise RequestError("--count-layouts makes no houses: leave out --out")
    first = begun = time.monotonic()
    counted = list[Layouts]()
    with progress_bar(TextColumn("{task.description}")) as bar:
        task = bar.add_task("")

        def report(name: str, number: int) -> None:
            passed = time.monotonic() - begun
            bar.update(task, description=f"{name}: {numbered(number, 'layout')} after {passed:.0f} s")

        for name, number, whole in layouts(
            rooms,
            types=counts("--type", command.type),
            furniture=counts("--piece", command.piece),
            grammar=command.grammar or "family",
            seconds=command.seconds,
            report=report,
        ):
            counted.append(Layouts(name, number, whole))
            more = "" if whole else f"in {command.seconds:g} s, more than "
            if not command.json:
                print(f"{name}: {more}{number:,}", flush=True)
            begun = time.monotonic()
            bar.update(task, description="")
    if command.json:
        command.answer(time.monotonic() - first, counted=counted)
    return 0 if all(each.exact for each in counted) else 4
