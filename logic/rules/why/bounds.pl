:- module(bounds, [room_parts/4, room_bounds/8, length_bounds/5, tight/4, bounds_json/3]).

/** <module> Why a room's lengths are as they are: what else they could have been, and which constraints bind

The room is solved once more from its seed, and compared with its own linear system. A target is `room`, `door`, or
the atom of stage 1 that puts a piece or a companion where it is: on(F,K,P,N), with(F,K,G,H).
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(library(yall)).
:- use_module('../answers').
:- use_module('../room/furnish').
:- use_module('../linear/grid').
:- use_module('../linear/linear').
:- use_module('../room/record_access').
:- use_module('../room/records').
:- use_module('../room/room').
:- use_module('../room/shape').
:- use_module('../room/solution').
:- use_module('../shared_walls/totals').

%!  room_parts(+Type, +Layout, +Shape, -Parts) is det.
%
%   Parts are Type-Atom of the pieces and companions of a room with this furniture, in the order of a house file. Shape is
%   `any`, or a known one (solution.pl).

room_parts(Type, Layout, Shape, Parts) :-
    whole_system(Type, Layout, Shape, Room, _),
    parts(Room, Found),
    maplist(part_name, Found, Parts).

part_name(part(Atom,item(F,_,_,_),_), F-Atom).

%!  room_bounds(+Type, +Layout, +Shape, +Left, +Seed, +Target, -Lengths, -Binding) is det.
%
%   Lengths are length(Name,Value,Least-LeastWhy,Greatest-GreatestWhy) of the target, in the house's unit. Least and
%   Greatest are what it could have been with this furniture: a piece's size in a room of this size, a place where all
%   sizes are what they are; a room's size with an area within Least-Most, where Left says so. Each has the reasons (reasons.pl) why it can be no further. Binding are
%   binds(Sum,Relation,Constant,Why): the constraints on the target that are tight, a sum of Factor*Name and a Constant
%   that is Relation, "=<" or "=", to zero. A Name is Thing-What, where a Thing is a target or `floor`, the free one.

room_bounds(Type, Layout, Shape, Left, Seed, Target, Lengths, Binding) :-
    whole_system(Type, Layout, Shape, Room, Furnished),
    left_system(Left, Type, Room, Bounded), append(Furnished, Bounded, System),
    call(furnished(Type, Layout, Shape, quick, Solved), Seed, _),
    is_room(Solved),
    room_items(Room, Items),
    parts(Room, Parts),
    names(Room, Parts, Names),
    sizes(Room, Items, Sizes),
    target_lengths(Target, Room, Parts, Asked),
    copy_term(k(Room,Sizes,Asked,Names), k(Solved,SolvedSizes,Values,SolvedNames)),
    maplist(asked_bounds(System, Sizes-SolvedSizes), Asked, Values, Lengths),
    term_variables(Asked, Variables),
    tight(System, Names-SolvedNames, Variables, Binding).

%   left_system(+Left, +Type, +Room, -System): what the area that is Left to a room says of each side by itself.

left_system(any, _, _, []).
left_system(Least-Most, Type, Room, System) :-
    room_width(Room, W), room_depth(Room, D),
    type_ranges(Type, ranges(W1-W2,D1-D2,_)),
    maplist(of_house, [D1*W =< Most,W1*D =< Most,Least =< D2*W,Least =< W2*D], System).

of_house(Constraint, Constraint-[house_area]).

sizes(Room, Items, [W,D|Sizes]) :-
    room_width(Room, W), room_depth(Room, D),
    foldl(item_sizes, Items, Sizes, []).

item_sizes(_-item(_,L,D,_), [L,D|Sizes], Sizes).

% - what has a name ------------------------------------------------------------------------------------------

%   parts(+Room, -Parts): part(Atom,Item,Places) of each piece, before its companions; Places are What-Expression. The
%   expressions share their variables with the room.

parts(Room, Parts) :-
    room_islands(Room, Islands), room_stretches(Room, Stretches),
    maplist(island_parts, Islands, Free),
    maplist(stretch_parts, Stretches, OnWalls),
    append(Free, A), append(OnWalls, B), append(A, B, Parts).

island_parts(Island, [part(On,Item,[across-X,inwards-Y])|Companions]) :-
    island_item(Island, Item), island_seats(Island, Seats),
    island_xblock(Island, block(X0,_,[_-Why|_],_)), island_yblock(Island, block(Y0,_,_,_)),
    Why = [On|_], On = on(F,K,_,_),
    ( space_at(left, Seats, Left)      -> X = X0+Left ; X = X0 ),
    ( space_at(outwards, Seats, Outer) -> Y = Y0+Outer ; Y = Y0 ),
    maplist(seat_part(F-K), Seats, Companions).

seat_part(F-K, seat(Hand,Item), part(with(F,K,G,Hand),Item,[])) :- Item = item(G,_,_,_).

stretch_parts(stretch(_,Links,Blocks), Parts) :-
    link_parts(Links, Blocks, none, Placed),
    own_parts(Placed, Placed, Parts).

%   link_parts(+Links, +Blocks, +End, -Placed): Role-Part. A link stands at the End of the one that it is joined to, or
%   at the start of the next block.

link_parts([], _, _, []).
link_parts([Link|Links], Blocks, End, [Role-part(Atom,Item,[along-Start])|Placed0]) :-
    link_seat(Link, Seat),
    ( Seat = With-Sat, With = with(F,K,_,_) -> Placed0 = [with(F-K)-part(With,Sat,[])|Placed] ; Placed0 = Placed ),
    link_gap(Link, Gap), link_role(Link, Role), link_item(Link, Item), link_along(Link, Along), link_why(Link, [Atom|_]),
    (   ( Gap = apart-_ ; End == none )
    ->  Blocks = [block(Start,_,_,_)|Later]
    ;   Start = End, Later = Blocks ),
    link_parts(Links, Later, Start+Along, Placed).

own_parts([], _, []).
own_parts([piece(K)-Part|Placed], All, [Part|Parts]) :- !,
    Part = part(_,item(F,_,_,_),_),
    companions(All, F-K, Parts, Others),
    own_parts(Placed, All, Others).
own_parts([_|Placed], All, Parts) :- own_parts(Placed, All, Parts).

companions([], _, Parts, Parts).
companions([Role-Part|Placed], Piece, Parts, Others) :-
    ( Role == with(Piece) -> Parts = [Part|Parts1] ; Parts = Parts1 ),
    companions(Placed, Piece, Parts1, Others).

%   names(+Room, +Parts, -Names): Variable-Name of all that is unknown in the room's system.

names(Room, Parts, Names) :-
    room_width(Room, W), room_depth(Room, D), room_door(Room, Door), room_core(Room, core(X1,X2,Y1,Y2)),
    maplist(part_names, Parts, Each),
    append([[W-(room-width),D-(room-depth),Door-(door-left),
             X1-(floor-left),X2-(floor-right),Y1-(floor-front),Y2-(floor-back)]|Each], Names).

part_names(part(Atom,item(_,L,D,_),Places), [L-(Atom-length),D-(Atom-depth)|Names]) :-
    maplist(place_name(Atom), Places, Names).

place_name(Atom, What-Expression, Start-(Atom-What)) :- term_variables(Expression, [Start|_]).

%   target_lengths(+Target, +Room, +Parts, -Lengths): Kind-What-Expression, where Kind says what is given: nothing to a
%   room, the room's sizes to a piece, all sizes to a place.

target_lengths(room, Room, _, [room-width-W,room-depth-D]) :- !, room_width(Room, W), room_depth(Room, D).
target_lengths(door, Room, _, [place-left-Door])           :- !, room_door(Room, Door).
target_lengths(Atom, _, Parts, [piece-length-L,piece-depth-D|Lengths]) :-
    memberchk(part(Atom,item(_,L,D,_),Places), Parts),
    maplist(as_place, Places, Lengths).

as_place(What-Expression, place-What-Expression).

% - what a length could have been ----------------------------------------------------------------------------

asked_bounds(System, Sizes, Kind-What-X, _-_-Solved, Length) :-
    given(Kind, Sizes, Given),
    Value is Solved,
    length_bounds(System, Given, What-X, Value, Length).

given(room,  _, []-[]).
given(piece, [W,D|_]-[SolvedW,SolvedD|_], [W,D]-[SolvedW,SolvedD]).
given(place, Sizes, Sizes).

%!  length_bounds(+System, +Given, +Name-Expression, +Value, -Length) is det.
%
%   Length is length(Name,Value,Least-LeastWhy,Greatest-GreatestWhy) of an Expression in the System, where Given are
%   Variables-Values.

length_bounds(System, Given, What-X, Value, length(What,Value,Low-LowWhy,High-HighWhy)) :-
    (   findall(L-H, ( posted_with(Given, System), {V = X}, extreme(V, L, H) ), [Low-High])
    ->  past(System, Given, X =< Low-0.001, LowWhy),
        past(System, Given, High+0.001 =< X, HighWhy)
    ;   Low = Value, High = Value, LowWhy = [], HighWhy = [] ).

posted_with(Sizes-Values, System) :- Sizes = Values, posted(System).

extreme(V, V, V)      :- number(V), !.
extreme(V, Low, High) :- inf(V, Low0), sup(V, High0), inner_range(Low0-High0, Low-High).

%   past(+System, +Given, +Constraint, -Why): Why are the reasons of a minimal part of the system that excludes it.

past(System, Sizes-Values, Constraint, Why) :-
    findall(Reasons,
            ( Sizes = Values,
              minimal_conflict([Constraint-[]|System], Conflict),
              findall(R, ( member(_-Rs, Conflict), member(R, Rs) ), Found), sort(Found, Reasons) ),
            All),
    ( All = [Why] -> true ; Why = [] ).

% - which constraints bind -----------------------------------------------------------------------------------

%!  tight(+System, +Names-Solved, +Variables, -Binding) is det.
%
%   Binding are binds(Sum,Relation,Constant,Why), see room_bounds/8, of the constraints on these Variables; Names are
%   Variable-Name, and Solved are Value-Name.

tight(System, Names-SolvedNames, Variables, Binding) :-
    pairs_keys(SolvedNames, Values),
    rows(System, Rows),
    term_variables(System, All),
    maplist(named(Names, Values), All, Numbered),    % none for what CLP(R) alone knows, to state a clause's constraints
    findall(N, ( nth0(N, All, Variable), member(V, Variables), V == Variable ), Wanted),
    findall(Bound, ( nth0(I, Rows, Row), nth0(I, System, _-Why), binds(Row, Why, Wanted, Numbered, Bound) ), Found),
    list_to_set(Found, Binding).

named([], [], _, none).
named([V-Name|_], [Value0|_], Variable, Name-Value) :- V == Variable, !, Value is Value0.
named([_|Names], [_|Values], Variable, Named)       :- named(Names, Values, Variable, Named).

binds([Pairs0,Constant,Relation], Why, Wanted, Numbered, binds(Sum,Relation,Constant,Why)) :-
    exclude([[_,Factor]]>>(Factor =:= 0), Pairs0, Pairs),
    once(( member([N,_], Pairs), memberchk(N, Wanted) )),
    foldl(summand(Numbered), Pairs, Sum-Constant, []-Total),
    abs(Total) < 1.0e-6.

summand(Numbered, [N,Factor], [Factor*Name|Sum]-Total0, Sum-Total) :-
    nth0(N, Numbered, Name-Value),
    Total is Total0 + Factor*Value.

% - as JSON --------------------------------------------------------------------------------------------------

%!  bounds_json(+Lengths, +Binding, -Json) is det.
%
%   Json has "lengths", a list of [Name,Value,Least,LeastReasons,Greatest,GreatestReasons], and "binding", one of
%   [Sum,Relation,Constant,Reasons] with Sum a list of [Factor,Thing,What], all in metres. Reasons are as in placed/3.

bounds_json(Lengths, Binding, Json) :-
    maplist(length_record, Lengths, LengthRecords),
    maplist(binding_record, Binding, BindingRecords),
    as_json(_{lengths:LengthRecords, binding:BindingRecords}, Json).

length_record(length(Name,Value,Low-LowWhy,High-HighWhy), [Name,V,L,LowReasons,H,HighReasons]) :-
    maplist(metres, [Value,Low,High], [V,L,H]),
    maplist(reason_record, LowWhy, LowReasons),
    maplist(reason_record, HighWhy, HighReasons).

binding_record(binds(Sum,Relation,Constant,Why), [Summands,Relation,Metres,Reasons]) :-
    metres(Constant, Metres),
    maplist(summand_record, Sum, Summands),
    maplist(reason_record, Why, Reasons).

summand_record(Factor*(Thing-What), [Factor,Text,What]) :- term_string(Thing, Text).
