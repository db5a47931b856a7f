"""Plans: houses whose rooms share walls, of any topology but a star. From a request to such a house.

Stage 1 samples types, walls, doors and windows at once, stage 2 places them (``rules/walls.pl``), and then
the rooms are furnished at these sizes (``given_rooms.py``).
"""

from collections.abc import Collection, Sequence
from typing import Any

import msgspec
import numpy as np
from clingo import Symbol

from logic.errors import LimitReached, RequestError
from logic.given_rooms import GivenRoom, Unfurnishable, furnished
from logic.grammar import Grammar
from logic.house import House
from logic.layout import Nogood
from logic.loaded import LoadedGrammar
from logic.parts import Door, Rect, Room, Window
from logic.placement import Infeasible
from logic.proof import Prover
from logic.request import Request
from logic.terms import to_furnish

MOST_TRIES = 200
"""How often a house may have a room that cannot be furnished at its size, though it might at others."""


class Planner:
    """Makes plans of one grammar."""

    advice = "another seed, or larger rooms (room_size/3, room_area/3)"
    """Where rooms cannot be furnished."""

    def __init__(self, grammar: Grammar, loaded: LoadedGrammar, prover: Prover) -> None:
        """Know its rules."""
        self._topology = grammar.topology_name
        self._placer, self._programs, self._prover = loaded.placer, loaded.programs, prover

    def made(self, request: Request, rng: np.random.Generator, inferences: int) -> House:
        """A furnished plan.

        Raises ``Unsatisfiable`` where it is proved that there is none, ``LimitReached`` past this number of
        Prolog inferences.
        """
        if request.fixed:
            raise RequestError("keep: rooms that share walls cannot be kept yet: leave keep out")
        nogoods: list[Nogood] = []
        unfurnishable: set[str] = set()
        last = ""
        for _ in range(MOST_TRIES):
            plan, layout, inferences = self.bare(request, rng, inferences, nogoods, unfurnishable)
            rooms = [_given(plan, number) for number in range(request.rooms)]
            try:
                pieces = furnished(rooms, self._programs, self._placer, rng, inferences, request)
            except Unfurnishable as proof:
                name = plan["rooms"][proof.place].get("name", f"R{proof.place}")
                last = f"{name}, {proof}"
                # At this size and with these doors; or with one door at any size, and then nowhere.
                if not self._prover.is_furnishable(request, proof.room.type):
                    unfurnishable.add(proof.room.type)
                continue
            hubs = [f"R{atom.arguments[0]}" for atom in layout if atom.name == "hub"]
            plan["hub"] = hubs[0] if len(hubs) == 1 else ""
            return _house(plan, pieces, self._topology)
        raise LimitReached(
            f"{MOST_TRIES} times a room could not be furnished at its size (the last time {last}), though it "
            f"might be otherwise: try {self.advice}"
        )

    def bare(
        self,
        request: Request,
        rng: np.random.Generator,
        inferences: int,
        nogoods: list[Nogood],
        unfurnishable: Collection[str] = (),
    ) -> tuple[dict[str, Any], list[Symbol], int]:
        """A plan without furniture and without rooms of some types, its layout, and the inferences left.

        What is found infeasible is added to the nogoods.
        """
        program, assumed = self._programs.rooms_for(request)
        without = [atom for type_ in sorted(unfurnishable) for atom in to_furnish(type_, request.rooms)]
        while True:
            layout = program.sample(rng, assumed, without, nogoods)
            if layout is None:
                raise self._prover.unsatisfiable(request, unfurnishable)
            try:
                plan = self._walls(request, layout, int(rng.integers(2**63)), inferences)
            except Infeasible as proof:
                inferences -= proof.inferences
                nogoods.append(proof.conflicts[0].atoms)
            else:
                return plan, layout, inferences - plan["inferences"]
            if inferences <= 0:
                raise LimitReached("the walls of a house reached their limit of inferences")

    def _walls(self, request: Request, layout: list[Symbol], seed: int, inferences: int) -> dict[str, Any]:
        """Walls, doors and windows with their places: see ``Placer.walls``."""
        return self._placer.walls(layout, seed, inferences)


def _house(plan: dict[str, Any], pieces: Sequence[Any], topology: str) -> House:
    """The house of a plan, its rooms ``R0``, ``R1``... by their numbers, or with names of their own."""
    names = [room.get("name", f"R{number}") for number, room in enumerate(plan["rooms"])]
    rooms = tuple(
        msgspec.convert({**_sides(room), "name": name, "type": room["type"], "children": within}, Room)
        for name, room, within in zip(names, plan["rooms"], pieces, strict=True)
    )
    doors = tuple(Door(**_sides(door), between=_between(door["between"], names)) for door in plan["doors"])
    windows = tuple(Window(**_sides(window), room=names[window["room"]]) for window in plan["windows"])
    return House(rooms, doors, windows, hub=plan["hub"], topology=topology)


def _between(numbers: Sequence[int | str], names: Sequence[str]) -> tuple[str, str]:
    one, other = (each if isinstance(each, str) else names[each] for each in numbers)
    return one, other


def _sides(record: dict[str, Any]) -> dict[str, float]:
    return {name: record[name] for name in ("x", "y", "width", "height")}


def _given(plan: dict[str, Any], number: int) -> GivenRoom:
    """A room of a plan to be furnished; the door by which it is entered is the first."""
    room = plan["rooms"][number]
    doors = [door for door in plan["doors"] if number in door["between"]]
    doors.sort(key=lambda door: door["between"][0] != number)
    windows = [window for window in plan["windows"] if window["room"] == number]
    rect, *segments = (Rect(**_sides(each)) for each in (room, *doors, *windows))
    return GivenRoom(room["type"], rect, segments[: len(doors)], segments[len(doors) :])
