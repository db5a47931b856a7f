% Reasons as a DCG describes them.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/room/reasons').
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(reasons).

test(an_atom_that_holds_is_a_reason, Why == [busy(left)]) :- phrase(holds(busy(left), [row(across),busy(left)]), Why).
test(it_binds_what_is_unknown_of_it, N-Why == 2-[last(left,2)]) :- phrase(holds(last(left,N), [last(back,1),last(left,2)]), Why).
test(an_atom_that_does_not_hold_is_none, fail) :- phrase(holds(busy(left), [busy(back)]), _).
test(that_an_atom_fails_is_a_reason, Why == [not(end(left))]) :- phrase(fails(end(left)), Why).
test(a_length_of_the_grammar_is_a_reason, P-Why == 0.4-[length(passage)]) :- phrase(required(passage, P), Why).
test(reasons_add_up, Why == [a,b,length(passage),not(c)]) :- phrase(( because([a,b]), required(passage, _), fails(c) ), Why).

:- end_tests(reasons).
