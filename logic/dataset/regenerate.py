"""Regeneration of rows: the house that a row's columns and the rules give, compared with the row's hash."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from msgspec.structs import replace

from vitruvius.logic.dataset.formats import FILES, lines, read
from vitruvius.logic.dataset.parquet import MAX_FILE_BYTES
from vitruvius.logic.dataset.reading import HouseSet
from vitruvius.logic.dataset.rows import HOUSE, Columns, Row, columns_of, house_sha256
from vitruvius.logic.dataset.sets import SET, Set, read_set
from vitruvius.logic.errors import GrammarError, HouseFileError, LimitReached
from vitruvius.logic.grammar import Grammar, find, find_shipped
from vitruvius.logic.house.house import House
from vitruvius.logic.opener import DAMAGED, STANDARD, opened, reason
from vitruvius.logic.request.counts import whole
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.pool import outcomes


class Again(NamedTuple):
    """Row and its regenerated house or limit.

    ``differs`` is the difference in words, or None if they agree.
    """

    row: Columns
    made: House | LimitReached
    differs: str | None


def rows_of(path: Path) -> tuple[Iterator[Row], Set | None]:
    """Return the rows of a set's folder, of one of its files, or of a file elsewhere, and the set or None."""
    if (path / SET).is_file():
        houses = HouseSet(path)
        return houses.rows(), houses.of
    of = read_set(path.parents[1]) if len(path.parents) > 1 else None
    if path.suffix.removeprefix(".") == FILES[0]:
        return read(path), of
    return _lines(path), of


def _lines(path: Path) -> Iterator[Row]:
    with opened(path, MAX_FILE_BYTES) as file:
        yield from lines(file)


def regenerated(path: Path, places: Iterable[int] = (), grammar: str | None = None) -> Iterator[Again]:
    """Yield the rows at these indices (from 0), or all rows, each with its regenerated house.

    The rules are those of ``grammar``, a folder or a shipped name. Otherwise they are those that travel with
    the set, or else the shipped rules that the row names. Raises ``HouseFileError`` for a malformed row,
    ``GrammarError`` if the rules differ from those of the row, and the errors of ``generate``.
    """
    wanted = {whole("--row", place, 0) for place in places}
    kept: dict[tuple[str, str], HouseRequest] = {}
    number = -1
    try:
        found, of = rows_of(path)
        for number, row in enumerate(found):
            if wanted and number not in wanted:
                continue
            columns = columns_of(row)
            key = columns.grammar_hash, columns.request
            if key not in kept:
                limits = {"inferences": of.inferences, "seconds": of.seconds} if of else {}
                request = HouseRequest.read(columns.asked, **limits)
                if request.plan:
                    read_plan(request.plan)
                rules = _rules(columns, path, of, grammar)
                kept[key] = replace(request, grammar=str(rules.directory))
            [made] = outcomes(kept[key], columns.seed, range(columns.index, columns.index + 1))
            yield Again(columns, made, _differs(columns, made, of))
    except DAMAGED as error:
        raise HouseFileError(f"{path}: cannot be read: {reason(error)}") from None
    except ValueError as error:
        raise HouseFileError(f"{path}: row {max(number, 0)}: is not a row of a set: {error}") from None
    if number < 0:
        raise HouseFileError(f"{path}: holds no row of a set")
    if missing := [place for place in wanted if place > number]:
        raise HouseFileError(f"{path}: has rows 0 to {number}, not {missing[0]}")


def _rules(row: Columns, path: Path, of: Set | None, grammar: str | None) -> Grammar:
    if grammar is None and of is not None and of.grammar_hash == row.grammar_hash:
        return of.rules(path if path.is_dir() else path.parents[1])
    where = "" if path != STANDARD and grammar else ": name the folder of its rules with --grammar"
    try:
        rules = find(grammar) if grammar else find_shipped(row.grammar)
    except GrammarError as error:
        raise GrammarError(f"{error}{where}") from None
    if rules.hash != row.grammar_hash:
        raise GrammarError(f"these are not the rules that made {row.id}{where}", rules.directory)
    return rules


def _differs(row: Columns, made: House | LimitReached, of: Set | None) -> str | None:
    """Return the difference between a regenerated house and its row in words, or None if they agree."""
    if isinstance(made, LimitReached):
        return f"{row.id}: {made}" if row.verdict == HOUSE else None
    digest = house_sha256(made)
    if digest == row.sha256:
        return None
    assert made.provenance
    here = made.provenance.versions
    others = [f"{name} {old}, here {here.get(name)}" for name, old in (of.versions if of else {}).items()]
    others = [each for each in others if len(set(each.split(" ", 1)[1].split(", here "))) == 2]
    by = f": it was made by {', '.join(others)}" if others else ""
    return f"{row.id}: the house differs from that of the row ({digest[:12]}, not {str(row.sha256)[:12]}){by}"
