"""Grammars whose .pl files try to run code, or to change what the core runs."""

from pathlib import Path

from tests.hostile.case import ACCEPTED, HARMLESS, REFUSED, Case, Yard, grammar, titled

GOALS = r"""
shell('TOUCH')
shell('TOUCH', _)
system:shell('TOUCH')
user:shell('TOUCH')
@(shell('TOUCH'), user)
process_create(path(touch), ['TRACE'], [])
open('TRACE', write, S), close(S)
open(pipe('TOUCH'), write, S), close(S)
tell('TRACE'), told
append('TRACE'), told
tmp_file_stream('TRACE', S, [])
make_directory('TRACE')
delete_file('SECRET')
rename_file('SECRET', 'TRACE')
link_file('SECRET', 'TRACE', symbolic)
qsave_program('TRACE')
protocol('TRACE')
call(shell, 'TOUCH')
call(shell('TOUCH'))
Goal = shell('TOUCH'), Goal
Goal = shell('TOUCH'), call(Goal)
Goal =.. [shell, 'TOUCH'], call(Goal)
findall(X, shell('TOUCH'), _)
bagof(X, shell('TOUCH'), _)
forall(shell('TOUCH'), true)
aggregate_all(count, shell('TOUCH'), _)
\+ shell('TOUCH')
( shell('TOUCH') -> true ; true )
( true *-> shell('TOUCH') ; true )
( fail ; shell('TOUCH') )
once(shell('TOUCH'))
ignore(shell('TOUCH'))
not(shell('TOUCH'))
catch(shell('TOUCH'), _, true)
catch(throw(x), _, shell('TOUCH'))
setup_call_cleanup(true, true, shell('TOUCH'))
call_cleanup(true, shell('TOUCH'))
call_with_time_limit(1, shell('TOUCH'))
maplist(shell, ['TOUCH'])
foldl([X,_,_]>>shell(X), ['TOUCH'], 0, _)
phrase(shell, 'TOUCH')
freeze(X, shell('TOUCH')), X = 1
when(nonvar(X), shell('TOUCH')), X = 1
thread_create(shell('TOUCH'), _)
thread_create((repeat, fail), _)
thread_signal(main, shell('TOUCH'))
alarm(0, shell('TOUCH'))
on_signal(alrm, _, shell)
at_halt(shell('TOUCH'))
prolog_cut_to(1)
assertz((room_gap(0.7) :- shell('TOUCH')))
retractall(room_gap(_))
asserta(user:goal_expansion(true, shell('TOUCH')))
consult('EVIL')
['EVIL']
load_files('EVIL', [])
ensure_loaded('EVIL')
use_module('EVIL')
include('EVIL')
make
edit('EVIL')
use_foreign_library('EVIL')
open_shared_object('libc.so.6', _)
read_term(user_input, T, []), call(T)
term_to_atom(T, 'shell(\'TOUCH\')'), call(T)
format('~@', [shell('TOUCH')])
with_output_to(string(_), shell('TOUCH'))
print_message(error, format('~@', [shell('TOUCH')]))
clause(room_gap(_), Body), Body
'$set_source_module'(user)
'$compile_aux_clauses'([(:- shell('TOUCH'))], x)
set_prolog_flag(unknown, fail)
op(700, xfx, is)
setenv('PATH', '/nowhere')
getenv('HOME', X)
read_file_to_string('SECRET', S, [])
directory_files('/', _)
working_directory(_, '/')
tcp_socket(S), tcp_connect(S, localhost:PORT)
http_open('http://localhost:PORT/', S, [])
halt
halt(0)
abort
prolog
sleep(1000)
win_shell(open, 'TRACE')
set_stream(user_output, alias(x))
nb_setval(x, 1)
put_attr(X, grammar, 1)
copy_predicate_clauses(system:shell/1, room_gap/1)
trace
garbage_collect
{ X = shell('TOUCH') }
{ shell('TOUCH') }
X is shell('TOUCH')
X is cputime
X is random(9)
member(X, [shell('TOUCH')]), X
_ = x{a:1}.put(b, shell('TOUCH'))
_ = x{}.call(shell('TOUCH'))
X = _{a: shell('TOUCH')}.a
_ = [1].length()
"""
"""Goals in a length's body: none may be called, in whatever way."""

HEADS = r"""
foo:bar(1)|system:shell('TOUCH')
'*->'(a, b)|( true *-> shell('TOUCH') )
(a -> b)|( true -> shell('TOUCH') )
(a ; b)|( shell('TOUCH') ; true )
\+ a|\+ shell('TOUCH')
call(a)|call(shell('TOUCH'))
call(a, b)|call(shell, 'TOUCH')
once(a)|once(shell('TOUCH'))
findall(a, b, c)|findall(X, shell('TOUCH'), _)
forall(a, b)|forall(shell('TOUCH'), true)
catch(a, b, c)|catch(shell('TOUCH'), _, true)
@(a, b)|@(shell('TOUCH'), user)
^(a, b)|X ^ shell('TOUCH')
[a|b]|['EVIL']
consult(a)|consult('EVIL')
shell(a)|shell('TOUCH')
system:shell(a)|shell('TOUCH')
open(a, b, c)|open('TRACE', write, _)
assertz(a)|assertz((:- shell('TOUCH')))
apply(a, b)|apply(shell, ['TOUCH'])
','(a, b)|shell('TOUCH'), true
!|shell('TOUCH')
{}(a)|{ shell('TOUCH') }
is(a, b)|X is shell('TOUCH')
member(a, b)|member(shell('TOUCH'), [X])
=(a, b)|X = shell('TOUCH'), X
true|shell('TOUCH')
grammar:room_gap(7)|shell('TOUCH')
core:placed(a, b, c)|core:placed(a, b, c)
clpr:solve(a)|clpr:solve(shell('TOUCH'))
lists:append(a, b)|lists:append([], X)
sandbox:safe_primitive(system:shell(_))|shell('TOUCH')
user:portray(X)|user:portray(shell('TOUCH'))
"""
"""Clauses that define a control construct or another module's predicate, and the goal that each would
permit."""

HOOKS = r"""
goal_expansion(true, shell('TOUCH'))
goal_expansion(G, system:shell('TOUCH'))
user:goal_expansion(true, shell('TOUCH'))
system:goal_expansion(true, shell('TOUCH'))
term_expansion(end_of_file, (:- shell('TOUCH')))
term_expansion(X, (:- shell('TOUCH')))
user:term_expansion(end_of_file, (:- shell('TOUCH')))
dcg_translate_rule(a, (:- shell('TOUCH')))
expand_query(a, shell('TOUCH'), b, c)
prolog_load_file('EVIL', [])
user:prolog_load_file(F, O)
message_hook(T, K, L)
user:message_hook(T, K, L)
user:exception(undefined_global_variable, x, retry)
user:prolog_exception_hook(A, B, C, D)
user:file_search_path(library, 'TRACE')
user:prolog_file_type(pl, evil)
user:portray(X)
prolog:message(X)
attr_unify_hook(A, B)
attribute_goals(A, B, C)
attr_portray_hook(A, B)
M.method() := shell('TOUCH')
X.call() := shell('TOUCH') :- true
resource(x, 'TRACE')
'$pldoc'(a)
'$expand':f(a)
"""
"""Clauses that the loader, the tracer, the printer or the garbage collector of SWI-Prolog would call."""

DIRECTIVES = r"""
:- shell('TOUCH').
?- shell('TOUCH').
:- initialization(shell('TOUCH')).
:- initialization(shell('TOUCH'), main).
:- initialization shell('TOUCH').
[(:- shell('TOUCH'))].
[room_gap(0.6), (:- shell('TOUCH'))].
[user].
['EVIL'].
(:- shell('TOUCH')), a.
:- module(mine, [room_gap/1]).
:- module(system, [shell/1]).
:- include('EVIL').
:- consult('EVIL').
:- ['EVIL'].
:- use_module('EVIL').
:- use_module(library(process)).
:- use_module(library(shell), [shell/1 as member]).
:- use_module(library(clpr), except([{}/1])), shell('TOUCH').
:- use_module(library(clpr), [{}/1 as shell]), shell('TOUCH').
:- reexport('EVIL').
:- load_foreign_library('EVIL').
:- use_foreign_library('EVIL').
:- if(shell('TOUCH')).\n:- endif.
:- if(true).\n:- shell('TOUCH').\n:- else.
:- elif(shell('TOUCH')).
:- op(1200, xfx, is).
:- op(200, xfy, '.').
:- encoding(iso_latin_1).
:- set_prolog_flag(double_quotes, codes).
:- set_prolog_flag(generate_debug_info, false), shell('TOUCH').
:- style_check(-singleton).
:- license(gpl).
:- expects_dialect(sicstus).
:- table room_size/3.
:- dynamic(goal_expansion/2), shell('TOUCH').
:- thread_local a/1.
:- thread_initialization(shell('TOUCH')).
:- at_halt(shell('TOUCH')).
:- create_prolog_flag(x, 1, []).
:- set_module(class(system)).
:- format_predicate(x, shell('TOUCH')).
:- prolog_load_context(term, T), shell('TOUCH').
:- halt.
:- (a :- shell('TOUCH')).
a --> { shell('TOUCH') }.
a, [b] --> call(shell, 'TOUCH').
room_gap(G), shell('TOUCH') => G = 0.6.
room_gap(G) => shell('TOUCH'), G = 0.6.
a ?=> shell('TOUCH').
:- :- shell('TOUCH').
"""
"""Terms at the end of a file that are not clauses."""

FIRST_LINES = r"""
#!/bin/sh\n:- shell('TOUCH').
# . /*\n:- shell('TOUCH').\n% */\nroom_gap(G) :- # , G = 0.6.
#- /*\n:- shell('TOUCH').\n% */
#!/usr/bin/env swipl\n:- initialization(main, main).\nmain :- shell('TOUCH').
\ufeff:- shell('TOUCH').
:- encoding(utf16le).\n:- shell('TOUCH').
/* */ :- shell('TOUCH').
%\r:- shell('TOUCH').
% \u2028:- shell('TOUCH').
"""
"""First lines of a file that a loader may skip and a reader may not."""

PASSED_OVER = r"""
:- dynamic(user:portray/1).
:- multifile(system:term_expansion/2).
:- discontiguous(shell('TOUCH')).
:- X.
"""
"""Declarations of predicates that belong to no grammar."""

NOTHING_DONE = r"""
:- use_module(library(clpr)).
:- discontiguous room_size/3.
% :- shell('TOUCH').
/* :- shell('TOUCH'). */
room_gap(G) :- { G = 0.6 }. % shell('TOUCH')
room_gap(G) :- half(H), G is 2*H.\nhalf(0.3).
"""
"""Text that looks like the above and is data."""


ESCAPES = {r"\n": "\n", r"\r": "\r", r"\ufeff": "\ufeff", r"\u2028": "\u2028"}


def _rows(text: str) -> list[str]:
    """Return the rows of a table, with their escapes replaced."""
    rows = text.strip("\n").split("\n")
    for escape, letter in ESCAPES.items():
        rows = [row.replace(escape, letter) for row in rows]
    return rows


def _first(text: str, yard: Yard) -> Path:
    """Write a text at the start of sizes.pl."""
    folder = grammar(yard)
    path = folder / "sizes.pl"
    before = path.read_text()
    if "room_gap(" in text:
        before = before.replace("room_gap(0.6).", "")
    path.write_text(yard.filled(text) + "\n" + before, newline="")
    return folder


def _case(kind: str, title: str, text: str, answers: tuple[str, ...] = (REFUSED,), says: str = "") -> Case:
    return Case(kind, titled(title), lambda yard: grammar(yard, sizes=text), answers, says)


CASES = [
    *(
        _case("Prolog: goals", goal, f"room_gap(G) :- {goal}, G = 0.6.", says="sizes.pl:")
        for goal in _rows(GOALS)
    ),
    *(
        _case(
            "Prolog: heads that legalise goals",
            f"{head} for {goal}",
            f"{head}.\nroom_gap(G) :- {goal}, G = 0.6.",
            says="sizes.pl:",
        )
        for head, _, goal in (row.partition("|") for row in _rows(HEADS))
    ),
    *(
        _case(
            "Prolog: hooks",
            f"{hook}, {how}",
            f"{hook}.\nroom_gap(G) :- {call}G = 0.6.",
            HARMLESS,
        )
        for hook in _rows(HOOKS)
        for how, call in (("stated", ""), ("called", f"{hook.partition(' :- ')[0]}, "))
    ),
    *(_case("Prolog: directives", text, text, says="sizes.pl:") for text in _rows(DIRECTIVES)),
    *(_case("Prolog: directives", text, text, HARMLESS) for text in _rows(PASSED_OVER)),
    *(
        Case(
            "Prolog: first lines",
            titled(text),
            lambda yard, text=text: _first(text, yard),
            HARMLESS if text[0] == "%" else (REFUSED,),
        )
        for text in _rows(FIRST_LINES)
    ),
    *(_case("Prolog: no code", text, text, (ACCEPTED,)) for text in _rows(NOTHING_DONE)),
    *(
        _case(
            "Prolog: quoted names",
            f"{name} in {where}",
            f"{where.replace('NAME', name)}",
            HARMLESS if name in {"[]", "{}"} else (REFUSED,),
        )
        for name in (
            "'b,shell(''TOUCH'')'",
            "'bed room'",
            "'\\e[2J'",
            "'Bed'",
            "''",
            "'a\\0\\b'",
            "'B:c'",
            "[]",
            "{}",
        )
        for where in (
            "room_size(NAME, W, D) :- { W = 3.0, D = 3.0 }.",
            "piece_size(NAME, W, D, _) :- { W = 1.0, D = 1.0 }.",
        )
    ),
]
