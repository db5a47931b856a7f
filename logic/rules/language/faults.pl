:- module(faults, [fault_report/3, explained_fault/3, clash/4, clash_at/4, clause_line/3]).

/** <module> Why a clause of the grammar's cannot be used: its place, and its author's own words */

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(grammar_files).
:- use_module(lengths).
:- use_module(nonlinear).
:- use_module(paths).
:- use_module(written).

%!  fault_report(+Kind, +Call, -Wrong) is det.
%
%   Wrong is wrong(File,Line,Column,Text) for the Call, Given-Head: the clause's head, called with variables, and pairs of
%   what these are given and said(Format,Arguments), by number, which says it (said("",[]) for what needs no words). Kind is
%
%       empty       no size satisfies the clause       raised        a goal raises an error
%       several     there is more than one solution    nonlinear     CLP(R) cannot decide a constraint
%       unbounded   a size has no bound on a side      not_positive  a size can be 0 or less
%       endless     the clause calls itself            not_metres    a length is not a number, 0 or more
%       no_areas    two numbers are no least and greatest area
%       no_width    a length is 0                      too_large    a length or an area is no building's

fault_report(Kind, Call, Wrong) :- explained_fault(Kind, Call, Wrong), !.
fault_report(Kind, _-Head, Wrong) :-
    general(Kind, What),
    grammar_terms(Terms), first_clause(Terms, Head, First), head(First, At),
    spoken("~w ~w", [At,What], Text), wrong_at(At, Text, Wrong).

%!  explained_fault(+Kind, +Call, -Wrong) is semidet.
%
%   As fault_report/3, where it is known why.

explained_fault(Kind, Given-Head, Wrong) :-
    grammar_terms(Terms),
    include(for(Head), Terms, Clauses), Clauses = [_|_],
    call_with_inference_limit(once(fault(Kind, Terms, Clauses, Given-Head, At, Text)), 300 000, Result),
    Result \== inference_limit_exceeded,
    wrong_at(At, Text, Wrong).

wrong_at(Source-Position, Text, wrong(File,Line,Column,Text)) :- Source = source(File,_), place(Source, Position, Line, Column).

for(Head, term(_,_,clause(H,_,_,_,_,_))) :- \+ H \= Head.

general(empty,        "allows no size").
general(several,      "has more than one solution: state one").
general(raised,       "cannot be solved: a size is a number, or a variable with bounds in braces").
general(nonlinear,    "has a nonlinear constraint, but CLP(R) decides only linear constraints").
general(unbounded,    "is not bounded on both sides").
general(not_positive, "allows a size that is not positive").
general(endless,      "never ends").
general(not_metres,   "must be a number of metres, 0 or more").
general(no_width,     "must be a number of metres more than 0").
general(too_large,    "is larger than any house").
general(no_areas,     "must give the least and the greatest area in square metres, in this order, 0 or more").

%!  clause_line(+Head, +Other, -Words) is det.
%
%   In which line the first clause for the Other head stands, as said at that for Head.

clause_line(Head, Other, Words) :-
    grammar_terms(Terms),
    first_clause(Terms, Head, Clause), head(Clause, At),
    first_clause(Terms, Other, Said), head(Said, There), line(At, There, Words).

first_clause(Terms, Head, Clause) :- member(Clause, Terms), for(Head, Clause), !.

%!  clash(+Head, +Format, +Arguments, -Wrong) is det.
%
%   Wrong is at the clause for this Head, which it names before what is said. An argument may be clause(Head), another one that is
%   part of it, or metres(Number).

clash(Head, Format, Arguments, Wrong) :-
    clash_at(0, Head, Format-Arguments, Wrong).

%!  clash_at(+Number, +Head, +Said, -Wrong)
%
%   The same, at one of the clauses for this Head, from 0; Said is Format-Arguments.

clash_at(Number, Head, Format-Arguments, Wrong) :-
    grammar_terms(Terms),
    include(for(Head), Terms, Clauses), nth0(Number, Clauses, Clause), !, head(Clause, At),
    maplist(clash_words(Terms, At), Arguments, Words), format(string(Said), Format, Words),
    spoken("~w: ~w", [At,Said], Text), wrong_at(At, Text, Wrong).

clash_words(_, _, metres(Number), Words) :- !, Rounded is round(Number*1000)/1000.0, format(string(Words), "~w", [Rounded]).
clash_words(Terms, At, clause(Head), Words) :- !,
    first_clause(Terms, Head, Clause), head(Clause, Other), line(At, Other, Line),
    spoken("~w in ~w", [Other,Line], Words).
clash_words(_, _, Words, Words).

%   fault(+Kind, +Terms, +Clauses, +Call, -At, -Text) is nondet: the Clauses are those of the Terms that are called.

fault(empty, Terms, Clauses, Call, At, Text) :-
    findall(Count/Clause/Steps, ( path(Terms, Clauses, Call, Clause, _, Steps, fails), length(Steps, Count) ), Ways),
    sort(1, @>=, Ways, [_/Clause/Steps|_]),
    conflict(Steps, Conflict),
    head(Clause, At),
    partition([step(_,_,said(_,_))]>>true, Conflict, Given, Stated),
    append(Stated, Given, Ordered),
    maplist(step_words(Clause), Ordered, Said), exclude(==(""), Said, Words),
    excluding(Words, Excluding),
    spoken("~w allows no size: ~w", [At,Excluding], Text).
fault(raised, Terms, Clauses, Call, At, Text) :-
    path(Terms, Clauses, Call, _, _, Steps, raises(Error)),
    last(Steps, step(_,_,At)),
    error_text(Error, At, Text).
fault(nonlinear, Terms, Clauses, Given-Head, At, Text) :-
    path(Terms, Clauses, Given-Head, _, _, Steps, holds),
    member(step(post(_),post(Live),At), Steps),
    linear_instead(Live, Linear), functor(Head, Name, _),
    ( nonlinear(Live, A*B), A \== B, stated_area(Name, Area) -> Instead = Area ; Instead = Linear ), !,
    spoken("~w is nonlinear, but CLP(R) decides only linear constraints: ~w", [At,Instead], Text).
fault(several, Terms, Clauses, Call, At, Text) :-
    findall(Clause, ( member(Clause, Clauses), once(path(Terms, [Clause], Call, _, _, _, holds)) ), Holding),
    several(Holding, At, Text).
fault(unbounded, Terms, Clauses, Call, At, Text) :-
    path(Terms, Clauses, Call, Clause, Live, _, holds),
    findall(Lack, ( size(Clause, Live, X, Words), lacking(X, Words, Lack) ), Lacks),
    atomic_list_concat(Lacks, ', ', All), !,
    head(Clause, At), unknowns(Clause, Unknown),
    spoken("~w: ~w~w", [At,All,Unknown], Text).
fault(not_positive, Terms, Clauses, Call, At, Text) :-
    path(Terms, Clauses, Call, Clause, Live, _, holds),
    size(Clause, Live, X, Words), extremes(X, Low-_), Low =< 0, !,
    head(Clause, At),
    spoken("~w: ~w can be ~w m, but a size must be more than 0", [At,Words,Low], Text).
fault(endless, Terms, Clauses, _, At, Text) :-
    member(Clause, Clauses), head(Clause, At),
    once(called(Terms, Clause, [], Looped, Goal)), line(At, Goal, Line),
    spoken("~w never ends: ~w calls itself in ~w", [At,Looped,Line], Text).

%   stated_area(+Name, -Text) is semidet: how an area is stated that the clause of this name is to bound.

stated_area(room_size, "state the area by room_area(Type,Least,Most)") :- nb_getval(grammar_walls, shared).
stated_area(house_size, "state the area by house_area(Least,Most)").

%   path(+Terms, +Clauses, +Call, -Clause, -Live, -Steps, -End) is nondet: see clause_path/5.

path(Terms, Clauses, Call, Clause, Live, Steps, End) :-
    member(Clause, Clauses),
    clause_path(Terms, Clause, Call, Live, path(Steps,End)).

several(Clauses, At, Text) :-
    Clauses = [_,_|_], member(Clause, Clauses), Clause = term(_,_,clause(Head,_,_,_,_,_)),
    functor(Head, Name, _), arguments(Name, ["Type"|_]), arg(1, Head, Type), var(Type), !,
    head(Clause, At),
    spoken("~w applies to every type, but some types have their own clause: name the types of this clause", [At], Text).
several([First,Second|_], At, Text) :- !,
    head(Second, At), head(First, There), line(At, There, Line),
    spoken("~w is a second clause: the first is in ~w. State one", [At,Line], Text).
several([Clause], At, Text) :- head(Clause, At), spoken("~w has more than one solution: state one", [At], Text).

error_text(error(instantiation_error,_), At, Text) :- !,
    spoken("~w is computed, but a variable has no value yet: write constraints in braces, { ~w }", [At,At], Text).
error_text(error(type_error(evaluable,Name/0),_), At, Text) :- !,
    spoken("~w: ~w is a name, not a number", [At,Name], Text).
error_text(Error, At, Text) :- spoken("~w raises an error: ~p", [At,Error], Text).

%   size(+Clause, +Live, -X, -Words) is nondet: X is a size of a solved head, which its clause calls Words.

size(Clause, Live, X, Words) :-
    functor(Live, Name, _), arguments(Name, Kinds),
    nth1(N, Kinds, Kind), memberchk(Kind, ["Length","Width","Depth"]),
    arg(N, Live, X), argument_words(Clause, N, Words).

%   arguments(+Name, -Kinds): what the arguments of a clause's head are.

arguments(room_size,   ["Type","Width","Depth"]).
arguments(piece_size,  ["Type","Length","Depth","Wall"]).
arguments(window_size, ["Type","Length","Wall"]).
arguments(turning,     ["Type","Side"]).
arguments(opening_size, ["Type","Other","Length","Wall"]).
arguments(house_size,  ["Width","Depth"]).
arguments(unit_depth,  ["Depth"]).
arguments(room_area,   ["Type","Least","Most"]).
arguments(whole_area,  ["Type","Least","Most"]).
arguments(house_area,  ["Least","Most"]).

lacking(X, Words, Lack) :-
    \+ extremes(X, _),
    ( catch(inf(X, _), _, fail) -> Low = [] ; Low = [lower] ),
    ( catch(sup(X, _), _, fail) -> High = [] ; High = [upper] ),
    append(Low, High, Sides), atomic_list_concat(Sides, ' and no ', Bounds),
    format(string(Lack), "~w has no ~w bound", [Words, Bounds]).

%   unknowns(+Clause, -Words): what a clause has of variables that are not in its head.

unknowns(term(_,_,clause(Head,_,_,_,Names,_)), Words) :-
    term_variables(Head, Known),
    findall(Name, ( member(Name=V, Names), \+ ( member(K, Known), K == V ) ), Others),
    (   Others == []
    ->  Words = ""
    ;   atomic_list_concat(Others, ', ', All), format(string(Words), " (~w gives none, because it is not in the head)", [All]) ).

%   called(+Terms, +Clause, +Path, -Name, -Place) is nondet: a predicate of the grammar that is called by way of itself.

called(Terms, term(Source,_,clause(Head,Body,_,P,_,_)), Path, Looped, Place) :-
    functor(Head, Name, Arity),
    goal_in(Body, P, Goal, At), callable(Goal), functor(Goal, Called, N),
    (   memberchk(Called/N, [Name/Arity|Path])
    ->  Looped = Called/N, Place = Source-At
    ;   member(Clause, Terms), Clause = term(_,_,clause(H,_,_,_,_,_)), functor(H, Called, N),
        called(Terms, Clause, [Name/Arity|Path], Looped, Place) ).

% - words --------------------------------------------------------------------

head(term(Source,_,clause(_,_,Position,_,_,_)), Source-Position).

%   line(+At, +Other, -Words): in which line Other stands, as said at another place.

line(source(File,_)-_, Source-P, Words) :-
    place(Source, P, Line, _), Source = source(Other,_),
    (   Other == File
    ->  format(string(Words), "line ~w", [Line])
    ;   file_name(Other, Name), format(string(Words), "line ~w of ~w", [Line, Name]) ).

%   file_name(+File, -Name): its path in the grammar's folder, or with the folder of the shipped grammar that it belongs to.

:- nb_setval(grammar_files, []).

file_name(File, Name) :-
    nb_getval(grammar_files, Files), last(Files, Last), ( Last = Top-_ -> true ; Top = Last ),
    file_directory_name(Top, Folder), atom_concat(Folder, /, Before), atom_concat(Before, Name, File), !.
file_name(File, Name) :-
    file_directory_name(File, Folder), file_base_name(Folder, Shipped), file_base_name(File, Base),
    atomic_list_concat([Shipped,/,Base], Name).

%   step_words(+Clause, +Step, -Words): with its line where that is another than the line of the Clause.

step_words(Clause, step(_,_,said(Format,Arguments)), Words) :- !,
    maplist(argument_words(Clause), Arguments, Names),
    format(string(Words), Format, Names).
step_words(Clause, step(_,_,Source-P), Words) :-
    wording(Source, P, Said), place(Source, P, Line, _),
    head(Clause, HeadSource-HeadP), place(HeadSource, HeadP, HeadLine, _),
    (   Source-Line == HeadSource-HeadLine
    ->  Words = Said
    ;   line(HeadSource-HeadP, Source-P, At), format(string(Words), "~w (~w)", [Said, At]) ).

%   argument_words(+Clause, +N, -Words): what the clause's head calls its Nth argument.

argument_words(term(Source,_,clause(Head,_,term_position(_,_,_,_,Positions),_,_,_)), N, Words) :-
    nth1(N, Positions, P), wording(Source, P, Said),
    ( Said == "_", functor(Head, Name, _), arguments(Name, Kinds) -> nth1(N, Kinds, Words) ; Words = Said ).

excluding([One], Text) :- !, format(string(Text), "~w never holds", [One]).
excluding(Words, Text) :-
    append(Firsts, [Last], Words),
    atomic_list_concat(Firsts, ', ', First),
    format(string(Text), "~w and ~w exclude each other", [First, Last]).

%   spoken(+Format, +Arguments, -Text): where an argument is Source-Position its words are meant.

spoken(Format, Arguments, Text) :- maplist(spoken, Arguments, Words), format(string(Text), Format, Words).

spoken(Argument, Words) :- ( Argument = Source-P, Source = source(_,_) -> wording(Source, P, Words) ; Words = Argument ).
