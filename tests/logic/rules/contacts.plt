% Which rooms share a wall: they overlap along it, or one of them ends before the other begins.
:- use_module('../../../logic/rules/shared_walls/contacts').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(contacts).

%   holds(+How, +A1-A2, +B1-B2): rooms from A1 to A2 and from B1 to B2 lie so along their wall.

holds(How, A, B) :-
    phrase(contacts:contact_constraints(How, A, B, 0.1, [contact]), Constraints),
    forall(member(Constraint-Why, Constraints), ( Why == [contact], {Constraint} )).

test(rooms_share_a_wall_that_overlap_along_it_by_the_least_contact) :- holds(share, 0-2, 1.9-3), holds(share, 1.9-3, 0-2).
test(rooms_that_overlap_by_less_share_none, fail) :- holds(share, 0-2, 1.95-3).
test(rooms_that_overlap_by_less_share_none_the_other_way, fail) :- holds(share, 1.95-3, 0-2).
test(a_room_is_before_another_that_begins_where_it_ends) :- holds(before, 0-2, 2-3).
test(a_room_is_not_before_another_that_begins_in_it, fail) :- holds(before, 0-2, 1.9-3).
test(a_room_is_after_another_that_ends_where_it_begins) :- holds(after, 2-3, 0-2).
test(a_room_is_not_after_another_that_ends_in_it, fail) :- holds(after, 1.9-3, 0-2).

:- end_tests(contacts).
