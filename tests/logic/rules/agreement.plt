% Whether lengths can be used together: how thick walls are, and the widths of doors between types of rooms.
:- use_module('../../../logic/rules/agreement').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module(library(plunit)).

:- begin_tests(agreement).

%   stated(+Text): the grammar has the clauses of this text.

stated(Text) :-
    tmp_file_stream(File, Out, [extension(pl),encoding(utf8)]), write(Out, Text), nl(Out), close(Out),
    nb_setval(grammar_walls, shared), load_grammar([File], []), delete_file(File).

thickness(Text, Found) :- stated(Text), agreement:thickness_found(inner, Found).

test(a_thickness_is_a_number_of_metres, Found == 0.1) :- thickness("wall_thickness(inner, 0.1).", Found).
test(no_thickness_is_one_too, Found == 0) :- thickness("wall_thickness(inner, 0).", Found).
test(there_are_not_several, Found == fault(several)) :- thickness("wall_thickness(inner, 0.1).\nwall_thickness(inner, 0.2).", Found).
test(a_clause_without_a_solution_gives_none, Found == fault(empty)) :- thickness("wall_thickness(inner, M) :- M = 1, M = 2.", Found).
test(nothing_is_less_than_0_m_thick, Found == fault(not_metres)) :- thickness("wall_thickness(inner, -0.1).", Found).
test(no_wall_is_a_billion_metres_thick, Found == fault(too_large)) :- thickness("wall_thickness(inner, 1000000000).", Found).

pair(Text, Wrong) :- stated(Text), agreement:pair_wrong(false, [room(bath,_),room(hall,_)], Wrong).

test(a_width_is_stated_for_types_that_there_are, fail) :- pair("door_width(0.8).\ndoor_width(bath, outside, 0.7).", _).
test(a_type_that_there_is_not_is_named, Line-Text == 2-"door_width(bath, kitchen, 0.7): no room has the type kitchen") :-
    pair("door_width(0.8).\ndoor_width(bath, kitchen, 0.7).", wrong(_,Line,_,Text)).

:- end_tests(agreement).
