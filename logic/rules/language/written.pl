:- module(written, [written_terms/2, goal_in/4, part/4, start/2, place/4, wording/3]).

/** <module> A grammar's .pl files as they are written: terms with the places and the words of all their parts

Each file is read once, and nothing in it changes how: no directive is run, no term is expanded, and the operators are those
of this module. A source is source(File,Text); the parts of a term have positions as read_term/2 gives them, characters
from the start of the text. What looks like a constraint, but is none, is read too: so it can be named.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(occurs)).

:- op(700, xfx, [=>, <=, ≤, ≥, <>, #=, #\=, #<, #>, #=<, #>=]).
:- op(900, xfy, [and, or]).

%!  written_terms(+Files, -Terms) is det.
%
%   One of the Files that includes others is File-Lines: so many lines at its top, down to the last include, are read as blank.
%   Terms are term(Source,Position,Kind), in order: Kind is clause(Head,Body,HeadPosition,BodyPosition,Names,Singletons),
%   directive(Goal), error(Text), or syntax(What), whose Position is where reading failed. Names are 'Name'=Variable.

written_terms(Files, Terms) :-
    maplist(file_terms, Files, Each),
    append(Each, Terms).

file_terms(File-Lines, Terms) :- !, file_terms(File, Lines, Terms).
file_terms(File, Terms) :- file_terms(File, 0, Terms).

file_terms(File, Lines, Terms) :-
    setup_call_cleanup(open(File, read, Rules, [encoding(utf8)]), read_string(Rules, _, Written), close(Rules)),
    blank_above(Lines, Written, Text),
    setup_call_cleanup(open_string(Text, In), stream_terms(In, source(File,Text), Terms), close(In)).

blank_above(0, Text, Text) :- !.
blank_above(Number, Written, Text) :-
    split_string(Written, "\n", "", Lines),
    length(Above, Number), append(Above, Below, Lines),
    length(Blank, Number), maplist(=(""), Blank), append(Blank, Below, Left),
    atomic_list_concat(Left, '\n', Atom), atom_string(Atom, Text).

stream_terms(In, Source, Terms) :-
    catch(read_term(In, Term, [module(written), subterm_positions(Position), variable_names(Names), singletons(Singletons),
                               syntax_errors(error), cycles(false), dotlists(false), quasi_quotations(Quotations)]),
          error(syntax_error(What), Where), true),
    (   nonvar(What)
    ->  Where = stream(_,_,_,Last),
        Source = source(_,Text), string_length(Text, Length), From is min(Last + 1, Length),
        Terms = [term(Source,From-From,syntax(What))|Rest],
        stream_terms(In, Source, Rest)
    ;   Term == end_of_file, at_end_of_stream(In)
    ->  Terms = []
    ;   ( foreign(Term, Quotations, Text) -> Kind = error(Text) ; kind(Term, Position, Names, Singletons, Kind) ),
        Terms = [term(Source,Position,Kind)|Rest],
        stream_terms(In, Source, Rest) ).

%   foreign(+Term, +Quotations, -Text) is semidet: Term holds what SWI-Prolog adds to Prolog's terms.

foreign(_, [_|_], "a grammar may not contain quasi quotations: remove them").
foreign(Term, _, Text) :-
    sub_term(Part, Term), compound(Part),
    compound_name_arity(Part, Name, Arity),
    (   ( \+ atom(Name) ; Name/Arity == ('.')/2 )
    ->  Text = "a grammar may not contain dicts, or a point between two names: write them as two terms"
    ;   Arity == 0, format(string(Text), "~q has no arguments: remove its brackets", [Part]) ), !.

kind((:- Goal), _, _, _, directive(Goal)) :- !.
kind((?- Goal), _, _, _, directive(Goal)) :- !.
kind((_ --> _), _, _, _, error("a grammar may not contain DCG rules: write the clause with :-")) :- !.
kind((_ => _), _, _, _, error("write :- between the head and the body of a clause, not =>")) :- !.
kind((_, _), _, _, _, error("write :- between the head and the body of a clause, not a comma")) :- !.
kind((_ := _), _, _, _, error("write :- between the head and the body of a clause, not :=")) :- !.
kind((Head :- Body), term_position(_,_,_,_,[H,B]), Names, Singletons, clause(Head,Body,H,B,Names,Singletons)) :- !.
kind(Head, Position, Names, Singletons, clause(Head,true,Position,Position,Names,Singletons)).

%!  goal_in(+Body, +Position, -Goal, -GoalPosition) is nondet.
%
%   Goal is one of a body's goals, those under control constructs one by one.

goal_in(Body, Position, Goal, At) :-
    phrase(goals(Body, Position), Goals),
    member(Goal-At, Goals).

goals(Body, parentheses_term_position(_,_,P)) --> !, goals(Body, P).
goals(Body, term_position(_,_,_,_,Ps))        --> { nonvar(Body), control(Body) }, !, { Body =.. [_|Parts] }, goals_of_all(Parts, Ps).
goals(Goal, P)                                --> [Goal-P].

goals_of_all([], [])               --> [].
goals_of_all([Part|Parts], [P|Ps]) --> goals(Part, P), goals_of_all(Parts, Ps).

control((_,_)).   control((_;_)).   control((_->_)).   control(\+ _).   control(once(_)).

%!  part(+Term, +Position, -Part, -PartPosition) is nondet.
%
%   Part is Term or any part of it, from left to right.

part(Term, parentheses_term_position(_,_,P), Part, At) :- !, part(Term, P, Part, At).
part(Term, P, Term, P).
part(Term, P, Part, At) :-
    compound(Term),
    positions(P, Ps),
    Term =.. [_|Parts],
    nth1(N, Parts, Sub), nth1(N, Ps, SubP),
    part(Sub, SubP, Part, At).

positions(term_position(_,_,_,_,Ps), Ps).
positions(brace_term_position(_,_,P), [P]).
positions(list_position(From,To,[P|Ps],Tail), [P,list_position(From,To,Ps,Tail)]).

%!  start(+Position, -Offset) is det.

start(Position, From) :- arg(1, Position, From).

%!  place(+Source, +Position, -Line, -Column) is det.
%
%   Where the part at this Position begins, counted from 1.

place(source(_,Text), Position, Line, Column) :-
    start(Position, From),
    sub_string(Text, 0, From, _, Before),
    split_string(Before, "\n", "", Lines),
    length(Lines, Line),
    last(Lines, Last), string_length(Last, Length),
    Column is Length + 1.

%!  wording(+Source, +Position, -Text) is det.
%
%   Text is the part at this Position as written, on one line, or how it begins.

wording(source(_,Text), Position, Words) :-
    arg(1, Position, From), arg(2, Position, To),
    Length is To - From,
    sub_string(Text, From, Length, _, Written),
    split_string(Written, " \n\t\r", " \n\t\r", Parts),
    exclude(==(""), Parts, Said),
    atomic_list_concat(Said, ' ', Atom),
    ( sub_atom(Atom, 0, 120, After, Begin), After > 3 -> string_concat(Begin, "...", Words) ; atom_string(Atom, Words) ).
