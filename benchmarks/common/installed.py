"""Packages that pip installs for each extra, and their sizes, from those of this environment.

Run ``./run setup`` and ``./run python -m benchmarks.common.installed`` for the table of ``docs/install.md``.
"""

from argparse import ArgumentParser
from collections.abc import Iterator
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

from vitruvius.logic.installation import EXTRAS, NAME


def required(package: Distribution, extra: str = "") -> Iterator[tuple[str, str]]:
    """Yield the requirements of a package with an extra on this system: a name and one of its extras."""
    for requirement in map(Requirement, package.requires or ()):
        if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
            yield from ((requirement.name, each) for each in {"", *requirement.extras})


def packages(ours: Distribution, extra: str = "") -> dict[str, Distribution]:
    """Return the packages that ``ours`` needs with an extra, by name, without ``ours``."""
    waiting, found = [(ours, ""), (ours, extra)], dict[tuple[str, str], Distribution]()
    while waiting:
        package, extra = waiting.pop()
        for name, each in required(package, extra):
            if (name, each) not in found:
                found[name, each] = ours if name == NAME else distribution(name)
                waiting.append((found[name, each], each))
    return {name: package for (name, _), package in found.items() if name != NAME}


def size(package: Distribution) -> int:
    """Return the size of a package's files in bytes, without compiled Python."""
    files = [Path(str(file.locate())) for file in package.files or () if file.suffix != ".pyc"]
    return sum(file.stat().st_size for file in files if file.is_file())


def table() -> str:
    """Return the table of the base, of all extras, and of all together, in Markdown."""
    ours = distribution(NAME)
    lines = ["| extra | packages | MB |", "|---|---|---|"]
    for extra in ("", *EXTRAS, "all"):
        if extra == "minigrid":  # It asks for pygame, whose place pygame-ce takes here.
            continue
        needed = {str(package.name): size(package) for package in packages(ours, extra).values()}
        lines.append(f"| {extra or 'none'} | {len(needed)} | {sum(needed.values()) / 1e6:,.0f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    ArgumentParser(description=__doc__).parse_args()
    print(table())
