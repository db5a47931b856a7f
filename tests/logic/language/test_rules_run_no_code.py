"""Rule files are data: only clauses that lint has approved ever run."""

import shutil
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from tests.programs import PATIENCE
from vitruvius.logic.errors import VitruviusError
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.request.house_request import HouseRequest

# Whole texts at the end of sizes.pl. RUN leaves a file behind if it ever runs.
REFUSED = {
    "a head of another module": "foo:bar(1).\npassage(P) :- system:RUN, P = 1.",
    "a head that is control": "'*->'(a,b).\npassage(P) :- ( RUN *-> P = 1 ; P = 2 ).",
    "a head that negates": "(\\+ a).\npassage(P) :- \\+ RUN, P = 1.",
    "a head that is a constraint": "{}(a).\npassage(P) :- {}(RUN), P = 1.",
    "a rule in parentheses": "(passage(P) :- RUN, P = 1).\nroom_gap(1) :- \\+ (a :- b).",
    "a head of SWI-Prolog's own": "shell(a).\npassage(P) :- RUN, P = 1.",
    "a core's name with another arity": "room_size(a) :- RUN.",
    "a function on a dict": "passage(P) :- _ = x{}.catch(RUN), P = 1.",
    "a function on a variable": "passage(P) :- X = x{}, P = X.catch(RUN).",
    "a method of dicts": "M.method() := V :- RUN, V = M.",
    "an expansion of goals that nothing calls": "goal_expansion(number(1), RUN).",
    "an expansion of goals for all modules": "user:goal_expansion(number(1), RUN).",
    "an expansion of terms for all modules": "system:term_expansion(end_of_file, (:- RUN)).",
    "a list": "[(:- RUN)].",
    "a list of clauses and directives": "[room_gap(1), (:- RUN)].",
    "a directive": ":- RUN.",
    "an initialization": ":- initialization(RUN).",
    "a condition": ":- if(RUN).\n:- endif.",
    "a library": ":- use_module(library(shell)).",
    "a library that is renamed": ":- use_module(library(clpr), except([])), RUN.",
    "operators": ":- op(700, xfx, touches).\npassage(P) :- P touches 1.",
    "an encoding": ":- encoding(utf16le).",
    "a flag": ":- set_prolog_flag(double_quotes, codes).",
    "tables": ":- table passage/1.",
    "a rule with a picture of commits": "passage(P), RUN => P = 1.",
    "a grammar rule": "passage --> { RUN }.",
    "a quasi quotation": "passage(P) :- {|shell(P)||touch||}.",
    "a goal that is a variable": "passage(P) :- G = RUN, G, P = 1.",
    "a goal of another module": "passage(P) :- system:RUN, P = 1.",
    "a goal that is called": "passage(P) :- call(RUN), P = 1.",
    "a goal that is put together": "passage(P) :- G =.. [shell,''], call(G), P = 1.",
    "a goal in braces": "passage(P) :- { RUN }, { P = 1 }.",
    "a goal in a constraint": "passage(P) :- { P = RUN }.",
    "a goal in arithmetic": "passage(P) :- P is RUN.",
    "a goal under a condition": "passage(P) :- ( true -> RUN ; true ), P = 1.",
    "a goal in other letters": "passage(P) :- '\\x73\\hell'('TOUCH'), P = 1.",
    "a goal that waits": "passage(P) :- freeze(X, RUN), X = 1, P = 1.",
    "a clause that is stated": "passage(P) :- assertz((room_gap(P) :- RUN)).",
    "a goal after the end": "end_of_file.\n:- RUN.",
    "a number that differs each time": "passage(P) :- P is random_float.",
    "a term without arguments": "passage(P) :- half(P).\nhalf(P) :- P = f().",
    "a comment that ends too early": "/* */ :- RUN. /* */",
    "a byte order mark within": "\ufeff:- RUN.",
}
HARMLESS = {
    "an expansion of goals": "goal_expansion(atom(a), RUN).\npassage(1) :- atom(a), goal_expansion(_, _).",
    "an expansion of terms": "term_expansion(a, (:- RUN)).\na.\npassage(1) :- a, term_expansion(_, _).",
    "a hook of the printer": "portray(X) :- X = RUN.\npassage(P) :- portray(P).",
    "a hook of attributes": "attr_unify_hook(X, Y) :- X = Y.\npassage(P) :- P = 1, attr_unify_hook(P, 1).",
    "a hook of messages": "message_hook(_, _, _).\npassage(P) :- P = 1, message_hook(RUN, P, P).",
    "a cyclic term": "passage(P) :- X = f(X,RUN), Y = f(Y,RUN), X = Y, P = 1.",
    "a goal as a name": "room_size('RUN', 3, 3).",
    "a goal as data": "passage(P) :- member(P-_, [1-RUN]).",
    "a comment": "% :- RUN.",
}
FIRST = {
    "a first line that a shell reads": "#!/bin/sh\n:- RUN.\n",
    "a first line that a loader leaves out": "#(1). /*\n:- RUN.\n% */\npassage(P) :- #(P).\n",
}
ENDS = """', 1)], 0)], [], 1, quick), 1, _), RUN %"""
LP = {
    "quotes in the options of a choice": f"""
#program room.
quoted(bed,dynamic'; wardrobe,"{ENDS}").
option(X,Y,1) :- quoted(F,Y), X = place(F,1).
:- on(bed,1,P,_), this_room = bedroom, P != dynamic'.
:- on(wardrobe,1,P,_), this_room = bedroom, P != "{ENDS}".
""",
    "a piece with a quote in its name": "may(bedroom,lamp',1,1). stands(lamp',left).",
    "a piece that is text": 'may(bedroom,"lamp",1,1). stands("lamp",left). clear_front("lamp").',
    "a type that is text": 'type("a,RUN"). may("a,RUN",bed,1,1). weight("a,RUN",2).',
    "a companion with a quote in its name": "beside(bed,lamp',1,1). clear_front(lamp').",
    "a script": "#script (python)\nimport os; os.system('TOUCH')\n#end.",
}

WAYS = {
    f"{kind}: {title}": (file, place, text, refused)
    for kind, file, place, refused, table in (
        ("refused", "sizes.pl", "end", True, REFUSED),
        ("harmless", "sizes.pl", "end", False, HARMLESS),
        ("refused", "sizes.pl", "begin", True, FIRST),
        ("refused", "furniture.lp", "end", True, LP),
    )
    for title, text in table.items()
}


def tried(folder: Path, trace: Path) -> tuple[list[str], bool, bool]:
    """Return lint's errors, and True for lint and for a bedroom if they left a trace."""
    from vitruvius.logic.generation.builder import Builder
    from vitruvius.logic.language.linter import findings
    from vitruvius.logic.proofs.answer import house_or_proof

    errors = [each.text for each in findings(find(folder)) if each.severity == "error"]
    linted = trace.exists()
    trace.unlink(missing_ok=True)
    with suppress(VitruviusError):
        request = HouseRequest(1, types={"bedroom": (1, 1)}, inferences=10**7)
        house_or_proof(Builder(find(folder)), request, 0, 0)
    return errors, linted, trace.exists()


@pytest.mark.parametrize("title", WAYS)
def test_no_rule_file_runs_a_program(title: str, solver: ProcessPoolExecutor, tmp_path: Path) -> None:
    file, place, text, refused = WAYS[title]
    trace = tmp_path / "trace"
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    text = text.replace("RUN", "shell('TOUCH')").replace("TOUCH", f"touch {trace}")
    rules = (folder / file).read_text()
    (folder / file).write_text(f"{text}\n{rules}" if place == "begin" else f"{rules}\n{text}\n")
    errors, linted, generated = solver.submit(tried, folder, trace).result(timeout=PATIENCE)
    assert (linted, generated) == (False, False)
    assert errors or not refused
    assert not any("raises an error" in error for error in errors), "it was run before it was judged"
