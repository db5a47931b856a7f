"""``vitruvius bench watch``: seconds from the save of a rule file until the page has all houses."""

import http.client
import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from urllib.parse import SplitResult, urlsplit

from benchmarks.common.pages import machine
from vitruvius.logic.errors import RequestError
from vitruvius.logic.grammar import find

LONGEST = 120.0
"""Longest time for an answer, in seconds."""


@dataclass(frozen=True)
class WatchStudy:
    """Save a rule file of a copied grammar again and again, and ask for the sheet as the page does.

    The browser's time to show the plans comes on top: some hundredths of a second.
    """

    grammar: str = "family"
    """Name of a shipped grammar, or a directory of rules."""

    rooms: int = 4
    """Number of secondary rooms."""

    houses: int = 9
    """Number of houses of the sheet."""

    saves: int = 20
    """Number of saves."""

    pause: float = 3.0
    """Seconds between a sheet and the next save, in which spare processes start."""

    def run(self) -> None:
        """Print the median and the range, for the first house and for all."""
        if self.saves < 1:
            raise RequestError("--saves must be 1 or more")
        request = {"rooms": self.rooms, "seed": 0, "count": self.houses}
        with TemporaryDirectory() as folder, _watching(Path(folder), self.grammar) as (file, address):
            rules, text = _rules(address), file.read_text()
            taken = [
                self._save(file, f"{text}% {each}\n", rules, address, request)
                for each in range(self.saves + 1)
            ]
        # During the first save, the page's files and fonts are not loaded yet.
        for what, seconds in zip(
            ("first house", f"{self.houses} houses"), zip(*taken[1:], strict=True), strict=True
        ):
            least, most = min(seconds), max(seconds)
            print(
                f"{what}: median {median(seconds):.2f} s, {least:.2f} to {most:.2f} s, of {self.saves} saves"
            )
        print(f"{self.grammar}, {self.rooms} rooms; {machine()}")

    def _save(
        self, file: Path, text: str, rules: Iterator[int], address: SplitResult, request: dict[str, int]
    ) -> tuple[float, float]:
        """Return the seconds from a save to the first house and to the last."""
        time.sleep(self.pause)
        begun = time.perf_counter()
        file.write_text(text)
        question = {"version": next(rules), "request": request}
        connection = _connection(address)
        connection.request("POST", f"{address.path}sheet", json.dumps(question))
        at = [time.perf_counter() - begun for line in connection.getresponse() if b'"svg"' in line]
        if len(at) != self.houses:
            raise RequestError(
                f"{self.grammar}: {len(at)} of {self.houses} houses were made: generate gives the reason"
            )
        return at[0], at[-1]


def _rules(address: SplitResult) -> Iterator[int]:
    """Yield the versions of the rules after the first, as they arrive."""
    connection = _connection(address)
    connection.request("GET", f"{address.path}events")
    lines = (line for line in connection.getresponse() if line.startswith(b"data: "))
    next(lines)
    return (json.loads(line.removeprefix(b"data: "))["version"] for line in lines)


def _connection(address: SplitResult) -> http.client.HTTPConnection:
    return http.client.HTTPConnection(address.hostname or "", address.port, timeout=LONGEST)


@contextmanager
def _watching(folder: Path, grammar: str) -> Iterator[tuple[Path, SplitResult]]:
    """Run the command on a copy of a grammar. Yield one of its rule files, and the page's address."""
    rules = find(grammar)
    copy = Path(shutil.copytree(rules.directory, folder / rules.name))
    command = [sys.executable, "-m", "vitruvius.cli", "watch", str(copy)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr
        found = next(filter(None, (re.search(r"http://\S+", line) for line in process.stderr)))
        try:
            yield copy / rules.own[-1].name, urlsplit(found[0])
        finally:
            process.terminate()
