:- module(lint, [term_problems/2]).

/** <module> What is wrong with the terms of a grammar's .pl files, found before any is run

A file holds the clauses of room_size/3, piece_size/4 and the named lengths, and of predicates of its own that these
call: CLP(R) constraints, arithmetic, comparison, unification, control. Nothing else is ever stated: see grammar_files.pl.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(clpr)).
:- use_module(braces).
:- use_module(written).

%!  term_problems(+Terms, -Problems) is det.
%
%   Problems are problem(File,Line,Column,Text,Name), in order, for what a grammar's files must not hold, of which these are
%   all Terms (written.pl). Name is that of a predicate that is not known, or ''.

term_problems(Terms, Problems) :-
    convlist(term_head, Terms, Heads0), list_to_set(Heads0, Heads),
    findall(Called, called_by(Terms, Called), Calls0), list_to_set(Calls0, Calls),
    maplist(problems(Heads, Calls), Terms, Found),
    append(Found, Problems).

term_head(term(_,_,clause(Head,_,_,_,_,_)), Name/Arity) :- \+ bad_head(Head, _), functor(Head, Name, Arity).

called_by(Terms, Name/Arity) :-
    member(term(_,_,clause(Head,Body,_,P,_,_)), Terms),
    goal_in(Body, P, Goal, _), callable(Goal),
    functor(Goal, Name, Arity),
    \+ functor(Head, Name, Arity).

% - judging ------------------------------------------------------------------

%   role(?Indicator) is nondet: the core uses these clauses, for a topology whose walls are those of grammar_walls.

:- nb_setval(grammar_walls, apart).

role(room_size/3).   role(piece_size/4).
role(door_width/1).  role(door_clearance/1).  role(passage/1).  role(room_gap/1).  role(house_area/2).  role(turning/2).
role(Indicator) :- nb_getval(grammar_walls, shared), plan_role(Indicator).

plan_role(room_area/3).  plan_role(whole_area/3).  plan_role(house_size/2).  plan_role(unit_depth/1).  plan_role(window_size/3).  plan_role(opening_size/4).  plan_role(door_margin/1).  plan_role(door_width/3).  plan_role(window_margin/1).  plan_role(wall_thickness/2).

problems(Heads, Calls, term(Source,Position,Kind), Problems) :-
    Source = source(File,_),
    findall(problem(File,Line,Column,Text,Name),
            ( problem(Kind, Source, Heads-Calls, Position, At, Fault),
              place(Source, At, Line, Column),
              ( Fault = unknown(Name,Text) -> true ; Name = '', Text = Fault ) ),
            Problems).

%   problem(+Kind, +Source, +Known, +Position, -At, -Fault) is nondet: Fault is a text or unknown(Name,Text).

problem(error(Text), _, _, P, P, Text).
problem(syntax(What), _, _, P, P, Text) :- format(string(Text), "syntax error: ~w", [What]).
problem(directive(Goal), _, _, P, P, Text) :-
    \+ ( nonvar(Goal), harmless(Goal) ),
    (   nonvar(Goal), reads_file(Goal)
    ->  Text = "an include must be at the top of its file, alone on its line, as in :- include('home/furniture.pl')."
    ;   Goal = use_module(library(Other)), memberchk(Other, [clpfd,clpq,clpb])
    ->  format(string(Text), "lengths are real numbers: write library(clpr) for library(~w), or remove the line", [Other])
    ;   format(string(Text), "a directive runs code when the file is read: ~p. A .pl file contains only clauses; a rule that begins with :- belongs in a .lp file", [Goal]) ).
problem(clause(Head,_,_,_,_,_), _, _, P, P, Text) :- bad_head(Head, Text), !.
problem(clause(Head,_,At,_,_,_), Source, Heads-Calls, _, At, unknown(Name,Text)) :-
    functor(Head, Name, Arity),
    \+ role(Name/Arity), \+ memberchk(Name/Arity, Calls),
    findall(Known, ( role(Known) ; member(Known, Heads), Known \== Name/Arity ), Others),
    (   parted_number(Source, Head, At, Hint)
    ->  true
    ;   plan_role(Name/Arity)
    ->  Hint = " in a star: state a topology/1 whose rooms share walls, or remove the clause"
    ;   meant(Name/Arity, Others, Hint) ),
    format(string(Text), "nothing uses ~w/~w~w", [Name, Arity, Hint]).
problem(clause(_,Body,_,P,Names,_), Source, Heads-_, _, At, Fault) :-
    goal_in(Body, P, Goal, GoalAt),
    (   nonvar(Goal), Goal = {Constraints}, braced(GoalAt, Inner)
    ->  constraint_fault(Source, Names, Constraints, Inner, At-Fault)
    ;   At = GoalAt, ( bad_goal(Goal, Heads, Fault) ; uncomputed(Goal, Source, At, Fault) ) ).
problem(clause(Head,Body,H,B,Names,Singletons), _, _, _, At, Text) :-
    member(Name=Variable, Singletons), \+ sub_atom(Name, 0, _, _, '_'),
    once(( part(Head-Body, term_position(0,0,0,0,[H,B]), Part, At), Part == Variable )),
    findall(Other, ( member(Other=V, Names), V \== Variable ), Others),
    lone(Name, Variable, Head, Others, Text).

braced(brace_term_position(_,_,Inner), Inner).
braced(term_position(_,_,_,_,[Inner]), Inner).

%   harmless(+Goal) is semidet: the directive is superfluous. No directive is run, this one neither.

harmless(use_module(library(clpr))).
harmless(use_module(library(clpr), _)).
harmless(discontiguous(_)).
harmless(dynamic(_)).
harmless(multifile(_)).

%   reads_file(+Goal) is semidet: the directive has SWI-Prolog read a file of rules, at this place.

reads_file(include(_)).   reads_file(consult(_)).   reads_file([_|_]).   reads_file(ensure_loaded(_)).

%   lone(+Name, +Variable, +Head, +Others, -Text): what a variable that stands once means.

lone(Name, _, _, Others, Text) :-
    member(Other, Others), dwim_match(Name, Other), !,
    format(string(Text), "~w occurs nowhere else in its clause: did you mean ~w?", [Name, Other]).
lone(Name, Variable, Head, _, Text) :-
    arg(1, Head, Type), Type == Variable, !, downcase_atom(Name, Low),
    format(string(Text), "~w occurs nowhere else in its clause: a name begins in lower case: did you mean ~w?", [Name, Low]).
lone(Name, Variable, Head, _, Text) :-
    size(Head, Size), Size == Variable, !,
    format(string(Text), "~w occurs nowhere else in its clause, so it has no bounds: state ~w >= ... and ~w =< ...",
           [Name, Name, Name]).
lone('Wall', _, Head, _, "Wall occurs nowhere else in its clause: only piece_size/4 has a Wall, not room_size/3") :-
    functor(Head, room_size, 3), !.
lone(Name, _, _, _, Text) :-
    format(string(Text), "~w occurs nowhere else in its clause (a singleton): use it, or write _", [Name]).

size(room_size(_,W,D), Size)    :- member(Size, [W,D]).
size(piece_size(_,L,D,_), Size) :- member(Size, [L,D]).

%   bad_head(+Head, -Text) is semidet: no grammar may define it.

bad_head(Head, "a clause must begin with a name, as in room_size(hall, W, D)") :- \+ callable(Head), !.
bad_head(Head, Text) :-
    functor(Head, Name, Arity),
    (   \+ plain(Name)
    ->  format(string(Text), "the name of a clause must begin in lower case, as in room_size(hall, W, D), not ~q/~w", [Name,Arity])
    ;   ( pure(Name/Arity) ; built_in(Head) )
    ->  format(string(Text), "~w/~w is built into SWI-Prolog: choose another name", [Name,Arity]) ).

built_in(Head) :-
    functor(Head, Name, _), current_predicate(Name, system:Head),
    \+ predicate_property(system:Head, dynamic),
    predicate_property(system:Head, implementation_module(Module)), module_property(Module, class(system)).

plain(Name) :- atom_codes(Name, [First|Codes]), code_type(First, lower), forall(member(Code, Codes), code_type(Code, csym)).

bad_goal(Goal, _, "a goal cannot be a variable: write the goal itself") :- var(Goal), !.
bad_goal(Goal, _, "not a goal: a clause may contain only CLP(R) constraints, arithmetic and comparison") :- \+ callable(Goal), !.
bad_goal([_|_], _, "a list is not a goal: write constraints in braces, { }") :- !.
bad_goal(Goal, Heads, Fault) :-
    functor(Goal, Name, Arity),
    \+ memberchk(Name/Arity, Heads), \+ role(Name/Arity), \+ pure(Name/Arity),
    (   predicate_property(user:Goal, defined)
    ->  format(string(Fault), "~w/~w runs code: a clause may contain only CLP(R) constraints, arithmetic and comparison",
               [Name, Arity])
    ;   findall(Known, ( role(Known) ; member(Known, Heads) ), Others),
        meant(Name/Arity, Others, Hint),
        format(string(Text), "there is no predicate ~w/~w~w", [Name, Arity, Hint]),
        Fault = unknown(Name,Text) ).

pure({}/1).     pure(true/0).   pure(fail/0).  pure(false/0).  pure(!/0).
pure((=)/2).    pure((\=)/2).   pure((==)/2).  pure((\==)/2).  pure((is)/2).
pure((<)/2).    pure((>)/2).    pure((=<)/2).  pure((>=)/2).   pure((=:=)/2).   pure((=\=)/2).
pure(member/2). pure(memberchk/2).  pure(between/3).  pure(number/1).  pure(atom/1).  pure(var/1).  pure(nonvar/1).

%   uncomputed(+Goal, +Source, +Position, -Text) is semidet: what is to be computed holds a part that has no value, or another
%   one each time.

uncomputed(Goal, Source, At, Text) :-
    computed(Goal, Expressions), member(Expression, Expressions),
    once(( expression_part(Expression, Part), \+ var(Part), \+ number(Part), \+ evaluable(Part) )),
    wording(Source, At, Said),
    (   atom(Part)
    ->  format(string(Text), "~w: ~w is a name, not a number", [Said,Part])
    ;   format(string(Text), "~w: ~p is not arithmetic that a grammar may use", [Said,Part]) ).

computed(_ is E, [E]).
computed(A < B, [A,B]).   computed(A =< B, [A,B]).   computed(A =:= B, [A,B]).
computed(A > B, [A,B]).   computed(A >= B, [A,B]).   computed(A =\= B, [A,B]).

expression_part(E, E).
expression_part(E, Part) :- compound(E), evaluable(E), arg(_, E, Inner), expression_part(Inner, Part).

evaluable(E) :-
    callable(E), functor(E, Name, Arity),
    memberchk(Name/Arity, [pi/0,e/0,inf/0,(+)/1,(-)/1,(+)/2,(-)/2,(*)/2,(/)/2,(//)/2,(mod)/2,(rem)/2,(**)/2,(^)/2,min/2,max/2,
                           abs/1,sign/1,sqrt/1,exp/1,log/1,sin/1,cos/1,tan/1,asin/1,acos/1,atan/1,atan2/2,
                           floor/1,ceiling/1,round/1,truncate/1,integer/1,float/1]).

%   meant(+Indicator, +Others, -Hint): a constraint without its braces, the same name with another arity, or a name that
%   looks like it.

meant(Name/2, _, Hint) :-
    memberchk(Name, [<=,=>,≤,≥,#=,#<,#>,#=<,#>=,and]), !,
    Hint = ": did you mean a constraint, { W >= 3.0, W =< 4.6 }?".
meant(Name/_, Others, Hint) :-
    (   member(Name/Other, Others)
    ->  format(string(Hint), ": did you mean ~w/~w?", [Name, Other])
    ;   member(Like/Other, Others), dwim_match(Name, Like)
    ->  format(string(Hint), ": did you mean ~w/~w?", [Like, Other])
    ;   Hint = "" ).

%   parted_number(+Source, +Head, +Position, -Hint) is semidet: a number with a comma in it makes an argument too many.

parted_number(Source, Head, term_position(_,_,_,_,Ps), Hint) :-
    Head =.. [Name|Arguments],
    functor(Head, Name, Arity), Fewer is Arity - 1, role(Name/Fewer),
    nextto(A, B, Arguments), integer(A), integer(B),
    nth1(N, Arguments, A), nth1(N, Ps, From-_),
    M is N + 1, nth1(M, Ps, _-To),
    decimal_comma(Source, From-To, Text), \+ sub_string(Text, _, _, _, ", "),
    string_concat(": ", Text, Hint).
