% The sizes of a room where furniture fills a wall from end to end.
:- use_module('../../../logic/rules/room/filled').
:- use_module('../../../logic/rules/room/furnish').
:- use_module('../../../logic/rules/room/solution').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/language/laws').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/room/records').
:- use_module('../../../logic/rules/room/room').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(filled).

law_with(Layout, Law) :-
    layout_room(cell, Layout, Room),
    room_law(cell, Law0),
    filled_law(Room, Law0, Law).

at_back(Count, [busy(back),end(back),last(back,Count)|Ons]) :-
    findall(Atom, ( between(1, Count, K), member(Atom, [on(crate,K,back,K),joined(crate,K)]) ), Ons).

in_corner([on(crate,1,left,1),busy(left),last(left,1),end(left),corner(left,back,left)|Ons]) :-
    findall(Atom, ( between(1, 3, N), K is N+1, member(Atom, [on(crate,K,back,N),joined(crate,K)]) ), Ons0),
    append(Ons0, [busy(back),end(back),last(back,3)], Ons).

test(a_filled_wall_is_as_long_as_its_pieces, [W1,W2] == [3.0,3.0]) :- at_back(3, L), law_with(L, box(W1,W2,_,_)).
test(what_stands_in_its_corner_counts_too, W1+W2 =:= 7.0) :- in_corner(L), law_with(L, box(W1,W2,_,_)), W1 =:= W2.
test(a_wall_that_its_pieces_can_never_fill_has_no_law, fail) :- at_back(2, L), law_with(L, _).
test(without_a_filled_wall_the_law_stays, Law == Law0) :-
    law_with([on(crate,1,back,1),busy(back),last(back,1)], Law), room_law(cell, Law0).
test(the_law_holds_every_room_that_solving_for_all_sizes_finds) :-
    forall(member(Goal, [at_back(3, L), in_corner(L)]),
           ( call(Goal), law_with(L, box(W1,W2,_,_)), whole_system(cell, L, Room, System),
             posted(System), room_width(Room, W), inf(W, Low), sup(W, High),
             W1 =< Low + 1.0e-9, High =< W2 + 1.0e-9 )).

:- end_tests(filled).
