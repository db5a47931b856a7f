"""Lengths of classrooms with desks, and the plan with a foyer in which they stand if not in a star."""

from pathlib import Path

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find

PLAN = """
topology(dissection).  type(foyer; classroom).  empty(foyer).
opens(outside,foyer).  opens(foyer,classroom).
#program house.
:- { room(_,foyer) } != 1.
#program base.
"""
LENGTHS = """
door_width(0.9).  door_clearance(0.3).  passage(0.5).  room_gap(0.0).
room_size(classroom, W, D) :- { W >= 7, W =< 9, D >= 7, D =< 9 }.
piece_size(desk, L, D, _)  :- { L = 0.7, D = 0.5 }.
piece_size(chair, L, D, _) :- { L = 0.4, D = 0.4 }.
piece_size(board, L, D, _) :- { L >= 1.8, L =< 3, D = 0.1 }.
"""
FOYER = "room_size(foyer, W, D) :- { W >= 3, W =< 9, D >= 3, D =< 9 }.  door_margin(0.1).\n"


def builder(folder: Path, rules: str, star: bool, cell: float = 0.0) -> Builder:
    """Return the builder of these rules, in which ``{types}`` stands for the type of the classroom."""
    (folder / "rooms.lp").write_text(rules.format(types="type(classroom)." if star else PLAN))
    (folder / "sizes.pl").write_text(LENGTHS + ("" if star else FOYER))
    return Builder(find(folder), cell)
