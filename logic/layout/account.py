"""Account of a solver process's work on a house and of its refutations, for the message at a limit."""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import TYPE_CHECKING

from vitruvius.logic.errors import Reason
from vitruvius.logic.spelling import article

if TYPE_CHECKING:
    from clingo import Symbol

GROUNDING, LAYOUT, LENGTHS, FURNITURE, PROOF = "grounding", "layout", "lengths", "furniture", "proof"
"""Stages of the work."""

REMEDIES = {
    GROUNDING: "ask for fewer rooms, or let no rule join many values",
    LAYOUT: "ask for fewer rooms, or let the rules require less of types, doors and neighbours",
    LENGTHS: "ask for fewer rooms, or give these lengths wider bounds",
    FURNITURE: "try another seed, require fewer pieces, or larger rooms",
    PROOF: "ask for fewer rooms, or fewer requirements, so that the proof is smaller",
}
"""Remedy for each stage."""

BY_AREA = {LAYOUT, LENGTHS, PROOF}
"""Stages that a stated area of the house makes harder."""

MAX_LISTED = 3
"""Largest number of rules and lengths that a report lists with their numbers of refutations."""


class Account:
    """Work on one house."""

    def __init__(self, located: "Callable[[Iterable[Symbol]], Mapping[Symbol, Reason]]") -> None:
        """Set the function that returns the places of clauses.

        ``located`` takes time in Prolog, so it is called for each clause when the clause first occurs.
        """
        self._located = located
        self.has_area = False
        """True if the grammar states the area of the house."""
        self._reasons: dict[Symbol, Reason | None] = {}
        self.begin()

    def begin(self) -> None:
        """Begin another house."""
        self.stage, self._at = "", ""
        self._layouts = self._plans = self._rooms = 0
        self._by: Counter[Reason] = Counter()
        self._unfurnished: Counter[str] = Counter()
        self._undecided: Counter[str] = Counter()

    def at(self, stage: str, what: str) -> None:
        """Set the current stage and work."""
        self.stage, self._at = stage, what

    def sampled(self) -> None:
        """Count another layout of the rooms."""
        self._layouts += 1

    def refuted(self, clauses: "Collection[Symbol]", furniture: bool = False) -> None:
        """Count a layout of the rooms, or of one room's ``furniture``, that these clauses make infeasible."""
        if furniture:
            self._rooms += 1
        else:
            self._plans += 1
        if new := [clause for clause in clauses if clause not in self._reasons]:
            found = self._located(new)
            self._reasons |= {clause: found.get(clause) for clause in new}
        # A clause may have several names, for example one for each piece of a room.
        self._by.update({reason for clause in clauses if (reason := self._reasons[clause])})

    @property
    def tried(self) -> tuple[int, int]:
        """Numbers of layouts of the rooms that were found, and that were refuted."""
        return self._layouts, self._plans

    def unfurnished(self, type_: str, decided: bool = True) -> None:
        """Count a room of this type, at its size and with its doors, for which no furniture was found."""
        (self._unfurnished if decided else self._undecided)[type_] += 1

    @property
    def refutations(self) -> str:
        """Report of the refuted layouts and the reasons; empty if none was refuted."""
        said = []
        if self._plans:
            said.append(f"{self._plans:,} of {self._layouts:,} layouts of the rooms were refuted.")
        if self._rooms:
            said.append(f"{self._rooms:,} layouts of furniture were refuted.")
        for what, counted in (("fitted in", self._unfurnished), ("was found in time for", self._undecided)):
            types = ", ".join(
                f"{article(str(type_))} {number:,} times" for type_, number in counted.most_common(MAX_LISTED)
            )
            if types:
                said.append(f"No furniture {what} {types}.")
        lines = [f"  {number:,} times: {reason}" for reason, number in self._by.most_common(MAX_LISTED)]
        if lines:
            said.append("Most were refuted by")
        return "\n".join([" ".join(said), *lines]).strip()

    def __str__(self) -> str:
        """Return the current stage, the refuted layouts with reasons, and a remedy."""
        if not self.stage:
            return ""
        said = f"The last step was {self._at}."
        if self.stage == LAYOUT and not self._layouts:
            said += " None was found, and none was proved impossible."
        ease = REMEDIES[LENGTHS if self._by else self.stage]
        if self.has_area and self.stage in BY_AREA:
            ease += ", or give house_area/2 wider bounds"
        refutations = self.refutations and f" {self.refutations}"
        return f"{said}{refutations}{chr(10) if self._by else ' '}To make it easier, {ease}."
