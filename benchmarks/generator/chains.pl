:- module(chains, [starts/5]).

/** <module> Chains of equal blocks, to see how their gaps are distributed */

:- use_module(library(apply)).
:- use_module(library(http/json)).
:- use_module(library(lists)).
:- use_module('../../logic/rules/linear/chain').

%!  starts(+Count, +Length, +Whole, +Seeds, -Json) is det.
%
%   Json lists, for each of the Seeds, where Count blocks of this Length start that stand in a row on the Whole.

starts(Count, Length, Whole, Seeds, Json) :-
    findall(Starts, ( member(Seed, Seeds), sampled(Count, Length, Whole, Seed, Starts) ), All),
    with_output_to(string(Json), json_write(current_output, All)).

sampled(Count, Length, Whole, Seed, Starts) :-
    Last is Whole - Length,
    length(Starts, Count),
    maplist(block_at(Length, Last), Starts, Blocks),
    call(chain_sample(Blocks, 0), Seed, _).

block_at(Length, Last, Start, block(Start,Length,[at_least(0)-[],at_most(Last)-[]],[])).
