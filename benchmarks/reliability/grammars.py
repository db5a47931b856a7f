"""``vitruvius bench grammars``: small grammars, random but well formed, with two requests for the same house.

A grammar gives one of four answers: a house, a proof that there is none, a limit, or an error with the file
and line of the grammar. The second answer equals the first. ``check`` verifies each house.
"""

import gc
import shutil
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np

from benchmarks.reliability.figures import AnswerFigures
from benchmarks.reliability.readers import scratch
from vitruvius.logic import check
from vitruvius.logic.errors import GrammarError, LimitReached, MissingProgram, RequestError, Unsatisfiable
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

INFERENCES = 2_000_000
"""Largest number of Prolog's inferences for a house; most houses take some hundred thousand."""

ANSWERS = "house", "proof", "limit", "grammar error"

TYPES = "cellar", "den", "lab", "attic"
PIECES = "rack", "keg", "loom", "vat"
WALLS = "front", "left", "back", "right"
SIDES = "north", "east", "south", "west"

HOUSE_RULES = (
    ":- {{ room(_,{a}) }} > {n}.",
    ":- {{ room(_,{a}) }} != {n}.",
    ":- not room(_,{a}).",
    ":- rooms < {m}, room(_,{a}).",
    ":- room(R,T), room(R+1,T), room(R+2,T).",
    ":- N = #count{{ R : room(R,{a}) }}, {{ room(_,{b}) }} > N.",
    ":- {{ room(_,{a}) }} != (rooms+2)/3.",
    "weight({a},rooms).",
    "option(choice,{a},3). option(choice,{b},1).\n:- pick(choice,T), not room(_,T).",
)
"""Rules of houses that hold in any topology."""

RULES_OF = {
    "star": (
        ":- room(R,{a}), not side(R,{s}).",
        ":- room(R,{a}), side(R,S), clockwise(S,T), side(Q,T), room(Q,{b}).",
        "next(R,R+1) :- side(R,S), side(R+1,S).\n:- next(R,Q), room(R,{a}), room(Q,{b}).",
        ":- corner(S,T,S).",
    ),
    "ring": (
        ":- from(R,Q), room(R,{a}), room(Q,{b}).",
        ":- room(R,{a}), not outer(R,{s}).",
        ":- entrance(_,{s}).",
        ":- adjacent(R,Q), room(R,{a}), room(Q,{b}).",
        ":- behind(R), room(R,{a}).",
        ":- band(R,{s}), room(R,{a}).",
    ),
    "corridor": (
        ":- room(R,{a}), not in_row(R,north,1).",
        ":- entered(R,{b}), room(R,{a}).",
        ":- niche(R), room(R,{a}).",
        ":- room(R,{a}), not window(R,{s}).",
    ),
    "dissection": (
        ":- west_of(R,Q), room(R,{a}), room(Q,{b}).",
        ":- north_of(R,Q), room(R,{a}), room(Q,{b}).",
        ":- room(R,{a}), not outer(R,{s}).",
        ":- linked(R,Q), room(R,{a}), room(Q,{b}).",
        "void(rooms). :- edge(rooms,_,outline(_)).",
    ),
}

ROOM_RULES = (
    ":- on({p},_,{w},_).",
    ":- on({p},_,S,_), on({q},_,T,_), at(S,W), at(T,W).",
    ":- this_room = {a}, not on({p},_,_,_).",
    ":- this_room = {a}, on({p},_,_,_), on({q},_,_,_).",
    ":- on({p},_,S,N), on({p},_,S,N+1).",
    ":- on({p},K,{w},_), not faces({p},K,outwards).",
)

ROOM_FACTS = (
    "lit({a}).", "may_be_lit({a}).", "degree({a},1,{n}).", "same_size({a}).", "loops({a},{b}).",
    "weight({a},{n}).",
    "opening({a},{b}).", "notches({n}).", "outdoor({a}).",
)  # fmt: skip
"""Facts about rooms that share walls."""

MISTAKES = (
    ":- room(R,attik).", "type(cellar)", ":- rooms > .", "may(den,keg,3,1).", ":- side(R).",
    "stands(rack,roof).",
    "p(X) :- not q(X).", "#program hous.", "type(X) :- X = 1..3.", ":- room(R,T), T.",
)  # fmt: skip

LENGTHS = """
door_width(0.8).  door_margin(0.1).  window_margin(0.3).  door_clearance(0.45).  passage(0.42).
room_gap({gap}).
window_size(_, L, Wall) :- {{ L >= 0.6, L =< 0.6*Wall, L =< 2.4 }}.
"""


def random_grammar(folder: Path, rng: np.random.Generator) -> None:
    """Write the rule files of a grammar."""

    def some(names: Sequence[str]) -> str:
        return str(rng.choice(names))

    def filled(text: str) -> str:
        numbers = {"n": rng.integers(1, 4), "m": rng.integers(1, 5)}
        words = {"p": some(pieces), "q": some(pieces), "w": some(WALLS), "s": some(SIDES)}
        return text.format(a=some(types), b=some(types), **numbers, **words)

    topology = some(("star", "star", "ring", "corridor", "dissection"))
    types, pieces = list(TYPES[: rng.integers(1, 5)]), list(PIECES[: rng.integers(1, 5)])
    shares_walls = topology != "star"
    facts, lengths = [f"topology({topology})."], [LENGTHS.format(gap=0.0 if shares_walls else 0.6)]
    for name in types:
        facts.append(f"type({name}).")
        low, more = rng.uniform(0.8, 4.5), rng.uniform(0, 3)
        bounds = f"W >= {low:.2f}, W =< {low + more:.2f}, D >= {low:.2f}, D =< {low + more:.2f}"
        proportion = some(("", "", ", D = W", ", W =< 1.5*D"))
        lengths.append(f"room_size({name}, W, D) :- {{ {bounds}{proportion} }}.")
        furniture = rng.permutation(pieces)[: rng.integers(0, 3)]
        for piece in furniture:
            least = rng.integers(0, 2)
            facts.append(f"may({name},{piece},{least},{least + rng.integers(0, 3)}).")
        if not len(furniture) or rng.random() < 0.1:
            facts.append(f"empty({name}).")
        if shares_walls:
            facts += [f"opens(outside,{name}).", f"opens({name},{some(types)})."]
            if rng.random() < 0.3:
                facts.append(f"central({name}).")
            if rng.random() < 0.2:
                lengths.append(f"room_area({name}, {low * low:.1f}, {(low + more) ** 2:.1f}).")
    for piece in pieces:
        walls = rng.permutation((*WALLS, "middle"))[: rng.integers(1, 4)]
        facts.append(f"stands({piece},({';'.join(walls)})).")
        long, deep = rng.uniform(0.3, 2.0, 2)
        sizes = (
            f"L >= {long:.2f}, L =< {long + 0.3:.2f}, D = {deep:.2f}",
            "L >= 0.5*Wall, L =< Wall, D = 0.5",
        )
        size = sizes[int(rng.random() < 0.15)]
        lengths.append(f"piece_size({piece}, L, D, {'Wall' if 'Wall' in size else '_'}) :- {{ {size} }}.")
        if rng.random() < 0.2:
            facts.append(f"clear_front({piece}).")
        if rng.random() < 0.15 and "middle" in walls:
            facts.append(f"around({piece},stool,0,{rng.integers(1, 4)}).")
    lengths.append("piece_size(stool, L, D, _) :- { L = 0.4, D = L }.")
    if shares_walls:
        facts.append(f"opens({types[0]},({';'.join(types)})).")
        facts.append(f"central({types[0]}).")
        facts += [filled(text) for text in rng.permutation(ROOM_FACTS)[: rng.integers(0, 3)]]
    house_rules = (*HOUSE_RULES, *RULES_OF[topology])
    rules = ["#program house.", *map(filled, rng.permutation(house_rules)[: rng.integers(0, 4)])]
    rules += ["#program room.", *map(filled, rng.permutation(ROOM_RULES)[: rng.integers(0, 3)])]
    if rng.random() < 0.05:
        rules.append(some(MISTAKES))
    (folder / "rooms.lp").write_text("\n".join([*facts, *rules]) + "\n")
    (folder / "sizes.pl").write_text("\n".join(lengths) + "\n")


def answered(folder: Path, rooms: int, seed: int) -> tuple[str, str]:
    """Return the kind of answer to a request for a house, and the text of the house or the error."""
    try:
        grammar = find(folder)
        builder = Builder(grammar, 0.0, LoadedGrammar(grammar))
        request = HouseRequest(rooms, inferences=INFERENCES)
        house = house_or_proof(builder, request, seed=seed, index=0)
    except Unsatisfiable as error:
        return ("proof" if error.reasons else "proof without a reason"), str(error)
    except LimitReached as error:
        return "limit", str(error)
    except GrammarError as error:
        return ("grammar error" if error.file else "grammar error without a place"), str(error)
    except RequestError as error:
        return "request refused", str(error)
    violations = check(house)
    return (f"house that check refuses: {violations[0]}" if violations else "house"), repr(house)


def asked(folder: Path, seed: int) -> str:
    """Ask a random grammar twice, and return the kind of answer.

    Raises ``AssertionError`` for answers that differ, and for a kind that is not in ``ANSWERS``.
    """
    rng = np.random.default_rng(seed)
    for file in folder.iterdir():
        file.unlink()
    random_grammar(folder, rng)
    rooms = int(rng.integers(1, 6))
    first, second = (answered(folder, rooms, seed) for _ in range(2))
    assert first[0] in ANSWERS, f"{first[0]}: {first[1][:200]}"
    assert first == second, f"two answers: {first[1][:200]} and {second[1][:200]}"
    return first[0]


@dataclass(frozen=True)
class RandomGrammars:
    """Make small random grammars, and ask each twice for a house: the same one of four answers."""

    seconds: float = 600.0
    """Seconds of the whole study."""

    seed: int = 0
    """Seed of the first grammar."""

    out: Path = Path("runs/grammars")
    """Folder for the grammars that fail."""

    replace: bool = False
    """Write into the folder even if it holds other files."""

    def run(self) -> int:
        """Print the number of each answer, and return 1 if there is another answer."""
        figures, begun = AnswerFigures(), time.monotonic()
        with scratch() as yard:
            folder = yard / "mine"
            folder.mkdir()
            for seed in count(self.seed):
                if time.monotonic() > begun + self.seconds:
                    break
                started = time.process_time()
                try:
                    answer = asked(folder, seed)
                except MissingProgram:
                    raise
                except Exception as error:
                    answer = "failed"
                    kind = f"seed {seed}: {type(error).__name__}: {str(error)[:300]}"
                    figures.failures[kind] = self._kept(folder, seed)
                figures.count(answer, time.process_time() - started)
                gc.collect()
        figures.measure(begun)
        return figures.report("grammars")

    def _kept(self, folder: Path, seed: int) -> str:
        """Keep a grammar and the traceback of its failure, and return the folder."""
        kept = self.out / str(seed)
        shutil.copytree(folder, kept, dirs_exist_ok=True)
        (kept / "why.txt").write_text(traceback.format_exc())
        return str(kept)
