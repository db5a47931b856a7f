"""Base of the generators of the houses of one topology: both stages, and the feedback between them."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from vitruvius.logic.generation.feasibility import Feasibility
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.program import Program
from vitruvius.logic.request.house_request import HouseRequest


class Maker(ABC):
    """Generator of houses by one grammar."""

    making: Any = None
    """Origin of the last house, for its witness."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, feasibility: Feasibility) -> None:
        """Set the rules."""
        self.grammar, self._loaded, self.feasibility = grammar, loaded, feasibility
        self._placer, self._programs = loaded.placer, loaded.programs

    @abstractmethod
    def made(self, request: HouseRequest, rng: np.random.Generator, inferences: int) -> House:
        """Return a furnished house, a function of the rules, the request and the random numbers.

        Raises ``NoLayout`` if there is provably none, ``OutOfInferences`` after this number of Prolog
        inferences, and ``LimitReached`` at other limits.
        """

    def stated(self, request: HouseRequest) -> Program:
        """Return a program of houses of the request, whose facts are the grammar's."""
        return self._programs.rooms_for(request)[0]
