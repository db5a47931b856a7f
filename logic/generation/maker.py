"""Who makes the houses of one topology: both stages, and the way back to the first."""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from logic.generation.feasibility import Feasibility
from logic.grammar import Grammar
from logic.house.house import House
from logic.language.loaded import LoadedGrammar
from logic.layout.program import Program
from logic.request.request import Request


class Maker(ABC):
    """Makes houses by one grammar."""

    making: Any = None
    """How the last house was made: what its witness asks for."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, feasibility: Feasibility) -> None:
        """Know its rules."""
        self.grammar, self._loaded, self.feasibility = grammar, loaded, feasibility
        self._placer, self._programs = loaded.placer, loaded.programs

    @abstractmethod
    def made(self, request: Request, rng: np.random.Generator, inferences: int) -> House:
        """A furnished house, a function of the rules, the request and the random numbers.

        Raises ``NoLayout`` if it is proved that there is none, ``OutOfInferences`` past this number of
        Prolog inferences, ``LimitReached`` past others.
        """

    def stated(self, request: Request) -> Program:
        """A program of houses of the request: its facts are the grammar's."""
        return self._programs.rooms_for(request)[0]
