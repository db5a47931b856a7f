"""A grammar's rule files, read without running them: their statements, or their mistakes."""

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import replace
from pathlib import Path
from typing import Any

from clingo import Function, Symbol

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import LENGTHS, STAR, Grammar
from vitruvius.logic.language.asp.audit import unreadable
from vitruvius.logic.language.asp.causes import Mistake, first_causes, misspelt_name
from vitruvius.logic.language.asp.facts import NAME, stated
from vitruvius.logic.language.asp.rules import StatedRules
from vitruvius.logic.language.asp.vocabulary import (
    capitalised,
    contradictory,
    misspelt_lines,
    misspelt_names,
    unknown_choices,
)
from vitruvius.logic.language.metres import impossible, unlikely
from vitruvius.logic.language.prolog_problems import problem, unknown
from vitruvius.logic.layout.conditional import Source
from vitruvius.logic.layout.ground import Endless
from vitruvius.logic.layout.program import HOUSE, Part, Program
from vitruvius.logic.layout.programs import Programs, crowded, grouped
from vitruvius.logic.layout.relaxed import Relaxed
from vitruvius.logic.layout.terms import (
    Lengths,
    area_facts,
    berth_fact,
    depth_steps,
    length_facts,
    wall_facts,
)
from vitruvius.logic.placement.lengths import (
    area_bounds,
    disagreements,
    size_clauses,
    stated_lengths,
    unit_depths,
    wall_lengths,
)
from vitruvius.logic.placement.placer import Placer
from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.counts import MOST_ROOMS
from vitruvius.logic.spelling import closest

MOST_INSTANCES = 50_000
"""Largest number of ground rules of a house of one room without furniture; grammars have hundreds."""

VOID = "void"
"""Name of the free space of a dissection. Its size is stated like that of a room with this type."""

OUTDOOR_AREA = (
    "the grammar {} states house_area/2, and outdoor/1, of rooms that it leaves out: both are kept where "
    "nothing of the house is given. Take one of them out"
)
"""Message for such a grammar with a brief or a plan of the user, which have no houses."""


class LoadedGrammar:
    """Statements of a grammar, read in an order in which no mistake hides another one."""

    def __init__(self, grammar: Grammar, cell: float = 0.0, remarks: bool = True) -> None:
        """Load the files, for houses on a grid with cells of ``cell`` metres if not 0.

        Without ``remarks`` loading takes half the time, and clingo's remarks are no errors. ``errors`` are
        the mistakes; the other attributes are valid only without errors. ``warnings`` are about lengths that
        are probably not in metres, variables that are probably constants, and pieces that no room has.
        """
        self.grammar = grammar
        files = grammar.own + grammar.prolog
        self._illegible = [error for file in files for error in unreadable(file)]
        self.placer = Placer(replace(grammar, prolog=()) if self._illegible else grammar, cell)
        self.types: list[Symbol] = []
        self.furniture: dict[str, list[str]] = {}
        self.crowded: set[str] = set()
        self.groups: dict[Symbol, set[str]] = {}
        self.first: set[str] = set()
        self.extremes: dict[str, Any] = {}
        """Extreme sizes of rooms and pieces: see ``logic.placement.lengths.stated_lengths``."""
        self.most_rooms = MOST_ROOMS
        """Largest number of rooms of a house."""
        self.openings: list[Term] = []
        """Types between which doors may be openings, as terms."""
        self.depths: tuple[float, float] | None = None
        """Least and greatest depth of units, metres, for houses of units: see ``logic.generation.units``."""
        self.most_in_unit = 0
        """Largest number of rooms of a unit."""
        self.rules = StatedRules(grammar)
        self._of_no_room: list[GrammarError] = []
        self.errors = first_causes(self._readable()) or first_causes(self._errors())
        self.lengths: Lengths = {} if self.errors else length_facts(self.extremes)
        self.house_facts = [] if self.errors else self._house_facts()
        self.has_area = any(fact.name == "total" for fact, _ in self.house_facts)
        self.placer.account.has_area = self.has_area
        self.warnings = [] if self.errors else [*self._unlikely()]
        facts = [fact for fact, _ in self.house_facts]
        self.programs = self.programs_of(grammar, facts)
        if remarks and not self.errors:
            self.errors = list(self.programs.remarks())

    def programs_of(self, grammar: Grammar, walls: Iterable[Symbol]) -> Programs:
        """Return the programs of stage 1, with its facts about walls."""
        account = self.placer.account
        groups = self.groups, self.first
        return Programs(grammar, self.furniture, self.lengths, account, walls, self.crowded, *groups)

    def _readable(self) -> Iterator[Mistake]:
        """Yield the mistakes of single statements."""
        if self._illegible:
            yield from map(Mistake, self._illegible)
            return
        yield from self.rules.mistakes(last=bool(self.placer.problems))
        # The known clauses depend on the topology, which is a star if the grammar names none.
        unnamed = self.grammar.topology_name == STAR.stem
        for error in (problem(*row) for row in self.placer.problems):
            yield Mistake(error, about=frozenset({"topology/1", "type/1"} if unnamed else {"type/1"}))

    def _errors(self) -> Iterator[Mistake]:
        sized = size_clauses(self.placer)
        strange = self.rules.strange()
        gone = [] if strange else list(self._unstated({predicate for predicate, *_ in sized}))
        if not gone:
            strange += [*unknown_choices(self.rules.words), *misspelt_lines(self.rules.words)]
            misspelt = misspelt_names(self.rules.words, (name for _, name, *_ in sized))
            strange += (each for each in misspelt if not self.grammar.borrows(Path(str(each.error.file))))
        meant, others = _by_meaning(strange)
        try:
            probe = self._probe({"rooms": 1}, HOUSE)
            self._probe({}, [("room", [])])
        except GrammarError as error:
            lines = {(str(each.error.file), each.error.line) for each in strange}
            own = [] if (str(error.file), error.line) in lines else [Mistake(error)]
            yield from [*gone, *own, *strange]
            return
        names = {name for mistake in strange for name in mistake.about or ()}
        values, wrong = self.rules.facts.wrong(probe, names)
        wrong = [*self.rules.facts.misnamed(probe), *wrong]
        types, empty = ({each.arguments[0] for each in probe.atoms(name, 1)} for name in ("type", "empty"))
        absent = self.rules.gone(strange, ("may", 4)) if wrong and types - empty else []
        yield from [*gone, *values, *meant, *absent, *wrong, *others]
        self.types = sorted(symbol.arguments[0] for symbol in probe.atoms("type", 1))
        if strange or gone or values or wrong:
            return
        self.furniture, self.crowded = furniture_of(probe), crowded(probe.atoms("may", 4))
        self.groups, self.first = grouped(probe.atoms("one_room", 2), probe.atoms("may", 4))
        yield from self._mismeasured(probe, sized)

    def _unstated(self, stated: set[str]) -> Iterator[Mistake]:
        """Yield a mistake if ``.pl`` files lack several clauses, so that a file is probably missing."""
        lengths = [Function("length", [Function(name)]) for name in LENGTHS]
        anything = Function("any")  # A clause for all names is not a clause of any one name.
        room, piece = Function("size", [anything]), Function("size", [anything, anything])
        found = self.placer.origins([*lengths, room, piece])
        names = ["room_size/3"] if "room_size" not in stated and room not in found else []
        if "piece_size" not in stated and piece not in found and ("may", 4) in self.rules.words.derived:
            names.append("piece_size/4")
        absent = [f"{each.arguments[0].name}/1" for each in lengths if each not in found]
        if names or len(absent) > 1:
            yield self.rules.facts.absent_from(".pl", [*names, *absent], self.grammar.prolog)

    def _unsized(
        self, probe: Program, sized: Iterable[tuple[str, str, str, int, int]], lacking: Set[str]
    ) -> Iterator[Mistake]:
        """Yield mistakes for clauses of sizes of unknown room types and pieces.

        Messages about pieces that no room has become warnings, since grammars may share files. They are
        errors if a piece without a size (``lacking``) is probably meant.
        """
        pieces = {piece for pieces in self.furniture.values() for piece in pieces}
        of_rules: dict[str, GrammarError] = {}  # One statement may state many facts.
        for symbol in sorted(probe.atoms("unused", 2)):
            fact, why = stated(symbol.arguments[0]), symbol.arguments[1].string
            found = self.rules.facts.at(fact, f"{fact}: {why}{_meant(str(fact.arguments[0]), pieces)}")
            of_rules.setdefault(f"{found.file}:{found.line}:{found.column}", found)
        self._of_no_room += of_rules.values()
        boxes = {VOID} if (VOID, 1) in self.rules.words.derived else set[str]()
        for known in ({*self.furniture, *boxes}, pieces):
            rows = [each for each in sized if (each[0] == "piece_size") == (known is pieces)]
            rows = [each for each in rows if each[1] not in known]
            if known is not pieces:  # The grammar may leave out a type that an included file measures.
                rows = [each for each in rows if self.grammar.directory in Path(each[2]).parents]
            # Between a name without a meaning and one without a size, the first is probably the other.
            lacks = lacking & known
            only = min(lacks) if len({name for _, name, *_ in rows}) == len(lacks) == 1 else ""
            for predicate, name, file, line, column in rows:
                kind = "room type: see type/1" if known is not pieces else "piece in any room: see may/4"
                meant = closest(name, known) or only
                text = f"{predicate}: {name} is no {kind}{f'. Did you mean {meant}?' if meant else ''}"
                error = unknown(name, text, file, line, column)
                # A name that no piece can have belongs to no other grammar.
                if known is not pieces or meant in lacking or not NAME.fullmatch(name):
                    yield misspelt_name(error, name, meant)
                else:
                    self._of_no_room.append(error)

    def _mismeasured(
        self, probe: Program, sized: Iterable[tuple[str, str, str, int, int]]
    ) -> Iterator[Mistake]:
        """Yield the mistakes in the lengths of rooms and pieces that exist."""
        whole = self._probe({"rooms": 1}, [("units", [])]) if probe.atoms("units", 2) else probe
        limits = [symbol.arguments[0].number for symbol in whole.atoms("most_rooms", 1)]
        if whole is not probe:
            yield from map(Mistake, self._units(probe.atoms("units", 2)[0], bool(limits)))
        self.most_rooms = min([MOST_ROOMS, *limits])
        turned = {str(symbol.arguments[0]) for symbol in probe.atoms("turns", 2)}
        turned |= {str(symbol.arguments[1]) for symbol in probe.atoms("around", 4)}
        self.extremes, errors, absent = stated_lengths(self.placer, self.furniture, turned)
        windowed = [*probe.atoms("lit", 1), *probe.atoms("may_be_lit", 1)]
        lit = {str(symbol.arguments[0]) for symbol in windowed}
        self.outdoor = {str(symbol.arguments[0]) for symbol in probe.atoms("outdoor", 1)}
        sizes = self.extremes["rooms"].items()
        usable = {type_: type_ in lit for type_, size in sizes if isinstance(size, list)}
        self.openings = [Term("opening", *atom.arguments) for atom in sorted(probe.atoms("opening", 2))]
        parts = [Term("part", *atom.arguments) for atom in sorted(probe.atoms("part", 2))]
        joints = [*self.openings, *parts]
        clashes = disagreements(self.placer, usable, joints, whole is not probe, MOST_ROOMS)
        yield from self._unsized(probe, sized, {str(clause.arguments[-1]) for clause in absent})
        # Lengths in centimetres contradict others.
        unit = unlikely(self.extremes, self.placer.origins) if clashes and not (errors or absent) else ()
        yield from map(Mistake, [*errors, *unit, *clashes, *self.rules.facts.absent(absent)])
        if not errors and not absent:
            yield from map(Mistake, impossible(self.extremes, self.placer.origins))

    def _house_facts(self) -> list[tuple[Symbol, tuple[Symbol, ...]]]:
        """Return the facts of stage 1 about walls that rooms share, and about the area of the house."""
        total, rooms = area_bounds(self.placer, [each for each in self.furniture if each not in self.outdoor])
        areas = area_facts(total, rooms)
        if not self.grammar.shares_walls:
            return [*areas, berth_fact(self.extremes["lengths"], rooms)] if total else []
        walls = wall_facts(*wall_lengths(self.placer, self.furniture, self.openings))
        depths = depth_steps(*self.depths) if self.depths else []
        return [*walls, *areas, *((step, ()) for step in depths)]

    def _units(self, stated: Symbol, known: bool) -> Iterator[GrammarError]:
        """Yield errors of a grammar that states units; its topology has units if ``known``."""
        self.depths = unit_depths(self.placer)
        self.most_in_unit = stated.arguments[1].number
        if not known:
            name = self.grammar.topology_name
            yield self.rules.facts.at(stated, f"{stated}: the topology {name} has no units, as building has")
        elif self.depths is None and not self.placer.origins([Function("unit_depth")]):
            clause = "unit_depth(D) :- { D >= 7.0, D =< 9.0 }."
            why = f"unit_depth/1 has no clause: add one, as {clause}"
            yield GrammarError(why, self.grammar.prolog[-1], 1, 1)

    def _unlikely(self) -> Iterator[GrammarError]:
        """Yield warnings for statements that are probably mistakes."""
        # The user cannot mend statements of an included file about other pieces.
        own = self.grammar.directory
        yield from (each for each in self._of_no_room if own in Path(str(each.file)).parents)
        yield from unlikely(self.extremes, self.placer.origins)
        yield from capitalised(self.rules.words)
        yield from contradictory(self.rules.words)

    def _probe(self, constants: dict[str, Any], stages: Sequence[Part]) -> Program:
        """Return the program of these stages. Raises ``GrammarError`` for a rule with too many instances."""
        rules = (constants, stages)
        try:
            return Program(self.grammar.asp, *rules, most=MOST_INSTANCES, left_out=self.grammar.left_out)
        except Endless:
            endless = Relaxed(Source(self.grammar.asp), *rules, most=MOST_INSTANCES).largest().reason
        why = (
            f"this rule has more than {MOST_INSTANCES:,} instances: does it recur without end? {endless.text}"
        )
        raise GrammarError(why, endless.file, endless.line, endless.column)


def _meant(name: str, names: Iterable[str]) -> str:
    meant = closest(name, names)
    return f". Did you mean {meant}?" if meant else ""


def _by_meaning(strange: Sequence[Mistake]) -> tuple[list[Mistake], list[Mistake]]:
    """Return the misspelt names that resemble a known name, and the others.

    The message about the others should rather say what they lack.
    """
    return (
        [each for each in strange if not each.about or each.explains - each.about or "/" in min(each.about)],
        [
            each
            for each in strange
            if each.about and not each.explains - each.about and "/" not in min(each.about)
        ],
    )


def furniture_of(probe: Program) -> dict[str, list[str]]:
    """Return for each room type the pieces that it may have, and their companions."""
    furniture: dict[str, list[str]] = {str(symbol.arguments[0]): [] for symbol in probe.atoms("type", 1)}
    for symbol in probe.atoms("may", 4):
        if (type_ := str(symbol.arguments[0])) in furniture:
            furniture[type_].append(str(symbol.arguments[1]))
    for symbol in [*probe.atoms("beside", 4), *probe.atoms("around", 4)]:
        piece, companion = map(str, symbol.arguments[:2])
        for pieces in furniture.values():
            if piece in pieces and companion not in pieces:
                pieces.append(companion)
    return furniture
