"""Page ``docs/arrays.md``: the arrays of the simulator. ``python -m vitruvius.sim.world.page`` prints it."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from vitruvius.sim.arrays import ArrayRow
from vitruvius.sim.config import Config
from vitruvius.sim.drive import Drive
from vitruvius.sim.parts import MEMORY, PARTS
from vitruvius.sim.world import arrays
from vitruvius.sim.world.kind import WorldKind
from vitruvius.sim.world.overlays import OVERLAYS

GROUPS = {
    "Houses": arrays.BANK,
    "State": arrays.STATE,
    "Overlays": tuple(row for overlay in OVERLAYS for row in overlay.ROWS),
    "Distances": arrays.DISTANCE,
    "Last state of an episode": arrays.LAST,
    "Actions and results": arrays.OUTPUTS,
    "Infos": arrays.SHOWN,
    "Options of a reset": arrays.OPTIONS,
}


def page() -> str:
    """Return the page, in Markdown."""
    tables = list[str]()
    for title, rows in GROUPS.items():
        tables += [f"## {title}", *_table(rows), ""]
    tables += ["## Sizes", "| size | number of |", "|---|---|"]
    tables += [f"| {letter} | {words} |" for letter, words in arrays.SIZES.items()]
    text = Path(__file__).with_name("arrays.md").read_text("utf-8")
    return text.replace("ARRAYS\n", "\n".join(tables) + "\n").replace("PARTS\n", "\n".join(_parts()) + "\n")


def _table(rows: Iterable[ArrayRow]) -> Iterator[str]:
    """Yield a table of arrays."""
    yield "| array | type | shape | unit | meaning | written by | read by |"
    yield "|---|---|---|---|---|---|---|"
    kinds = WorldKind(Config()), WorldKind(Config(drives=True, sees_kind=True))
    for row in rows:
        name = f"**`{row.name}`**" if row.saved else f"`{row.name}`"
        types = dict.fromkeys(str(row.type_of(kind)) for kind in kinds)
        shape = [*map(str, row.shape), *([] if row.width == 1 else [str(row.width)])]
        words = row.unit, row.meaning, row.written, row.read
        yield f"| {name} | {' or '.join(types)} | ({', '.join(shape)}) | {' | '.join(words)} |"


def _parts() -> Iterator[str]:
    """Yield the table of parts."""
    yield "| part | values | range | unit | meaning |"
    yield "|---|---|---|---|---|"
    drives = [Config(drive=Drive(sideways=sideways)) for sideways in (0.0, 0.5)]
    for name, part in PARTS.items():
        numbers = dict.fromkeys(str(config.numbers_of(name)) for config in drives)
        count = " or ".join(numbers) if name != MEMORY else "M"
        yield f"| `{name}` | {count} | {part.low:g} to {part.high:g} | {part.unit} | {part.meaning} |"


if __name__ == "__main__":
    print(page(), end="")
