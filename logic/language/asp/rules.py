"""Rules in a grammar's ``.lp`` files, read without running them, and the mistakes in rules by themselves."""

from collections.abc import Iterable, Iterator, Sequence

from clingo import Symbol

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import OWN, PLANS, STAR, Grammar
from vitruvius.logic.language.asp.audit import audit
from vitruvius.logic.language.asp.causes import Mistake
from vitruvius.logic.language.asp.facts import Facts, places
from vitruvius.logic.language.asp.heads import closed_heads
from vitruvius.logic.language.asp.integers import overflowing
from vitruvius.logic.language.asp.stages import misplaced
from vitruvius.logic.language.asp.statements import Statement, error_at, place, read
from vitruvius.logic.language.asp.stratification import unstratified
from vitruvius.logic.language.asp.vocabulary import (
    Use,
    Words,
    core_words,
    misspelt_predicates,
    opened,
    stages,
    words,
)


class StatedRules:
    """Names in the rules of a grammar, and the mistakes in their use."""

    def __init__(self, grammar: Grammar) -> None:
        """Set the grammar; no file is read yet."""
        self.grammar = grammar
        self.words = Words()
        self.facts = Facts(grammar, self.words)

    @property
    def constants(self) -> list[str]:
        """Constants of clingo that the grammar defines, as text."""
        return [str(use.node) for use in self.words.defined.values()]

    @property
    def program_of(self) -> dict[tuple[str | None, int | None, int | None], str]:
        """Name of the program of each rule of the grammar, by the rule's place."""
        return {place(rule.node): rule.program for rule in self.words.rules}

    def mistakes(self, last: bool) -> Iterator[Mistake]:
        """Read the files. Yield the mistakes in statements by themselves.

        Unknown names are mistakes, too. Most of them are reported only in the ``last`` examination of the
        grammar. A later examination knows the lengths, and so more about the intended names.
        """
        try:
            misused = list(self._misused(read(self.grammar.own)))
            misnamed = list(self._other_topologies()) if self.words.derived else []
        except GrammarError as error:
            yield Mistake(error)
            return
        # Other mistakes may follow from the topology that is used instead.
        yield from (Mistake(error, frozenset({"topology/1"})) for error in misnamed)
        wrong = misnamed or misused
        yield from () if misnamed else map(Mistake, misused)
        strange = [] if wrong else self.strange()
        strange += [] if wrong else self.gone(strange, ("type", 1))
        if last or any({"type/1", "topology/1"} & each.explains for each in strange):
            yield from strange

    def strange(self) -> list[Mistake]:
        """Return mistakes for the unknown predicates, or only for the topology's unknown name.

        The message about the topology lists the known ones.
        """
        found = list(misspelt_predicates(self.words))
        named = [mistake for mistake in found if "topology/1" in mistake.explains]
        if not named and self.grammar.topology_name == STAR.stem and (shared := self._of_plans_alone()):
            first = min(shared, key=lambda use: use.node.location.begin)
            why = f"{first.node.name} is for rooms that share walls: name a topology, as in topology(ring)."
            named = [Mistake(error_at(first.node, why), frozenset({"topology/1"}))]
        return named or found

    def _of_plans_alone(self) -> list[Use]:
        """Return the uses of predicates for shared walls in a grammar for rooms around a main room."""
        star = core_words()
        stated = self.words.derived.keys() - star.opened.keys() - star.used.keys() - star.derived.keys()
        return [use for each in stated & opened(PLANS) for use in self.words.derived[each]] if stated else []

    def gone(self, strange: Sequence[Mistake], *needed: tuple[str, int]) -> list[Mistake]:
        """Return a mistake for predicates that every grammar states but this one lacks, unless misspelt."""
        names = {f"{name}/{arity}" for name, arity in needed if (name, arity) not in self.words.derived}
        names -= {name for mistake in strange for name in mistake.explains}
        return [self.facts.absent_from(".lp", sorted(names), self.grammar.own)] if names else []

    def _misused(self, statements: Sequence[Statement]) -> Iterator[GrammarError]:
        """Yield errors for statements that no grammar may have, or that have no effect in their place."""
        try:
            self.words = words(statements, core_words(self.grammar.topology))
            self.facts = Facts(self.grammar, self.words)
        except RecursionError:
            yield next(filter(_too_deep, statements)).error("this is nested too deeply to be read")
            return
        refused = {id(each.node): each.error(why) for each, why in closed_heads(self.words, self.grammar)}
        yield from refused.values()
        programs = stages(core_words(self.grammar.topology))
        yield from audit((each for each in statements if id(each.node) not in refused), programs)
        yield from misplaced(self.words, refused)
        yield from unstratified(statements)
        yield from overflowing(statements)

    def _other_topologies(self) -> Iterator[GrammarError]:
        """Yield errors for rules that name a topology in a form that ``grammar.find`` does not read."""
        found = self.words.derived.get(("topology", 1), [])
        for use in found:
            named = f"topology({self.grammar.topology_name})."
            if str(use.statement.node) != named and self.grammar.topology_name != OWN.stem:
                yield use.statement.error("a topology is named by a fact alone, as in topology(ring).")
        if not found and self.grammar.topology_name not in (STAR.stem, OWN.stem):
            name = self.grammar.topology_name
            yield GrammarError(f"topology({name}). is no fact where it stands", self.grammar.directory)

    def topology_error(self, why: str, edges: Iterable[Symbol]) -> GrammarError:
        """Return an error of the user's own topology, at the rules that derive these ``edges``."""
        found = [use for edge in edges for use in places(edge, self.words)]
        rules = sorted({place(use.node) for use in found or self.words.derived.get(("edge", 3), ())})
        if not rules:
            return GrammarError(why, self.grammar.directory)
        others = sorted({line for _, line, _ in rules} - {rules[0][1]})
        also = f" (lines {', '.join(map(str, others))} too)" if others else ""
        return GrammarError(why + also, *rules[0])


def _too_deep(statement: Statement) -> bool:
    """Return True if the terms of a statement are nested deeper than Python's stack permits."""
    try:
        words([statement])
    except RecursionError:
        return True
    return False
