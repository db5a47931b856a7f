:- module(record_access, []).

/** <module> Fields of records, compiled to unifications

library(record) defines predicates that read a field of a record and that make one. Where a record is known when a file
is compiled, a call of them becomes the unification that it stands for: link_out(Link, Out) becomes
Link = link(_,_,_,_,Out,_,_,_), which costs no inference.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(record)).

:- multifile user:goal_expansion/2.
:- dynamic user:goal_expansion/2.

%   unfolded(+Goal, -Record, -Term) is semidet: Goal is true if Record unifies with Term.

unfolded(Goal, Record, Term) :-
    compound(Goal),
    compound_name_arguments(Goal, Predicate, [A,B]),
    (record):current_record(Name, Owner, Definition, _, _),
    predicate_term(Predicate, Name, Definition, A-B, Record, Term),
    prolog_load_context(module, Module),
    ( Module == Owner -> true ; predicate_property(Module:Goal, imported_from(Owner)) ), !.

predicate_term(Predicate, Name, Definition, Fields-Record, Record, Term) :-
    atom_concat(make_, Name, Predicate),
    is_list(Fields), !,
    functor(Definition, Name, Arity),
    functor(Term, Name, Arity),
    maplist(field_given(Definition, Term), Fields).
predicate_term(Predicate, Name, Definition, Record-Value, Record, Term) :-
    atom_concat(Name, '_', Prefix),
    atom_concat(Prefix, Field, Predicate),
    functor(Definition, Name, Arity),
    functor(Term, Name, Arity),
    field_value(Field, Definition, Term, Value).

field_given(Definition, Term, Given) :- Given =.. [Field,Value], field_value(Field, Definition, Term, Value).

%   field_value(+Field, +Definition, ?Term, ?Value) is semidet: Term has the Value in this field of its definition.

field_value(Field, Definition, Term, Value) :- arg(N, Definition, Field), !, arg(N, Term, Value).

user:goal_expansion(Goal, Record = Term) :- record_access:unfolded(Goal, Record, Term).
