"""Stage 1, clingo: every discrete choice of a house, drawn by weight and independently of the solver's state.

The rules make each free choice a variable that picks from weighted options (``rules/pick.lp``). A layout is
drawn pick by pick: the variables in random order, each taking its first value, in random order, that some
stable model shares with all the picks before it. Only the answers "satisfiable" and "unsatisfiable" are used,
so a layout depends on the rules and the random numbers alone, never on what was solved before.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import clingo
import numpy as np
from clingo import Function, Symbol

from logic.errors import GrammarError
from logic.messages import clingo_error

Part = tuple[str, Sequence[Symbol]]

CORE = Path(__file__).parent / "rules" / "core.lp"


class Program:
    """One ground program: the rooms of a house, or the furniture of one type of room."""

    def __init__(
        self,
        files: Iterable[Path],
        constants: Mapping[str, object],
        parts: Iterable[Part],
        outputs: Iterable[tuple[str, int]],
    ) -> None:
        """Ground these parts of the core and the grammar's files, with these constants.

        A layout is the atoms of the ``outputs``, signatures, that hold. ``remarks`` keeps what clingo remarks
        on the way. Raises ``GrammarError`` for its first error.
        """
        self.remarks: list[str] = []
        self._control = clingo.Control(
            [f"-c{name}={value}" for name, value in constants.items()],
            logger=lambda _, text: self.remarks.append(text),
            message_limit=1000,
        )
        try:
            for file in (CORE, *files):
                self._control.load(str(file))
            self._control.ground([("base", []), *parts, ("pick", [])])
        except RuntimeError as error:
            raise clingo_error(self.remarks, str(error)) from None
        self._literal = {atom.symbol: atom.literal for atom in self._control.symbolic_atoms}
        self._variables, self._shares = self._options()
        self._outputs = {
            atom: self._literal[atom] for name, arity in outputs for atom in self.atoms(name, arity)
        }

    def _options(self) -> tuple[list[tuple[int, list[int]]], np.ndarray]:
        """Each variable's number of picks and its pick literals, in the rules' own order; all weights."""
        options: dict[Symbol, dict[Symbol, int]] = {}
        for symbol in self.atoms("option", 3):
            variable, value, weight = symbol.arguments
            if weight.type != clingo.SymbolType.Number or weight.number < 1:
                raise GrammarError(f"{symbol}: a weight must be a positive integer")
            options.setdefault(variable, {})[value] = weight.number
        picks = {symbol.arguments[0]: symbol.arguments[1].number for symbol in self.atoms("picks", 2)}
        variables = [
            (
                picks.get(variable, 1),
                [self._literal[Function("pick", [variable, value])] for value in sorted(values)],
            )
            for variable, values in sorted(options.items())
        ]
        weights = [values[value] for _, values in sorted(options.items()) for value in sorted(values)]
        return variables, np.array(weights, float)

    def atoms(self, name: str, arity: int) -> list[Symbol]:
        """All atoms of this signature that may hold, in any model."""
        return [atom.symbol for atom in self._control.symbolic_atoms.by_signature(name, arity)]

    def possible(self, assumed: Iterable[Symbol] = (), without: Iterable[Symbol] = ()) -> bool:
        """Whether there is a layout with all assumed atoms and without any of the others."""
        return self._satisfiable(self._literals(assumed, without))

    def draw(
        self,
        rng: np.random.Generator,
        assumed: Iterable[Symbol] = (),
        without: Iterable[Symbol] = (),
        guard: int | None = None,
    ) -> list[Symbol] | None:
        """Draw a layout with all assumed atoms, without any of the others and none that the guard excludes.

        Gives its atoms, sorted; None proves that there is no such layout. The same random numbers and
        arguments give the same layout.
        """
        keys = rng.exponential(size=len(self._shares)) / self._shares
        order = rng.permutation(len(self._variables))
        fixed = self._literals(assumed, without) + ([] if guard is None else [guard])
        if not self._satisfiable(fixed):
            return None
        fixed = self._extended(fixed, self._queues(keys, order))
        with self._control.solve(assumptions=fixed, yield_=True) as handle:
            model = handle.model()
            assert model is not None, "these picks were satisfiable a moment ago"
            return sorted(atom for atom, literal in self._outputs.items() if model.is_true(literal))

    def _literals(self, assumed: Iterable[Symbol], without: Iterable[Symbol]) -> list[int]:
        return [self._literal[atom] for atom in assumed] + [-self._literal[atom] for atom in without]

    def guard(self) -> int:
        """A literal that binds what is refuted to some draws, until ``forget``."""
        with self._control.backend() as backend:
            guard = backend.add_atom()
            backend.add_external(guard, clingo.TruthValue.Free)
        return guard

    def refute(self, guard: int, atoms: Mapping[Symbol, bool]) -> None:
        """Exclude all layouts in which just these atoms hold, or fail, from draws under the guard."""
        # An atom that can never hold fails in every layout.
        literals = [
            literal if holds else -literal
            for atom, holds in atoms.items()
            if (literal := self._outputs.get(atom)) is not None
        ]
        with self._control.backend() as backend:
            backend.add_rule([], [guard, *literals])

    def forget(self, guard: int) -> None:
        """End a guard and all that it excludes."""
        self._control.release_external(guard)

    def _queues(self, keys: np.ndarray, order: np.ndarray) -> list[tuple[int, list[int]]]:
        """The variables in this order, each with its number of picks and its literals, least key first.

        The least of exponential numbers divided by weights is a weighted draw (Efraimidis, Spirakis 2006).
        """
        ends = np.cumsum([len(literals) for _, literals in self._variables])
        queues = []
        for place in order:
            count, literals = self._variables[place]
            own = keys[ends[place] - len(literals) : ends[place]]
            queues.append((count, [literals[i] for i in np.argsort(own)]))
        return queues

    def _extended(self, fixed: list[int], queues: list[tuple[int, list[int]]]) -> list[int]:
        """Add to the fixed literals the first picks of each queue that fit all before them."""
        while queues:
            # Most picks fit: try all the first choices at once, and look for a culprit only then.
            wanted = [
                (place, literal) for place, (count, queue) in enumerate(queues) for literal in queue[:count]
            ]
            good = self._longest_prefix(fixed, [literal for _, literal in wanted])
            fixed = fixed + [literal for _, literal in wanted[:good]]
            if good == len(wanted):
                return fixed
            culprit, refused = wanted[good]
            taken = {literal for place, literal in wanted[:good] if place == culprit}
            count, queue = queues[culprit]
            left = [literal for literal in queue if literal not in taken and literal != refused]
            queues = [(count - len(taken), left), *queues[culprit + 1 :]]
        return fixed

    def _longest_prefix(self, fixed: list[int], wanted: list[int]) -> int:
        """How many of the wanted literals, in order, some model has together with the fixed ones.

        An unsatisfiable core, any one, shows that its last wanted literal is too many: which cores the solver
        finds decides how soon the answer comes, not what it is.
        """
        most = len(wanted)
        while core := self._core(fixed + wanted[:most]):
            most = max(place for place in range(most) if wanted[place] in core)
        return most

    def _core(self, assumptions: Sequence[int]) -> set[int]:
        """Assumptions that no model has together: empty where some model has all."""
        core: set[int] = set()
        self._control.solve(assumptions=assumptions, on_core=core.update)
        return core

    def _satisfiable(self, assumptions: Sequence[int]) -> bool:
        return bool(self._control.solve(assumptions=assumptions).satisfiable)
