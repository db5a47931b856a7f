"""Grammars that would run for ever, or use all of the memory: each ends at a limit, or is refused before."""

from tests.hostile.case import HARMLESS, STOPPED, Case, grammar, titled

CLINGO = {
    "an interval": "big(0..2147483647).",
    "an interval in a body": ":- X = 0..1000000000, rooms = X.",
    "an interval that starts low": "big(-2147483648..2147483647).",
    "a join of a type": "n(1..3000). j(A,B) :- n(A), n(B).",
    "a join in an aggregate": "n(1..3000). :- #count{ A,B : n(A), n(B), A*B != 0 } < 7, room(_,hall).",
    "a join in a condition": "n(1..3000). :- n(A) : n(B), A < B, n(C); rooms = 9.",
    "numbers that recur": "n(0). n(X+1) :- n(X).",
    "terms that recur": "t(a). t(f(X)) :- t(X).",
    "terms that double": "t(a). t(f(X,X)) :- t(X).",
    "terms of two that recur": "t(a,b). t(f(X,Y),g(Y,X)) :- t(X,Y).",
    "strings of strings": 't("x"). t((X,X)) :- t(X).',
    "a pool of pools": f"p({','.join(30 * ['(a;b)'])}).",
    "a pool in a body": f":- p({','.join(30 * ['(a;b)'])}), room(_,hall).",
    "an option of many values": "option(x,1..40000,1).",
    "many options": "option(x(1..40000),(a;b),1).",
    "pigeons in holes": ("option(at(P),1..11,1) :- P = 1..12. :- pick(at(P),H), pick(at(Q),H), P < Q."),
    "a sum of large weights": ":- #sum{ 2147483647,R : room(R,_); 2147483647,a; 2147483647,b } > 5.",
    "very many facts": "".join(f"f({n})." for n in range(5000)),
    "very many rules": "".join(f":- room({n},hall), room({n},bedroom)." for n in range(200)),
    "rules that differ in a variable": "".join(f"a{n}(X) :- type(X)." for n in range(200)),
    "very many programs": "#program house. #program room.\n" * 500,
    "a very long rule": f":- {','.join(f'room({n},hall)' for n in range(2000))}.",
    "brackets in brackets": f"b({'(' * 50_000}1{')' * 50_000}).",
    "functions in functions": f"b({'f(' * 200_000}1{')' * 200_000}).",
    "not not not": f":- {'not ' * 3000}room(1,hall).",
    "a long name": f"{'a' * 20_000}.",
    "a long string": f'note("{"a" * 3_000_000}").',
    "an unclosed string": 'note("' + "a\n" * 300_000,
    "blanks": " \n" * 100_000,
    "an unclosed comment": "%* " * 200_000,
}
"""Text that is added to ``rooms.lp``."""

PROLOG = {
    "a loop": "room_gap(G) :- room_gap(G).",
    "a loop of two": "room_gap(G) :- a(G). a(G) :- b(G). b(G) :- a(G).",
    "a loop that grows": "room_gap(G) :- grow([], G). grow(L, G) :- grow([x|L], G).",
    "a loop that leaves choices": "room_gap(G) :- grow(G), G > 0.5. grow(0.6). grow(G) :- grow(G).",
    "a deep recursion": "room_gap(G) :- sum(1000000000, G). sum(0, 0.6). "
    "sum(N, S) :- N > 0, M is N-1, sum(M, T), S is T.",
    "counting without end": "room_gap(G) :- between(1, inf, X), X < 0, G = 0.6.",
    "counting for long": "room_gap(G) :- between(1, 1000000000000, X), X < 0, G = 0.6.",
    "counting of counting": "room_gap(G) :- "
    + "".join(f"between(1, 1000, X{n}), " for n in range(9))
    + "X8 < 0, G = 0.6.",
    "Fibonacci": "room_gap(G) :- f(40, G). f(0, 1). f(1, 1). "
    "f(N, F) :- N > 1, A is N-1, B is N-2, f(A, X), f(B, Y), F is X+Y.",
    "Ackermann": "room_gap(G) :- a(4, 2, G). a(0, N, R) :- R is N+1. "
    "a(M, 0, R) :- M > 0, K is M-1, a(K, 1, R). "
    "a(M, N, R) :- M > 0, N > 0, K is M-1, J is N-1, a(M, J, S), a(K, S, R).",
    "doubling terms": "room_gap(G) :- d(60, x, T), T == y, G = 0.6. "
    "d(0, T, T). d(N, T, U) :- N > 0, M is N-1, d(M, f(T,T), U).",
    "a tower of powers": "room_gap(G) :- G is 7**(7**(7**7)).",
    "a power": "room_gap(G) :- G is 2**100000000000.",
    "a shift": "room_gap(G) :- G is 1 << (1 << 40).",
    "products that grow": "room_gap(G) :- p(60, 3, G). "
    "p(0, G, G). p(N, X, G) :- N > 0, Y is X*X, M is N-1, p(M, Y, G).",
    "a cyclic term": "room_gap(G) :- X = f(X), X == f(X), G = 0.6.",
    "two cyclic terms": "room_gap(G) :- X = f(X,Y), Y = f(Y,X), X = Y, G is X.",
    "a cyclic number": "room_gap(G) :- X = 1+X, G is X.",
    "a cyclic constraint": "room_gap(G) :- X = 1+X, { G = X }.",
    "a cyclic list": "room_gap(G) :- L = [a|L], member(b, L), G = 0.6.",
    "many constraints": "room_gap(G) :- c(3000, G). c(0, 0.6). "
    "c(N, G) :- N > 0, { X >= G, X =< G + N, Y = X + G }, M is N-1, c(M, Y).",
    "constraints without end": "room_gap(G) :- { X = G + 1.0 }, room_gap(X).",
    "a product of unknowns": "room_gap(G) :- { G * G * G = 0.2, G * X = X * X, X ** G = G }.",
    "choices without end": "room_size(bedroom, W, D) :- n(W), { D = W }, W > 9.0e9. "
    "n(1.0). n(X) :- n(Y), X is Y+1.",
    "very many choices": "room_size(bedroom, W, D) :- "
    + "".join(f"member(X{n}, [1,2,3,4,5,6,7,8,9]), " for n in range(12))
    + "X0 > X1, X1 > 9, { W = 3.3, D = W }.",
    "a size for each number": "".join(
        f"room_size(bedroom, W, D) :- {{ W = {3 + n / 1e6}, D = W }}.\n" for n in range(3000)
    ),
    "very many clauses": "".join(f"a{n}(1).\n" for n in range(1000)),
    "alternatives in alternatives": "room_gap(G) :- "
    + "(" * 3000
    + "true"
    + " ; true)" * 3000
    + ", G = 0.6.",
    "a very long body": "room_gap(G) :- " + "G > 0, " * 3000 + "G = 0.6.",
    "brackets in brackets": "room_gap(" + "(" * 200_000 + "0.6" + ")" * 200_000 + ").",
    "functions in functions": "room_gap(" + "f(" * 1_000_000 + "0.6" + ")" * 1_000_000 + ").",
    "lists in lists": "room_gap(" + "[" * 500_000 + "]" * 500_000 + ").",
    "braces in braces": "room_gap(G) :- " + "{" * 100_000 + "G = 0.6" + "}" * 100_000 + ".",
    "signs": "room_gap(G) :- G is " + "- " * 100_000 + "0.6.",
    "a sum of many": "room_gap(G) :- { G = 0.6" + " + 0" * 3000 + " }.",
    "a long number": f"room_gap({'9' * 100_000}).",
    "a long fraction": f"room_gap(0.{'9' * 100_000}).",
    "a long name": f"{'a' * 20_000}.",
    "an unclosed quote": "a('" + "x\\\n" * 300_000,
    "an unclosed comment": "/* " * 3000,
    "an unclosed bracket": "a(" * 100_000,
    "commas": "room_gap(G) :- " + ", " * 100_000 + ".",
    "many singletons": "a(" + ",".join(f"Xx{n}" for n in range(200)) + ").",
    "names that are alike": "".join(f"room_sizf{n}(a{n}, 1, 1).\n" for n in range(200)),
    "many variables": "room_gap(G) :- " + "".join(f"X{n} = Y{n}, " for n in range(1000)) + "G = 0.6.",
}
"""Text that is added to ``sizes.pl``."""

FAST = {
    *("a sum of large weights", "very many rules", "not not not", "a long string", "blanks", "a cyclic term"),
    *("many constraints", "a product of unknowns", "a size for each number", "alternatives in alternatives"),
    *(
        "a very long body",
        "signs",
        "a sum of many",
        "brackets in brackets",
        "many variables",
        "very many programs",
    ),
    *(
        "a shift",
        "a long fraction",
        "a long number",
        "very many clauses",
        "many options",
        "an option of many values",
        "pigeons in holes",
        "very many facts",
        "a very long rule",
    ),
}
"""Cases to which a house may be the answer after all."""

ENDING = {
    *("clingo: a join in an aggregate", "clingo: a pool of pools", "clingo: a pool in a body"),
    *("clingo: pigeons in holes", "clingo: very many rules", "clingo: functions in functions"),
    *("Prolog: products that grow", "Prolog: brackets in brackets", "Prolog: functions in functions"),
    *("Prolog: lists in lists", "Prolog: braces in braces", "Prolog: signs"),
}
"""Cases that reading does not refuse by itself. They take the time, the memory or the life of the process, so
a solver process reads them. With very many rules, the report of useless ones takes long."""

CASES = [
    Case(
        f"{language}: bombs",
        titled(title),
        lambda yard, file=file, base=base, text=text: grammar(yard, **{file: f"\n{base}{text}"}),
        HARMLESS if title in FAST else STOPPED,
    )
    for language, file, base, table in (
        ("clingo", "rooms", "#program house.\n", CLINGO),
        ("Prolog", "sizes", "", PROLOG),
    )
    for title, text in table.items()
]

ENDED = [case for case in CASES if f"{case.kind.partition(':')[0]}: {case.title}" in ENDING]
READ = [case for case in CASES if case not in ENDED]
