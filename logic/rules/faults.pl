:- module(faults, [fault_report/3]).

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

fault_report(Kind, Given-Head, wrong(File,Line,Column,Text)) :-
    grammar_terms(Terms),
    include(for(Head), Terms, [First|Clauses]),
    (   call_with_inference_limit(once(fault(Kind, Terms, [First|Clauses], Given-Head, At0, Text0)), 300 000, Result),
        Result \== inference_limit_exceeded
    ->  At = At0, Text = Text0
    ;   general(Kind, What),
        head(First, At), spoken("~w ~w", [At,What], Text) ),
    At = Source-Position, Source = source(File,_),
    place(Source, Position, Line, Column).

for(Head, term(_,_,clause(H,_,_,_,_,_))) :- \+ H \= Head.

general(empty,        "allows no size").
general(several,      "has more than one solution: state one").
general(raised,       "cannot be solved: a size is a number, or a variable with bounds in braces").
general(nonlinear,    "has a constraint that is nonlinear, and CLP(R) decides linear ones").
general(unbounded,    "is not bounded on both sides").
general(not_positive, "allows a size that is not positive").
general(endless,      "recurs without end").
general(not_metres,   "is not a number of metres, 0 or more").

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
fault(nonlinear, Terms, Clauses, Call, At, Text) :-
    path(Terms, Clauses, Call, _, _, Steps, holds),
    member(step(post(_),post(Live),At), Steps),
    linear_instead(Live, Instead), !,
    spoken("~w is nonlinear, and CLP(R) decides linear constraints alone: ~w", [At,Instead], Text).
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
    spoken("~w: ~w can be ~w m, and a size is more than 0", [At,Words,Low], Text).
fault(endless, Terms, Clauses, _, At, Text) :-
    member(Clause, Clauses), head(Clause, At),
    once(called(Terms, Clause, [], Looped, Line)),
    spoken("~w recurs without end: ~w calls itself in line ~w", [At,Looped,Line], Text).

%   path(+Terms, +Clauses, +Call, -Clause, -Live, -Steps, -End) is nondet: see clause_path/5.

path(Terms, Clauses, Call, Clause, Live, Steps, End) :-
    member(Clause, Clauses),
    clause_path(Terms, Clause, Call, Live, path(Steps,End)).

several(Clauses, At, Text) :-
    Clauses = [_,_|_], member(Clause, Clauses), Clause = term(_,_,clause(Head,_,_,_,_,_)), arg(1, Head, Type), var(Type), !,
    head(Clause, At),
    spoken("~w is for every type, and some have a clause of their own: name the types that this is for", [At], Text).
several([First,Second|_], At, Text) :- !,
    head(Second, At), line(At, First, Line),
    spoken("~w is a second clause: the first stands in ~w. State one", [At,Line], Text).
several([Clause], At, Text) :- head(Clause, At), spoken("~w has more than one solution: state one", [At], Text).

error_text(error(instantiation_error,_), At, Text) :- !,
    spoken("~w is computed, and a variable has no value yet: constraints stand in braces, { ~w }", [At,At], Text).
error_text(error(type_error(evaluable,Name/0),_), At, Text) :- !,
    spoken("~w: ~w is a name and no number", [At,Name], Text).
error_text(Error, At, Text) :- spoken("~w raises an error: ~p", [At,Error], Text).

%   size(+Clause, +Live, -X, -Words) is nondet: X is a size of a solved head, which its clause calls Words.

size(Clause, Live, X, Words) :- member(N, [2,3]), arg(N, Live, X), argument_words(Clause, N, Words).

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
    ;   atomic_list_concat(Others, ', ', All), format(string(Words), " (none by ~w, which is not in the head)", [All]) ).

%   called(+Terms, +Clause, +Path, -Name, -Line) is nondet: a predicate of the grammar that is called by way of itself.

called(Terms, term(Source,_,clause(Head,Body,_,P,_,_)), Path, Looped, Line) :-
    functor(Head, Name, Arity),
    goal_in(Body, P, Goal, At), callable(Goal), functor(Goal, Called, N),
    (   memberchk(Called/N, [Name/Arity|Path])
    ->  Looped = Called/N, place(Source, At, Line, _)
    ;   member(Clause, Terms), Clause = term(_,_,clause(H,_,_,_,_,_)), functor(H, Called, N),
        called(Terms, Clause, [Name/Arity|Path], Looped, Line) ).

% - words --------------------------------------------------------------------

head(term(Source,_,clause(_,_,Position,_,_,_)), Source-Position).

%   line(+At, +Clause, -Words): in which line Clause stands, as said at another place.

line(source(File,_)-_, Clause, Words) :-
    head(Clause, Source-P), place(Source, P, Line, _), Source = source(Other,_),
    (   Other == File
    ->  format(string(Words), "line ~w", [Line])
    ;   file_base_name(Other, Name), format(string(Words), "line ~w of ~w", [Line, Name]) ).

%   step_words(+Clause, +Step, -Words): with its line where that is another than the line of the Clause.

step_words(Clause, step(_,_,said(Format,Arguments)), Words) :- !,
    maplist(argument_words(Clause), Arguments, Names),
    format(string(Words), Format, Names).
step_words(Clause, step(_,_,Source-P), Words) :-
    wording(Source, P, Said), place(Source, P, Line, _),
    head(Clause, HeadSource-HeadP), place(HeadSource, HeadP, HeadLine, _),
    ( Source-Line == HeadSource-HeadLine -> Words = Said ; format(string(Words), "~w (line ~w)", [Said, Line]) ).

%   argument_words(+Clause, +N, -Words): what the clause's head calls its Nth argument.

argument_words(term(Source,_,clause(_,_,term_position(_,_,_,_,Positions),_,_,_)), N, Words) :-
    nth1(N, Positions, P), wording(Source, P, Said),
    ( Said == "_" -> nth1(N, ["Type","Length","Depth","Wall"], Words) ; Words = Said ).

excluding([One], Text) :- !, format(string(Text), "~w never holds", [One]).
excluding(Words, Text) :-
    append(Firsts, [Last], Words),
    atomic_list_concat(Firsts, ', ', First),
    format(string(Text), "~w and ~w exclude each other", [First, Last]).

%   spoken(+Format, +Arguments, -Text): where an argument is Source-Position its words are meant.

spoken(Format, Arguments, Text) :- maplist(spoken, Arguments, Words), format(string(Text), Format, Words).

spoken(Argument, Words) :- ( Argument = Source-P, Source = source(_,_) -> wording(Source, P, Words) ; Words = Argument ).
