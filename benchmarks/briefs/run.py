"""``vitruvius bench brief``: the frozen briefs, answered by us or by another generator, scored and timed."""

import shlex
import subprocess
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import msgspec

from benchmarks.briefs.attempts import Attempt, attempt, within
from benchmarks.briefs.bank import HASH, BriefEntry, Kind, frozen
from benchmarks.briefs.page import Results, page
from benchmarks.briefs.proofs import needed
from benchmarks.briefs.score import Answer, judged_all, read_answers, score
from benchmarks.common.pages import write
from benchmarks.common.processes import say
from vitruvius.logic.errors import RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.request.brief import Brief, alone

KINDS: tuple[Kind, ...] = ("house", "dissection", "changed", "impossible")

ALONE = "plain"
"""Grammar of a brief without any other rules."""


WARM = 12
"""Number of furnished houses that are made before any is timed."""


@dataclass(frozen=True)
class BriefStudy:
    """Answer the frozen briefs and score the answers, or score the answers of another generator."""

    answers: Path | None = None
    """File of answers to score, JSON Lines as in docs/brief-bank.md; the study then does nothing else."""

    briefs: Path | None = None
    """File for the briefs, JSON Lines with a name and the brief; the study then does nothing else."""

    kinds: tuple[Kind, ...] = KINDS
    """Kinds of briefs to answer."""

    rooms: tuple[int, ...] = (5, 8, 10, 12, 16)
    """Numbers of rooms of the briefs to answer."""

    each: int = 1000
    """Largest number of briefs of each kind and number of rooms."""

    houses: int = 2
    """Number of houses of each brief, to count different plans; the first one is timed and judged."""

    seconds: int = 60
    """Processor seconds for each brief."""

    proofs: bool = True
    """Leave out each line of each proof in turn, to see if it is needed."""

    peer: str = ""
    """Command that reads briefs and writes answers, both JSON Lines, for a comparison in the same run."""

    peer_each: int = 4
    """Number of briefs of each kind and number of rooms that go to the peer."""

    out: Path = Path("runs/bench")
    """Folder for brief.json, brief-answers.jsonl and brief-bank.md."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    publish: bool = False
    """Copy the page, with its pictures and data, into docs."""

    def run(self) -> None:
        """Answer the briefs, score the answers, and write the page."""
        if self.each < 1 or self.houses < 1 or self.seconds < 1 or self.peer_each < 1:
            raise RequestError("--each, --houses, --seconds and --peer-each are 1 or more")
        bank = self._chosen(frozen(), self.each)
        if self.briefs:
            write_whole(self.briefs, b"".join(map(question, bank)))
        elif self.answers:
            print(
                msgspec.json.format(
                    msgspec.json.encode(score(judged_all(bank, read_answers(self.answers))))
                ).decode()
            )
        else:
            self._measured(bank)

    def _chosen(self, bank: Iterable[BriefEntry], each: int) -> list[BriefEntry]:
        """Return the briefs of these kinds and numbers of rooms.

        Of each group there are at most ``each``, evenly spread over the group.
        """
        groups: dict[tuple[str, int], list[BriefEntry]] = {}
        for entry in bank:
            if entry.kind in self.kinds and entry.rooms in self.rooms:
                groups.setdefault((entry.kind, entry.rooms), []).append(entry)
        return [
            some[place * len(some) // min(each, len(some))]
            for some in groups.values()
            for place in range(min(each, len(some)))
        ]

    def _measured(self, bank: list[BriefEntry]) -> None:
        found = Results()
        builder = warm(ALONE, bank[:1])
        for entry in bank:
            brief = alone(entry.read)
            found.attempts[entry.name] = self._tried(partial(attempt, builder, brief, self.houses))
            say(f"{entry.name}: {in_words(found.attempts[entry.name])}")
            self._write(bank, found)
        for entry in bank if self.proofs else ():
            because, brief = found.attempts[entry.name].because, alone(entry.read)
            if because is not None:
                found.proofs[entry.name] = needed(brief, because, partial(self._of_fewer, builder))
                say(f"{entry.name}: {found.proofs[entry.name]} of its proof")
        if self.peer:
            some = self._chosen(bank, self.peer_each)
            told = {each.brief: each for each in asked(self.peer, some)}
            found.peer = {each.entry.name: each for each in judged_all(some, told.values())}
        self._write(bank, found)
        if furnishable := [entry for entry in bank if entry.grammar]:
            (grammar,) = {entry.grammar for entry in furnishable}
            builder = warm(grammar, furnishable[:WARM])  # SWI-Prolog holds one grammar at a time
            for entry in furnishable:
                found.furnished[entry.name] = self._tried(partial(attempt, builder, entry.read))
                say(f"{entry.name}, furnished: {in_words(found.furnished[entry.name])}")
        self._write(bank, found)
        text = page(bank, found, self._command())
        write({"brief-bank.md": text.encode()}, self.out, self.publish)
        print(text)

    def _of_fewer(self, builder: Builder, brief: Brief) -> Attempt:
        return self._tried(partial(attempt, builder, brief))

    def _tried(self, work: Callable[[], Attempt]) -> Attempt:
        return within(self.seconds, work)

    def _write(self, bank: Sequence[BriefEntry], found: Results) -> None:
        """Write the results so far."""
        answers = [found.attempts[entry.name].answer(entry) for entry in bank if entry.name in found.attempts]
        found.judged = judged_all(bank[: len(answers)], answers)
        lines = b"".join(msgspec.json.encode(answer) + b"\n" for answer in answers)
        write_whole(self.out / "brief-answers.jsonl", lines)
        record = {"bank": HASH, "score": score(found.judged), "proofs": found.proofs}
        record |= {
            key: {name: msgspec.structs.replace(each, houses=()) for name, each in some.items()}
            for key, some in (("attempts", found.attempts), ("furnished", found.furnished))
        }
        record["peer"] = {name: (each.said, each.right, each.seconds) for name, each in found.peer.items()}
        write_whole(self.out / "brief.json", msgspec.json.encode(record))

    def _command(self) -> str:
        default = BriefStudy()
        changed = [
            f" --{name} {' '.join(map(str, getattr(self, name)))}"
            for name in ("kinds", "rooms")
            if getattr(self, name) != getattr(default, name)
        ]
        changed += [
            f" --{name} {getattr(self, name)}"
            for name in ("each", "houses", "seconds")
            if getattr(self, name) != getattr(default, name)
        ]
        peer = " --peer COMMAND" if self.peer else ""
        return f"./run bench brief{''.join(changed)}{'' if self.proofs else ' --no-proofs'}{peer}"


def warm(grammar: str, entries: Iterable[BriefEntry]) -> Builder:
    """Return a builder that has made houses of some briefs.

    So its rules are read, and the rules of furniture are ground.
    """
    builder = Builder(find(grammar))
    for entry in entries:
        attempt(builder, alone(entry.read) if grammar == ALONE else entry.read)
    return builder


def question(entry: BriefEntry) -> bytes:
    """Return a brief in the form that other generators read."""
    return msgspec.json.encode({"name": entry.name, "brief": entry.brief}) + b"\n"


def asked(command: str, entries: Sequence[BriefEntry]) -> list[Answer]:
    """Return the answers of a command. Raises ``RequestError`` if the command fails."""
    lines = b"".join(map(question, entries))
    done = subprocess.run(shlex.split(command), input=lines, stdout=subprocess.PIPE, check=False)
    if done.returncode:
        raise RequestError(f"--peer: the command ended with code {done.returncode}")
    return [msgspec.json.decode(line, type=Answer) for line in done.stdout.splitlines()]


def in_words(found: Attempt) -> str:
    """Return the outcome of an attempt in words."""
    said = "a proof" if found.because is not None else found.limit or f"{len(found.houses)} houses"
    return f"{said}, {1e3 * found.seconds:.0f} ms, {found.refuted} refuted"
