% Things in a row.
:- use_module('../../../logic/rules/chain').
:- use_module('../../../logic/rules/linear').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(chain).

three([block(A,1.0,[at_least(0.0)-[]],[]), block(B,2.0,[],[]), block(C,1.0,[at_most(9.0)-[]],[])], [A,B,C]).

drawn(Seed, Starts) :- three(Blocks, Starts), call(draw_chain(Blocks, 0.5), Seed, _).

test(what_is_drawn_keeps_the_constraints) :-
    forall(( between(1, 100, Seed), drawn(Seed, Starts) ),
           ( three(Blocks, Starts), phrase(chain_constraints(Blocks, 0.5), Constraints), posted(Constraints) )).
test(every_draw_succeeds, Count == 100) :- findall(x, ( between(1, 100, Seed), drawn(Seed, _) ), Xs), length(Xs, Count).
test(a_chain_too_long_fails, fail) :-
    call(draw_chain([block(_,1.0,[at_least(0.0)-[]],[]), block(_,1.0,[at_most(1.4)-[]],[])], 0.5), 1, _).
test(packed_it_asks_for_as_much_room_as_its_constraints, Low =:= High) :-
    chain(W, Blocks), phrase(packed_constraints(Blocks, 0.5, -1.0e9), Packed), posted(Packed), inf(W, Low),
    chain(V, Whole), phrase(chain_constraints(Whole, 0.5), All), posted(All), inf(V, High).
test(what_is_fixed_stands_there, [A,C] == [0.0,9.0]) :-
    Blocks = [block(A,1.0,[at(0.0)-[]],[]), block(_,2.0,[],[]), block(C,1.0,[at(9.0)-[]],[])],
    call(draw_chain(Blocks, 0.5), 3, _).

chain(W, [block(_,1.0,[at_least(0.25)-[],at_most(W-1.0)-[]],[]), block(_,2.0,[at_most(W-2.0)-[]],[])]).

:- end_tests(chain).
