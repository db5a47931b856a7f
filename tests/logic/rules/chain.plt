% Things in a row.
:- use_module('../../../logic/rules/linear/chain').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/linear').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(chain).

three([block(A,1.0,[at_least(0.0)-[]],[]), block(B,2.0,[],[]), block(C,1.0,[at_most(9.0)-[]],[])], [A,B,C]).

starts(Seed, Starts) :- three(Blocks, Starts), call(chain_sample(Blocks, 0.5), Seed, _).

in_width(W, [block(_,1.0,[at_least(0.25)-[],at_most(W-1.0)-[]],[]), block(_,2.0,[at_most(W-2.0)-[]],[])]).

test(a_sample_satisfies_the_constraints) :-
    forall(( between(1, 100, Seed), starts(Seed, Starts) ),
           ( three(Blocks, Starts), phrase(chain_constraints(Blocks, 0.5), Constraints), posted(Constraints) )).
test(every_sample_succeeds, Count == 100) :- findall(x, ( between(1, 100, Seed), starts(Seed, _) ), Xs), length(Xs, Count).
test(where_the_others_let_it_a_block_starts_as_it_wishes, Starts == [3.0,5.0]) :-
    findall(S, ( member(Wish, [3.0,20.0]), call(all_chains_sample([[block(S,1.0,[at_least(0.0)-[],wish(Wish)-[]],[]),
                                                                    block(T,2.0,[],[]), block(_,1.0,[at_most(9.0)-[]],[])]], 0.5), 1, _),
                 number(T) ), Starts).
test(a_wish_is_no_constraint, Constraints == []) :- phrase(chain_constraints([block(_,1.0,[wish(3.0)-[]],[])], 0.5), Constraints).
test(samples_reach_both_ends, true(( Least < 0.5, Most > 8.5 ))) :-
    findall(A-C, ( between(1, 200, Seed), starts(Seed, [A,_,C]) ), Pairs),
    findall(A, member(A-_, Pairs), As), min_list(As, Least),
    findall(C, member(_-C, Pairs), Cs), max_list(Cs, Most).
test(evenly_it_is_as_far_from_each_start_to_the_next) :-
    forall(between(1, 100, Seed),
           ( three(Blocks, [A,B,C]), call(chain_sample(even(Blocks), 0.5), Seed, _),
             abs((B-A) - (C-B)) < 1.0e-9, B-A >= 2.5 - 1.0e-6, A >= -1.0e-6, C =< 9.0 + 1.0e-6 )).
test(evenly_the_longest_needs_its_room_at_each, fail) :-
    Blocks = [block(_,1.0,[at_least(0.0)-[]],[]), block(_,2.0,[],[]), block(_,1.0,[at_most(4.9)-[]],[])],
    call(chain_sample(even(Blocks), 0.5), 1, _).
test(an_empty_chain_takes_no_random_number, State == 7) :- call(chain_sample([], 0.5), 7, State).
test(an_empty_chain_has_no_constraint, Constraints == []) :- phrase(chain_constraints([], 0.5), Constraints).
test(a_chain_too_long_has_no_sample, fail) :-
    call(chain_sample([block(_,1.0,[at_least(0.0)-[]],[]), block(_,1.0,[at_most(1.4)-[]],[])], 0.5), 1, _).
test(a_chain_that_just_fits_has_one_place, [A,B] == [0.0,1.5]) :-
    call(chain_sample([block(A,1.0,[at(0.0)-[]],[]), block(B,1.0,[at(1.5)-[]],[])], 0.5), 1, _).
test(packed_it_needs_as_much_room_as_its_constraints, Low =:= High) :-
    in_width(W, Blocks), phrase(packed_constraints(Blocks, 0.5, -1.0e9), Packed), posted(Packed), inf(W, Low),
    in_width(V, Whole), phrase(chain_constraints(Whole, 0.5), All), posted(All), inf(V, High).
test(packed_no_start_is_unknown) :-
    in_width(W, Blocks), phrase(packed_constraints(Blocks, 0.5, -1.0e9), Packed),
    term_variables(Packed, Unknown), Unknown == [W].
test(what_is_fixed_stands_there, [A,C] == [0.0,9.0]) :-
    Blocks = [block(A,1.0,[at(0.0)-[]],[]), block(_,2.0,[],[]), block(C,1.0,[at(9.0)-[]],[])],
    call(chain_sample(Blocks, 0.5), 3, _).
test(a_gap_is_kept_for_its_reasons, Constraints == [(A+1.0+0.5 =< B)-[why]]) :-
    phrase(chain_constraints([block(A,1.0,[],[]), block(B,1.0,[],[why])], 0.5), Constraints).
test(each_bound_is_a_constraint_with_its_reasons, Constraints == [(0 =< A)-[x], (A =< 5)-[y], (A = 3)-[z]]) :-
    phrase(chain_constraints([block(A,1.0,[at_least(0)-[x],at_most(5)-[y],at(3)-[z]],[])], 0.5), Constraints).
test(several_chains_are_sampled_one_by_one, true(( number(A), number(B), S == S1 ))) :-
    One = [block(A,1.0,[at_least(0.0)-[],at_most(2.0)-[]],[])], Two = [block(B,1.0,[at_least(0.0)-[],at_most(2.0)-[]],[])],
    call(all_chains_sample([One,Two], 0.5), 5, S),
    copy_term(One-Two, [block(_,_,Bs,_)]-[block(_,_,Cs,_)]),
    call(chain_sample([block(_,1.0,Bs,[])], 0.5), 5, S0), call(chain_sample([block(_,1.0,Cs,[])], 0.5), S0, S1).
test(on_a_grid_starts_are_whole, [setup(set_cell(1.0)), cleanup(set_cell(0))]) :-
    forall(between(1, 50, Seed),
           ( Blocks = [block(A,1,[at_least(0)-[]],[]), block(B,2,[at_most(6)-[]],[])],
             call(chain_sample(Blocks, 1), Seed, _), integer(A), integer(B), B >= A + 2 )).

:- end_tests(chain).
