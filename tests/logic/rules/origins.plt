% Where the grammar's clauses stand.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/language/origins').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(origins).

lines(Clauses, Lines) :-
    clause_origins(Clauses, Origins),
    findall(Text-Line, ( member([Text,File,Line], Origins), file_base_name(File, 'grammar.pl') ), Lines).

test(a_length_is_found_by_its_line, Lines == ["length(passage)"-5]) :- lines([length(passage)], Lines).
test(the_size_of_a_room_is_found, Lines == ["size(square)"-9]) :- lines([size(square)], Lines).
test(the_size_of_a_piece_does_not_depend_on_the_room, Lines == ["size(cell,beam)"-13,"size(wide,beam)"-13]) :-
    lines([size(cell,beam),size(wide,beam)], Lines).
test(what_the_grammar_does_not_state_is_left_out, Lines == ["length(passage)"-5]) :- lines([size(hall),length(passage),size(cell,lamp)], Lines).
test(nothing_has_no_origin, Lines == []) :- lines([], Lines).
test(every_clause_of_a_named_type_is_listed, Names == [cell,square,wide,closet]) :-
    size_clauses(Clauses), findall(Name, member([room_size,Name|_], Clauses), Names).
test(pieces_are_listed_with_their_lines_and_columns, true(memberchk([crate,12,1], Found))) :-
    size_clauses(Clauses), findall([Name,Line,Column], member([piece_size,Name,_,Line,Column], Clauses), Found).

:- end_tests(origins).
