"""Grammars whose .lp files try to run code, to read other files, or to change what the core derives."""

from tests.hostile.case import HARMLESS, REFUSED, Case, grammar, titled

CODE = r"""
#script(lua) os.execute("TOUCH") #end.
#script (lua) function main(p) os.execute("TOUCH") end #end.
#script(python) import os; os.system("TOUCH") #end.
#script (python)\nimport socket\nsocket.create_connection(("127.0.0.1", PORT))\n#end.
#script(python) open("TRACE", "w").close()
#script(prolog) shell('TOUCH') #end.
#script\n(lua)\nos.execute("TOUCH")\n#end.
#script(lua) %*\nos.execute("TOUCH")\n*% #end.
#end.
type(@shell("TOUCH")).
type(@os_system("TOUCH")).
:- rooms = @exit(0).
option(x, @random(), 1).
#const n = @f(1).
&shell{ "TOUCH" }.
&sum{ x } >= 1.
#theory t { term { }; &shell/0 : term, any }.
#theory csp { linear { + : 1, binary, left }; &sum/0 : linear, {<=}, linear, head }.
"""

READS = r"""
#include "/etc/passwd".
#include "SECRET".
#include "../../canary/secret.lp".
#include <incmode>.
#include <iclingo>.
#include "rooms.lp".
#include\n\n"SECRET".
#include%* *%"SECRET".
# include "SECRET".
%* #include "x". *% #include "SECRET".
x("%"). #include "SECRET".
x("\""). #include "SECRET".
x("\\"). #include "SECRET". y("").
x("\"%"). #include "SECRET".
x("\\\"%"). #include "SECRET".
%* %* *% #include "SECRET". *%
%*%*% #include "SECRET".
x("a"). % "\n#include "SECRET".
#include "/dev/stdin".
#include "/dev/zero".
#include "/proc/self/environ".
#include "http://localhost:PORT/".
"""

DIRECTIVES = r"""
#external room(1,bedroom).
#external a : type(T). [true]
#program check(t).
#program pick.
#program house(x).
#program base(t).
#program core.
#const rooms = 99.
#const rooms = 0. [override]
#const this_room = bedroom. [override]
#show.
#show room/2.
#show x : type(T).
#show $shell/1.
#project room/2.
#heuristic room(1,bedroom). [9@9, true]
#heuristic pick(V,X) : option(V,X,_). [1, level]
#edge (A,B) : room(A,bedroom), room(B,bedroom).
#minimize { 1,R : room(R,_) }.
#maximize { 1@2,R : room(R,_) }.
:~ room(R,_). [1@1,R]
#parts base.
#unknown x.
#false.
#inf.
"""

CORE = r"""
{ room(1,bedroom) }.
{ room(R,T) : type(T) } = 1 :- R = 1..rooms.
room(1,bedroom) ; room(1,hall).
a | b.
1 { x(1..9) } 1.
#sum { 1,x : x } 2.
room(0,bathroom).
side(1,north).
-room(1,bedroom).
pick(a,b).
picks(a,b).
option(x,a,1) :- pick(x,a).
:- pick(V,X).
on(bed,1,back,1) :- room(1,bedroom).
granted(x).
wrong(a,"b").
twice(a,b).
placed(1).
rooms(9).
basic(T) :- not type(T).
x :- not x.
a :- not b. b :- not a.
a :- not b, not c. b :- not a, not c. c :- not a, not b.
a(X) :- not b(X), type(X). b(X) :- not a(X), type(X).
room :- not not room.
"""

NAMES = r"""
"bedroom"
"x), shell('TOUCH'), y("
"'), shell('TOUCH'), ('"
"\\'"
"\n:- shell('TOUCH').\n"
f(x)
(bedroom,1)
(,)
-bedroom
1
-2147483648
#inf
#sup
bed'
x''y
_bed
_
__B
'
bed"
Bed
beD'shell
shell("TOUCH")
1..3
@x
not
bed room
bed;shell
"""
"""Names of a type and of a piece that SWI-Prolog would read as more than a name."""

STATEMENTS = (
    "type(NAME). may(NAME,bed,0,1).",
    "may(bedroom,NAME,0,1). stands(NAME,back).",
    "beside(bed,NAME,0,1). turns(NAME,back).",
)

WEIGHTS = r"""
0
-1
99999999999
2147483647
2147483648
-2147483648
18446744073709551616
1\0
1/0
2**31
2**2**2**2**2
1-2147483649
0x7fffffffffffffff
#sup
x
"1"
(1,2)
"""
"""Numbers of a fact: ``may(bedroom,lamp,0,N)`` and ``option(x,a,N)``."""

HARMLESS_FACTS = r"""
#true.
#defined pick/2.
#defined type/1.
% #script(lua) os.execute("TOUCH") #end.
%* #include "SECRET". *%
note("#script(lua) os.execute() #end.").
note("shell('TOUCH')").
note("#include SECRET").
shell("TOUCH").
halt.
goal_expansion(true,shell("TOUCH")).
:- shell(X), X = 1.
"""


def _rows(text: str) -> list[str]:
    return [row.replace(r"\n", "\n") for row in text.strip("\n").split("\n")]


def _cases(
    kind: str, texts: list[str], answers: tuple[str, ...] = (REFUSED,), says: str = "rooms.lp:"
) -> list[Case]:
    return [
        Case(
            kind,
            titled(text),
            lambda yard, text=text: grammar(yard, rooms=f"\n#program base.\n{text}"),
            answers,
            says,
        )
        for text in texts
    ]


CASES = [
    *_cases("clingo: scripts and functions", _rows(CODE)),
    *_cases("clingo: other files", _rows(READS)),
    *_cases("clingo: directives", _rows(DIRECTIVES)),
    *_cases("clingo: rules of the core", _rows(CORE), HARMLESS, ""),
    *_cases(
        "clingo: names",
        [statement.replace("NAME", name) for name in _rows(NAMES) for statement in STATEMENTS],
        says="",
    ),
    *_cases(
        "clingo: numbers",
        [
            statement.replace("N", number)
            for number in _rows(WEIGHTS)
            for statement in ("may(bedroom,bedside,0,N).", "may(bedroom,sofa,N,2).", "option(x,a,N).")
        ],
        HARMLESS,
        "",
    ),
    *_cases("clingo: no code", _rows(HARMLESS_FACTS), HARMLESS, ""),
    *_cases(
        "clingo: numbers",
        [f"big({'9' * 5000}).", f"big({'1+' * 20_000}1).", f"big({'-' * 20_000}1)."],
        HARMLESS,
        "",
    ),
]
