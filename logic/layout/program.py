"""Stage 1, clingo: every discrete choice of a house, sampled by weight independently of the solver's state.

The rules make each free choice a variable that picks from weighted options (``rules/pick.lp``). A layout is
sampled pick by pick. The variables come turn by turn, in random order within each turn. Each variable takes
the first value, in random order, that some stable model shares with all the picks before it. clingo finds
this model in one search, because it branches on the picks in exactly this order. Every choice that it
retracts is proved impossible, and the first model is the lexicographically first (Di Rosa, Giunchiglia and
Maratea, Constraints 15, 2010). Therefore a layout depends only on the rules and the random numbers, never on
earlier searches.
"""

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from threading import Timer

import clingo
import numpy as np
from clingo import Function, Symbol

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import RULES, TYPICAL, Places
from vitruvius.logic.layout.branching import Brancher
from vitruvius.logic.layout.differences import Differences
from vitruvius.logic.layout.ground import Instances, Literals
from vitruvius.logic.layout.messages import clingo_error

Part = tuple[str, Sequence[Symbol]]
"""``#program`` part of the rules, and its arguments."""

HOUSE: tuple[Part, ...] = (("house", ()), (TYPICAL, ()))
"""Parts for the rooms of a house."""

Nogood = Mapping[Symbol, bool]
"""Atoms that do not all hold, or fail, as stated together in one layout."""


class TooMany(Exception):
    """The search ended before it was known whether there is a layout."""


@dataclass(frozen=True)
class Conflict:
    """Minimal set of reasons why a room cannot have its furniture.

    If any one of the reasons is left out, CLP(R) has a solution.

    ``atoms`` of the layout, each of which holds or fails; ``clauses`` of the grammar, as terms:
    ``length(passage)``, ``size(bedroom)``, ``size(bedroom,bed)``.
    """

    atoms: Mapping[Symbol, bool]
    clauses: tuple[Symbol, ...]


ALL_LAYOUTS = ("--models=0", "--project=show")
"""Arguments of a program that returns every layout once."""

KEPT_ARGUMENTS = ("--heuristic=Berkmin", "--del-init=3,200,200", "--del-grow=1.1,50,+,100,20")
"""Arguments of a program that is solved for thousands of houses, each a short search in a given order.

By default clasp deletes learned nogoods only after some thousand conflicts of one search. A house has fewer
conflicts, so clasp would keep and propagate all nogoods that it learns. With these settings clasp keeps fewer
nogoods at first, and more within a long search. The heuristic makes no choice, so a cheap one suffices.
"""

ONE_HOUSE_ARGUMENTS = ("--configuration=handy", "--sat-prepro=no", "--sign-def=rnd", "--rand-freq=0.02")
"""Arguments of a program that is solved for one house, in which layouts are hard to find.

The search begins with the sampled picks. After these, clasp chooses the order, at random by a ``--seed``.
Simplifying the program first would take as long as it saves.
"""

MAX_ORDERED_CONFLICTS = 1000
"""Number of conflicts after which a search by sampled picks stops. clasp then searches in its own order.

If there is no layout, its own order proves this up to a hundred times sooner.
"""

BOUNDED_CONFLICTS = (500, 1000, 2000)
"""Number of conflicts in each search of a bounded program; each search begins with other picks."""

MAX_ORDERED_BRANCHES = 200
"""Number of branches on the sampled picks before a free search continues in clasp's order."""


@dataclass(frozen=True)
class Searching:
    """Way in which a program samples layouts."""

    arguments: tuple[str, ...]
    """Arguments of clasp."""
    bounds: tuple[int | None, ...]
    """Number of conflicts in each search by sampled picks; None for no bound."""
    patience: int | None
    """Number of branches on the sampled picks, or None if all branches follow them."""

    @property
    def follows_picks(self) -> bool:
        """True if the picks decide the layout, and clasp's own order decides only if there is one."""
        return self.patience is None


KEPT_SEARCH = Searching(KEPT_ARGUMENTS, (MAX_ORDERED_CONFLICTS,), None)
"""Search of a program for thousands of houses."""


def of_one_house(seed: int, is_bounded: bool = False) -> Searching:
    """Return the search of a program for one house, which ends at ``BOUNDED_CONFLICTS`` if it is bounded."""
    return Searching(
        (*ONE_HOUSE_ARGUMENTS, f"--seed={seed}"),
        BOUNDED_CONFLICTS if is_bounded else (None,),
        MAX_ORDERED_BRANCHES,
    )


MAX_LAYOUTS = 1000
"""Number of layouts after which a program forgets all learned nogoods, whose number grows slowly."""

LEMMAS, NOTHING = 8, 0
"""Values of clasp's option ``forget_on_step``."""

CORE = RULES / "core.lp"


class Program:
    """Ground program: the rooms of a house, or the furniture of one room type."""

    def __init__(
        self,
        files: Iterable[Path],
        constants: Mapping[str, object],
        parts: Iterable[Part],
        arguments: Iterable[str] = (),
        most: int | None = None,
        searching: Searching = KEPT_SEARCH,
        left_out: Places = frozenset(),
    ) -> None:
        """Ground parts of the core and the grammar's files, without the typical rules at ``left_out``.

        A layout is the list of shown atoms that hold. ``remarks`` keeps clingo's messages. Raises
        ``GrammarError`` for the first error, ``Endless`` past ``most`` ground rules.
        """
        self.files, self.constants, self.parts = tuple(files), constants, tuple(parts)
        self.left_out = left_out
        self.remarks = remarks = list[str]()
        self._control = clingo.Control(
            [*searching.arguments, *arguments, *(f"-c{name}={value}" for name, value in constants.items())],
            # Only the list: in a cycle with its control, a theory might be freed first, which crashes.
            logger=lambda _, text: remarks.append(text),
            message_limit=1000,
        )
        if most:
            self._control.register_observer(Instances(most))
        self._differences = Differences(
            self._control, (CORE, *self.files), self.parts, self.remarks.append, left_out
        )
        try:
            self._differences.load()
            self._control.ground([("base", []), *self.parts, ("pick", [])])
        except RuntimeError as error:
            if "bad_alloc" in str(error):
                raise MemoryError from None
            raise clingo_error(self.remarks, str(error)) from None
        self._differences.prepare()
        self.models: list[tuple[list[Symbol], list[Symbol]]] | None = None if searching == KEPT_SEARCH else []
        """Sampled layouts, each with all atoms that hold in it, for a program of one house; else None."""
        self._literal = Literals(self._control.symbolic_atoms)
        self._turns, self._counts, self._single, self._choices, self._weights = self._options(most is None)
        self._brancher = Brancher(self._choices, searching.patience)
        self._control.register_propagator(self._brancher)
        self._search = ExitStack()
        self._handle: clingo.SolveHandle | None = None
        self._assumed, self._excluding, self._sampled = list[int](), False, 0
        self._searching = searching

    def _options(self, strict: bool) -> tuple[np.ndarray, ...]:
        """Return the options of all variables, in the rules' own order.

        For each variable: its turn and its number of options. For each option: True if its variable picks
        just one, its pick literal, and its weight.
        """
        options: dict[Symbol, dict[Symbol, int]] = {}
        for symbol in self.atoms("option", 3):
            variable, value, weight = symbol.arguments
            if weight.type != clingo.SymbolType.Number or weight.number < 1:
                if not strict:
                    continue
                raise GrammarError(f"{symbol}: a weight must be a positive integer")
            options.setdefault(variable, {})[value] = weight.number
        picks = [
            (self._literal[Function("pick", [variable, value])], weight)
            for variable, values in sorted(options.items())
            for value, weight in sorted(values.items())
        ]
        counts = [len(values) for _, values in sorted(options.items())]
        several = {symbol.arguments[0] for symbol in self.atoms("picks", 2)}
        turns = {
            variable: turn.number
            for variable, turn in (symbol.arguments for symbol in self.atoms("turn", 2))
            if turn.type == clingo.SymbolType.Number
        }
        return (
            np.array([turns.get(variable, 0) for variable in sorted(options)], int),
            np.array(counts, int),
            np.array([variable not in several for variable in sorted(options)], bool).repeat(
                np.array(counts, int)
            ),
            np.array([literal for literal, _ in picks], int),
            np.array([weight for _, weight in picks], float),
        )

    def atoms(self, name: str, arity: int) -> list[Symbol]:
        """Return all atoms of this signature that may hold, in any model."""
        return [atom.symbol for atom in self._control.symbolic_atoms.by_signature(name, arity)]

    def facts(self, name: str, arity: int) -> list[Symbol]:
        """Return the atoms of this signature that hold in all models."""
        found = self._control.symbolic_atoms.by_signature(name, arity)
        return [atom.symbol for atom in found if atom.is_fact]

    def possible(self, assumed: Iterable[Symbol] = (), without: Iterable[Symbol] = ()) -> bool:
        """Return True if there is a layout with all ``assumed`` atoms and with none of ``without``."""
        self.end_search()
        return bool(self._control.solve(assumptions=self._literals(assumed, without)).satisfiable)

    def sample(
        self,
        rng: np.random.Generator,
        assumed: Iterable[Symbol] = (),
        without: Iterable[Symbol] = (),
        nogoods: Iterable[Nogood] = (),
    ) -> list[Symbol] | None:
        """Sample a layout with all ``assumed`` atoms, with none of ``without``, and with no nogood.

        Return its atoms, sorted; None proves that there is no such layout. The same random numbers and
        arguments give the same layout. A bounded search raises ``TooMany`` past ``BOUNDED_CONFLICTS``.
        """
        holds, excluded = self._literals(assumed, without), [self._excluded(nogood) for nogood in nogoods]
        for bound in self._searching.bounds:
            order = self._order(rng)
            model = self._model(holds, *order, excluded, bound)
            if self._is_undecided and self._searching.follows_picks:
                model = self._model(holds, *order, excluded) if self._has_model(holds, excluded) else None
            if not self._is_undecided:
                break
            self.end_search()
        else:
            raise TooMany
        if model is None:
            self.end_search()
            return None
        layout = sorted(model.symbols(shown=True))
        if self.models is not None:
            self.models.append((layout, list(model.symbols(atoms=True))))
        return layout

    def _order(self, rng: np.random.Generator) -> tuple[list[int], list[int]]:
        """Sample an order of the options. Also return, for each, the place that follows if it is chosen."""
        # Exponential numbers divided by weights, in order, are a weighted sample (Efraimidis, Spirakis 2006).
        keys = rng.exponential(size=len(self._weights)) / self._weights
        places = rng.permutation(len(self._counts))
        if self._turns.any():
            places = np.argsort(np.lexsort((places, self._turns)))
        ranks = np.repeat(places, self._counts)
        order = np.lexsort((keys, ranks))
        # If a variable picks just one value, the first chosen option excludes its other options.
        ends = np.cumsum(self._counts[np.argsort(places)])[places]
        then = np.where(self._single[order], ends.repeat(self._counts)[order], np.arange(len(order)) + 1)
        return order.tolist(), then.tolist()

    def _model(
        self,
        assumed: list[int],
        order: list[int],
        then: list[int],
        excluded: list[list[int]],
        bound: int | None = None,
    ) -> clingo.Model | None:
        """Return the first model by the picks in this order; None if there is none.

        Also return None past the bound of conflicts: then ``_is_undecided`` is True. Starting a search costs
        clasp nearly as much as finding a model, so one search continues for many layouts, as long as these
        have the same assumptions and no nogoods.
        """
        self._sampled += 1
        if excluded or self._excluding or assumed != self._assumed or self._sampled > MAX_LAYOUTS:
            self.end_search()
        self._assumed, self._excluding = assumed, bool(excluded)
        self._brancher.branch(order, then, excluded)
        if self._handle is not None:
            self._handle.resume()
            model = self._handle.model()
            if model is not None and not self._brancher.waiting:
                return model
            self.end_search()  # As after a layout without any choice, which has no successor.
            self._brancher.branch(order, then, excluded)
        self._configure("solver", forget_on_step=LEMMAS if self._sampled > MAX_LAYOUTS else NOTHING)
        self._configure("solve", enum_mode="user", models=0, solve_limit=f"{bound or 'umax'},umax")
        self._sampled = self._sampled % (MAX_LAYOUTS + 1)
        self._handle = self._search.enter_context(self._control.solve(assumptions=assumed, yield_=True))
        return self._handle.model()

    @property
    def _is_undecided(self) -> bool:
        """True if the sampling search ended at its bound."""
        if self._handle is None or self._handle.model() is not None:
            return False
        return not self._handle.get().exhausted

    def _has_model(self, assumed: list[int], excluded: list[list[int]]) -> bool:
        """Return True if there is a model, by a search in clasp's own order."""
        self.end_search()
        self._brancher.branch(nogoods=excluded)
        return bool(self._control.solve(assumptions=assumed).satisfiable)

    def end_search(self) -> None:
        """End the sampling search, if there is one, so that the program can be solved in another way."""
        if self._handle is not None:
            self._search.close()
            self._handle = None
            self._configure("solve", enum_mode="auto", models=1, solve_limit="umax,umax")
            self._brancher.branch()

    def _configure(self, part: str, **options: object) -> None:
        for name, value in options.items():
            setattr(getattr(self._control.configuration, part), name, value)

    def count(self, assumed: Iterable[Symbol], seconds: float) -> Iterator[tuple[int, bool | None]]:
        """Yield the number of layouts with all assumed atoms.

        The last item has True if the count is complete, and False if time ran out before. Earlier items come
        once a second, with the number so far and None. The program must have the arguments ``ALL_LAYOUTS``.
        """
        begun, shown, number = time.monotonic(), 0.0, 0
        late = Timer(seconds, self._control.interrupt)  # ends a long search for the next layout
        late.daemon = True
        with self._control.solve(assumptions=self._literals(assumed, ()), yield_=True) as handle:
            late.start()
            try:
                for number, _ in enumerate(handle, start=1):
                    passed = time.monotonic() - begun
                    if passed > seconds:
                        yield number, False
                        return
                    if passed > shown + 1:
                        shown = passed
                        yield number, None
            finally:
                late.cancel()
            yield number, not handle.get().interrupted

    def _literals(self, assumed: Iterable[Symbol], without: Iterable[Symbol]) -> list[int]:
        return [self._literal[atom] for atom in assumed] + [-self._literal[atom] for atom in without]

    def _excluded(self, nogood: Nogood) -> list[int]:
        """Return the literals of a nogood, one of which must fail, without atoms that can never hold."""
        return [
            literal if holds else -literal
            for atom, holds in nogood.items()
            if (literal := self._literal.get(atom)) is not None
        ]
