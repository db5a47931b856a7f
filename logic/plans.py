"""Plans: houses whose rooms share walls, of any topology but a star. From a request to such a house.

Stage 1 samples types, walls, doors and windows at once, stage 2 places them (``rules/walls.pl``), and then the
rooms are furnished at these sizes (``given_rooms.py``).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from clingo import Symbol

from logic.errors import LimitReached, RequestError
from logic.given_rooms import GivenRoom, Unfurnishable, furnished
from logic.parts import Rect
from logic.layout import Nogood
from logic.placement import Infeasible
from logic.loaded import LoadedGrammar
from logic.proof import Prover
from logic.request import Request

MOST_TRIES = 200
"""How often a house may have a room that cannot be furnished at its size, though it might at others."""

OUTSIDE = "outside"


class Planner:
    """Makes plans of one grammar."""

    def __init__(self, loaded: LoadedGrammar, prover: Prover) -> None:
        """Know its rules."""
        self._placer, self._programs, self._prover = loaded.placer, loaded.programs, prover

    def made(
        self, request: Request, rng: np.random.Generator, inferences: int
    ) -> tuple[dict[str, Any], list[Symbol]]:
        """A furnished plan, the parts of a house file's record, and its layout.

        Raises ``Unsatisfiable`` where it is proved that there is none, ``LimitReached`` past this number of
        Prolog inferences.
        """
        if request.cell or request.fixed:
            what = "cell" if request.cell else "keep"
            raise RequestError(f"{what}: rooms that share walls cannot have it yet: leave {what} out")
        nogoods: list[Nogood] = []
        for _ in range(MOST_TRIES):
            plan, layout, inferences = self.bare(request, rng, inferences, nogoods)
            rooms = [
                GivenRoom(room["type"], _rect(room), _doors(plan, number), _windows(plan, number))
                for number, room in enumerate(plan["rooms"])
            ]
            try:
                pieces = furnished(rooms, self._programs, self._placer, rng, inferences)
            except Unfurnishable:
                continue
            return _record(plan, pieces), layout
        raise LimitReached(
            f"{MOST_TRIES} times a sampled room could not be furnished at its size, though larger ones might: "
            "try another seed, or larger rooms (room_size/3, room_area/3)"
        )

    def bare(
        self, request: Request, rng: np.random.Generator, inferences: int, nogoods: list[Nogood]
    ) -> tuple[dict[str, Any], list[Symbol], int]:
        """A plan without furniture, its layout, and what is left of the inferences.

        What is found infeasible is added to the nogoods.
        """
        program, assumed = self._programs.rooms_for(request)
        while True:
            layout = program.sample(rng, assumed, nogoods=nogoods)
            if layout is None:
                raise self._prover.unsatisfiable(request, ())
            try:
                plan = self._placer.walls(layout, int(rng.integers(2**63)), inferences)
            except Infeasible as proof:
                inferences -= proof.inferences
                nogoods.append(proof.conflicts[0].atoms)
            else:
                return plan, layout, inferences - plan["inferences"]
            if inferences <= 0:
                raise LimitReached("the walls of a house reached their limit of inferences")


def _record(plan: dict[str, Any], pieces: Sequence[Any]) -> dict[str, Any]:
    """The rooms, doors and windows of a house file."""
    return {
        "rooms": [
            {**_sides(room), "name": _name(number), "type": room["type"], "children": pieces[number]}
            for number, room in enumerate(plan["rooms"])
        ],
        "doors": [{**_sides(door), "between": [*map(_name, door["between"])]} for door in plan["doors"]],
        "windows": [{**_sides(window), "room": _name(window["room"])} for window in plan["windows"]],
    }


def _name(number: int | str) -> str:
    return OUTSIDE if number == OUTSIDE else f"R{number}"


def _sides(record: dict[str, Any]) -> dict[str, float]:
    return {name: record[name] for name in ("x", "y", "width", "height")}


def _rect(record: dict[str, Any]) -> Rect:
    return Rect(**_sides(record))


def _doors(plan: dict[str, Any], room: int) -> list[Rect]:
    """The doors of a room, that by which it is entered first."""
    found = [door for door in plan["doors"] if room in door["between"]]
    return [_rect(door) for door in sorted(found, key=lambda door: door["between"][0] != room)]


def _windows(plan: dict[str, Any], room: int) -> list[Rect]:
    return [_rect(window) for window in plan["windows"] if window["room"] == room]
