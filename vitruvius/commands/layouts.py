"""Work of ``vitruvius generate --count-layouts``."""

import time
from typing import Any

from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import numbered
from vitruvius.logic.terminal import print_above, working


def count_layouts(command: Any) -> int:
    """Print the number of layouts of the rooms and of each type's furniture; return 4 if too many."""
    from vitruvius.answers.houses import Layouts
    from vitruvius.logic.workers.count import counted

    others = {"keep": command.keep, "plan": command.plan, "brief": command.brief, "shard": command.shard}
    for option, given in others.items():
        if given:
            raise RequestError(f"--count-layouts counts those of whole houses: leave out --{option}")
    if command.out:
        raise RequestError("--count-layouts makes no houses: leave out --out")
    request = command.request()
    first = begun = time.monotonic()
    numbers = list[Layouts]()
    with working() as show:

        def report(name: str, number: int) -> None:
            passed = time.monotonic() - begun
            show(f"{name}: {numbered(number, 'layout')} after {passed:.0f} s")

        for name, number, whole in counted(request, report):
            numbers.append(Layouts(name, number, whole))
            more = "" if whole else f"in {command.seconds:g} s, more than "
            if not command.json:
                print_above(f"{name}: {more}{number:,}")
            begun = time.monotonic()
            show("")
    if command.json:
        command.answer(request, time.monotonic() - first, counted=numbers)
    return 0 if all(each.exact for each in numbers) else 4
