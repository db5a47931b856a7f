"""Rows made again: the house that a row's columns and the rules give, beside the hash that the row has."""

from collections.abc import Iterable, Iterator
from gzip import GzipFile
from pathlib import Path
from typing import BinaryIO, NamedTuple

import msgspec

from logic.dataset.formats import FILES, read
from logic.dataset.reading import HouseSet
from logic.dataset.rows import HOUSE, Row, house_sha256
from logic.dataset.sets import SET, Set, read_set
from logic.errors import GrammarError, HouseFileError, LimitReached
from logic.grammar import Grammar, find
from logic.house.files import MOST_BYTES
from logic.house.house import House
from logic.opener import STANDARD, opened
from logic.workers.series import HouseSeries

INFERENCES, SECONDS = 100_000_000, 60.0
"""Most for a house, where no set says."""


class Again(NamedTuple):
    """A row, and what came of it: its house or limit; None where that is the row's, else in words why not."""

    row: Row
    made: House | LimitReached
    differs: str | None


def rows_of(path: Path) -> tuple[Iterator[Row], Set | None]:
    """The rows of a set's folder, of one of its files, or of a file of rows elsewhere, and the set."""
    if (path / SET).is_file():
        houses = HouseSet(path)
        return houses.rows(), houses.of
    of = read_set(path.parents[1]) if len(path.parents) > 1 else None
    if path.suffix.removeprefix(".") == FILES[0]:
        return read(path), of
    return _lines(opened(path, MOST_BYTES)), of


def _lines(file: BinaryIO | GzipFile) -> Iterator[Row]:
    with file:
        for line in file:
            yield msgspec.json.decode(line, type=Row)


def regenerated(path: Path, places: Iterable[int] = (), grammar: str | None = None) -> Iterator[Again]:
    """The rows of these places, from 0, or all, each made again.

    The rules are those of ``grammar``, a folder or a shipped one's name, else those that travel with the set,
    else the shipped ones that the row names. Raises ``HouseFileError`` for what is no row, ``GrammarError``
    where the rules are not those that made it, and what ``generate`` raises.
    """
    wanted = set(places)
    kept: dict[tuple[str, str], HouseSeries] = {}
    number = -1
    try:
        found, of = rows_of(path)
        for number, row in enumerate(found):
            if wanted and number not in wanted:
                continue
            key = row["grammar_hash"], row["request"]
            if key not in kept:
                rules = _rules(row, path, of, grammar)
                limits = (of.inferences, of.seconds) if of else (INFERENCES, SECONDS)
                kept[key] = HouseSeries(rules, msgspec.json.decode(row["request"]), *limits)
            index = int(row["index"])
            [made] = kept[key].outcomes(int(row["seed"]), range(index, index + 1))
            yield Again(row, made, _differs(row, made, of))
    except OSError as error:
        raise HouseFileError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (KeyError, TypeError, ValueError) as error:
        raise HouseFileError(f"{path}: row {max(number, 0)}: is no row of a set: {error}") from None
    if missing := [place for place in wanted if not 0 <= place <= number]:
        raise HouseFileError(f"{path}: has rows 0 to {number}, not {missing[0]}")


def _rules(row: Row, path: Path, of: Set | None, grammar: str | None) -> Grammar:
    if grammar is None and of is not None and of.grammar_hash == row["grammar_hash"]:
        return of.rules(path if path.is_dir() else path.parents[1])
    where = "" if path != STANDARD and grammar else ": say by --grammar where its rules are"
    try:
        rules = find(grammar or row["grammar"])
    except GrammarError as error:
        raise GrammarError(f"{error}{where}") from None
    if rules.hash != row["grammar_hash"]:
        raise GrammarError(f"these are not the rules that made {row['id']}{where}", rules.directory)
    return rules


def _differs(row: Row, made: House | LimitReached, of: Set | None) -> str | None:
    """Why what was made is not the row's; None where it is."""
    if isinstance(made, LimitReached):
        return f"{row['id']}: {made}" if row["verdict"] == HOUSE else None
    digest = house_sha256(made)
    if digest == row["sha256"]:
        return None
    assert made.provenance
    here = made.provenance.versions
    others = [f"{name} {old}, here {here.get(name)}" for name, old in (of.versions if of else {}).items()]
    others = [each for each in others if len(set(each.split(" ", 1)[1].split(", here "))) == 2]
    by = f": it was made by {', '.join(others)}" if others else ""
    return f"{row['id']}: another house than the row's ({digest[:12]}, not {str(row['sha256'])[:12]}){by}"
