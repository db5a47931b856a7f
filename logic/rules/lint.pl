:- module(lint, [file_problems/2]).

/** <module> What is wrong with a grammar's .pl files, found without loading them

A file holds the clauses of room_size/3, piece_size/4 and the named lengths, and of predicates of its own that these
call: CLP(R) constraints, arithmetic, comparison, unification, control. Nothing else is run.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(prolog_source)).
:- use_module(library(clpr)).

%!  file_problems(+Files, -Problems) is det.
%
%   Problems are problem(File,Line,Column,Text), in order, for what a grammar's file must not hold.

file_problems(Files, Problems) :-
    maplist(file_terms, Files, Each),
    append(Each, Terms),
    maplist(term_head, Terms, Heads0), append(Heads0, Heads),
    findall(Called, called_by(Terms, Called), Calls),
    maplist(problems(Heads, Calls), Terms, Found),
    append(Found, Problems).

%   file_terms(+File, -Terms): term(File,Line,Column,Kind) with Kind clause(Head,Body), directive(Goal), error(Text).

file_terms(File, Terms) :-
    setup_call_cleanup(open(File, read, In, [encoding(utf8)]), stream_terms(In, File, Terms), close(In)).

stream_terms(In, File, Terms) :-
    catch(read_term(In, Term, [module(lint), term_position(Position), subterm_positions(Places), syntax_errors(error)]),
          error(syntax_error(What), Where), true),
    (   nonvar(What)
    ->  error_place(Where, Line, Column),
        format(string(Text), "syntax error: ~w", [What]),
        Terms = [term(File,Line,Column,error(Text))|Rest],
        stream_terms(In, File, Rest)
    ;   Term == end_of_file
    ->  Terms = []
    ;   stream_position_data(line_count, Position, Line),
        stream_position_data(line_position, Position, Before),
        Column is Before + 1,
        kind(Term, Places, Kind),
        Terms = [term(File,Line,Column,Kind)|Rest],
        stream_terms(In, File, Rest) ).

error_place(stream(_,Line,Before,_), Line, Column) :- !, Column is Before + 1.
error_place(file(_,Line,Before,_), Line, Column)   :- !, Column is Before + 1.
error_place(_, 1, 1).

kind((:- Goal), _, directive(Goal))            :- !.
kind((?- Goal), _, directive(Goal))            :- !.
kind((_ --> _), _, error("a grammar has no DCG rules")) :- !.
kind((Head :- Body), _, clause(Head,Body))     :- !.
kind(Head, _, clause(Head,true)).

term_head(term(_,_,_,clause(Head,_)), [Name/Arity]) :- callable(Head), !, functor(Head, Name, Arity).
term_head(_, []).

called_by(Terms, Name/Arity) :-
    member(term(_,_,_,clause(Head,Body)), Terms),
    goal_in(Body, Goal), callable(Goal),
    functor(Goal, Name, Arity),
    \+ functor(Head, Name, Arity).

%   goal_in(+Body, -Goal): the goals of a body, those under control constructs one by one.

goal_in(Goal, Goal)  :- var(Goal), !.
goal_in((A,B), Goal) :- !, ( goal_in(A, Goal) ; goal_in(B, Goal) ).
goal_in((A;B), Goal) :- !, ( goal_in(A, Goal) ; goal_in(B, Goal) ).
goal_in((A->B), Goal) :- !, ( goal_in(A, Goal) ; goal_in(B, Goal) ).
goal_in(\+ A, Goal)  :- !, goal_in(A, Goal).
goal_in(once(A), Goal) :- !, goal_in(A, Goal).
goal_in(Goal, Goal).

% - judging ------------------------------------------------------------------

role(room_size/3).   role(piece_size/4).
role(door_width/1).  role(door_clearance/1).  role(passage/1).  role(room_gap/1).

problems(Heads, Calls, term(File,Line,Column,Kind), Problems) :-
    findall(problem(File,Line,Column,Text), problem(Kind, Heads, Calls, Text), Problems).

problem(error(Text), _, _, Text).
problem(directive(Goal), _, _, Text) :-
    \+ harmless(Goal),
    format(string(Text), "a directive runs code when the file is read: ~p. A grammar holds clauses alone", [Goal]).
problem(clause(Head,_), _, _, "a clause without a name") :- \+ callable(Head), !.
problem(clause(Head,_), Heads, Calls, Text) :-
    functor(Head, Name, Arity),
    \+ role(Name/Arity), \+ memberchk(Name/Arity, Calls),
    findall(Known, ( role(Known) ; member(Known, Heads), Known \== Name/Arity ), Others),
    meant(Name/Arity, Others, Hint),
    format(string(Text), "nothing uses ~w/~w~w", [Name, Arity, Hint]).
problem(clause(_,Body), Heads, _, Text) :-
    goal_in(Body, Goal),
    bad_goal(Goal, Heads, Text).

harmless(use_module(library(clpr))).
harmless(use_module(library(clpr), _)).
harmless(discontiguous(_)).
harmless(dynamic(_)).
harmless(multifile(_)).

bad_goal(Goal, _, "a goal that is not known until it is run") :- var(Goal), !.
bad_goal(Goal, Heads, Text) :-
    functor(Goal, Name, Arity),
    \+ memberchk(Name/Arity, Heads), \+ role(Name/Arity), \+ pure(Name/Arity),
    (   predicate_property(user:Goal, defined)
    ->  format(string(Text), "~w/~w runs code: a clause holds CLP(R) constraints, arithmetic and comparison",
               [Name, Arity])
    ;   findall(Known, ( role(Known) ; member(Known, Heads) ), Others),
        meant(Name/Arity, Others, Hint),
        format(string(Text), "there is no predicate ~w/~w~w", [Name, Arity, Hint]) ).

pure({}/1).     pure(true/0).   pure(fail/0).  pure(false/0).  pure(!/0).
pure((=)/2).    pure((\=)/2).   pure((==)/2).  pure((\==)/2).  pure((is)/2).
pure((<)/2).    pure((>)/2).    pure((=<)/2).  pure((>=)/2).   pure((=:=)/2).   pure((=\=)/2).
pure(member/2). pure(memberchk/2).  pure(between/3).  pure(number/1).  pure(atom/1).  pure(var/1).  pure(nonvar/1).

%   meant(+Indicator, +Others, -Hint): the same name with another arity, or a name that looks like it.

meant(Name/_, Others, Hint) :-
    (   member(Name/Other, Others)
    ->  format(string(Hint), ": did you mean ~w/~w?", [Name, Other])
    ;   member(Like/Other, Others), dwim_match(Name, Like)
    ->  format(string(Hint), ": did you mean ~w/~w?", [Like, Other])
    ;   Hint = "" ).
