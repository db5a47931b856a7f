% Records: their fields by name, and calls of them as unifications.
:- use_module('../../../logic/rules/room/record_access').
:- use_module('../../../logic/rules/room/records').
:- use_module(library(plunit)).

out_of_link(Link, Out) :- link_out(Link, Out).

made_island(Front, Island) :- make_island([front(Front),seats([])], Island).

:- begin_tests(records).

test(a_field_is_read_by_its_name, Out == 5) :- link_out(link(1,2,3,4,5,6,7,8), Out).
test(what_is_not_given_is_unbound, true(( Front-Seats == left-[], var(Item) ))) :-
    make_island([front(left),seats([])], Island), island_front(Island, Front), island_seats(Island, Seats), island_item(Island, Item).
test(a_call_is_compiled_to_a_unification, Body == true) :-
    clause(out_of_link(Link, Out), Body0), ( Body0 = (Link = Term) -> true ; Term = Link, Body0 = true ),
    Term = link(_,_,_,_,Field,_,_,_), Field == Out, Body = true.
test(so_is_the_call_that_makes_a_record) :-
    clause(made_island(Front, Island), Body), ( Body = (Island = Term) -> true ; Term = Island ),
    arg(7, Term, Field), Field == Front.
test(a_call_that_is_not_known_when_compiled_works_too, Gap == apart) :-
    Predicate = link_gap, call(Predicate, link(apart,_,_,_,_,_,_,_), Gap).
test(a_field_of_another_record_does_not_fit, fail) :- link_out(room(_,_,_,_,_,_,_,_), _).

:- end_tests(records).
