% A grammar's files as they are written, and what stands in braces and is no linear constraint.
:- use_module('../../../logic/rules/language/braces').
:- use_module('../../../logic/rules/language/written').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

%   terms(+Text, -Terms): of a file with this text.

terms(Text, Terms) :-
    tmp_file_stream(File, Out, [extension(pl),encoding(utf8)]), write(Out, Text), close(Out),
    written_terms([File], Terms),
    delete_file(File).

:- begin_tests(written).

kind(term(_,_,Kind), Name) :- functor(Kind, Name, _).

test(terms_have_their_kind, Names == [clause,clause,directive,error,error]) :-
    terms("a(1).\na(X) :- { X = 1 }.\n:- b.\na --> b.\na(X) => b(X).", Terms), maplist(kind, Terms, Names).
test(reading_goes_on_after_a_syntax_error, Names == [syntax,clause]) :- terms("a(b c).\nd.", Terms), maplist(kind, Terms, Names).
test(a_syntax_error_is_placed_in_its_own_line, Line/Column == 3/1) :-
    terms("a(1)\n% so\nb(2).", [term(Source,P,syntax(_))]), place(Source, P, Line, Column).
test(an_end_without_a_full_stop_is_placed_in_the_file, Line/Column == 1/5) :-
    terms("a(1)", [term(Source,P,syntax(end_of_file))]), place(Source, P, Line, Column).
test(places_count_letters, Line/Column == 2/5) :-
    terms("% größer\n    a(1).", [term(Source,P,_)]), place(Source, P, Line, Column).
test(words_stand_on_one_line, Words == "X >= 1 + 2") :-
    terms("a(X) :- { X >= 1 +\n   2 }.", [term(Source,_,clause(_,{_},_,brace_term_position(_,_,P),_,_))]), wording(Source, P, Words).
test(goals_stand_under_control_constructs, Goals == [b,c,d,e,f,g]) :-
    terms("a :- b, ( c -> d ; \\+ e ), once(( f, g )).", [term(_,_,clause(_,Body,_,P,_,_))]),
    findall(Goal, goal_in(Body, P, Goal, _), Goals).
test(each_goal_has_its_place, Columns == [6,11,15]) :-
    terms("a :- b, ( c , d ).", [term(Source,_,clause(_,Body,_,P,_,_))]),
    findall(Column, ( goal_in(Body, P, _, At), place(Source, At, 1, Column) ), Columns).
test(parts_are_found_by_their_place, Column == 19) :-
    terms("a(X) :- { X >= 2, Y =< X }.", [term(Source,_,clause(_,Body,_,P,Names,_))]),
    memberchk('Y'=Y, Names), once(( part(Body, P, Part, At), Part == Y )), place(Source, At, 1, Column).

:- end_tests(written).

:- begin_tests(braces).

%   faults(+Constraints, -Faults): Column-Text of a clause's, counted from the brace.

faults(Constraints, Faults) :-
    format(string(Text), "{~w}.", [Constraints]),
    terms(Text, [term(Source,P,clause({C},_,_,_,Names,_))]),
    P = brace_term_position(_,_,Inner),
    findall(Column-Said, ( constraint_fault(Source, Names, C, Inner, At-Said), place(Source, At, 1, Column0), Column is Column0-1 ), Faults).

test(linear_constraints_have_no_fault) :-
    forall(member(C, ["W >= 3", "W > 3, W < D", "(W =< 3, D = 2*W)", "W =:= -D + 2/3*E - (+1.0)", "W = 1 ; W = 2"]), faults(C, [])).
test(what_is_not_linear_is_found_when_it_is_run, Faults == []) :- faults("W*D =< 12, W/D >= 1, W^2 = 4, sin(W) = 1", Faults).
test(a_decimal_comma_is_one_fault, Faults == [6-"4,6 is read as two terms: write 4.6"]) :- faults("W =< 4,6", Faults).
test(a_decimal_comma_in_a_product, Faults == [6-"0,50 is read as two terms: write 0.50"]) :- faults("W >= 0,50*D", Faults).
test(two_decimal_commas, Columns == [6,16]) :- faults("W >= 2,4, W =< 4,6", Faults), findall(C, member(C-_, Faults), Columns).
test(a_number_that_is_no_part_of_one_is_no_constraint, Text == "3 is not a constraint: state a bound by =<, >= or =") :- faults("W =< D, 3", [9-Text]).
test(every_fault_is_found, Columns == [1,9,19]) :- faults("V, W >= \"3\", D =< wide", Faults), findall(C, member(C-_, Faults), Columns).
test(a_relation_of_another_language_is_named_with_the_one_meant) :-
    forall(member(Said-Meant, ["<="-"=<","=>"-">=","≤"-"=<","≥"-">=","=="-"=","is"-"=","#>="-">="]),
           ( format(string(C), "W ~w 3", [Said]), faults(C, [3-Text]), format(string(Text), "~w is not a constraint: write ~w", [Said, Meant]) )).
test(a_name_is_compared_with_the_variables, Text == "w is a name, not a number: did you mean the variable W?") :- faults("W =< 3, w >= 2", [9-Text]).
test(whatever_its_other_letters, true(sub_string(Text, _, _, 0, "did you mean the variable WallSide?"))) :-
    faults("WallSide =< 3, wallSide >= 2", [16-Text]).

:- end_tests(braces).
