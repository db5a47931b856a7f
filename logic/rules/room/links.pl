:- module(links, [stretch_links/5]).

/** <module> What stands along a stretch of wall, from its near end

A link is a piece or one of its companions.
*/

:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).

%!  stretch_links(+Placed, +Layout, +Room, +Name, -Links) is det.
%
%   Links are Name-Links, of the pieces that Placed, pairs of a place and its on/4 atoms in order, has on the stretch.

stretch_links(Placed, Layout, Room, Name, Name-Links) :-
    (   memberchk(Name-Ons, Placed)
    ->  walls(Name, Room, Walls),
        phrase(links(Ons, Walls, Layout), Links)
    ;   Links = [] ).

walls(Name, Room, Length-Across) :-
    stretch_wall(Name, Wall),
    wall_size(Wall, Room, Length),
    neighbour(Wall, Next, _, _),
    wall_size(Next, Room, Across).

links([], _, _) --> [].
links([On|Ons], Walls, Layout) -->
    { phrase(gap(On, Layout, Kind), Why),
      piece_link(On, Walls, Layout, Gap, Link) },
    companion(near, On, Walls-Layout, Kind-Why, Gap),
    [Link],
    companion(far, On, Walls-Layout, joined-[], _),
    links(Ons, Walls, Layout).

%   gap(+On, +Layout, -Kind)//: Kind is joined or apart, to what is before the piece and its companions.

gap(On, Layout, Kind) -->
    { On = on(F,K,_,_) },
    ( holds(joined(F,K), Layout) -> { Kind = joined } ; fails(joined(F,K)), { Kind = apart } ),
    [On].

piece_link(On, Walls, Layout, Gap, Link) :-
    On = on(F,K,_,_),
    make_link([gap(Gap),role(piece(K)),item(item(F,L,D,Walls)),along(Along),out(Out),front(Front),seat(Seat),why([On|Why])], Link),
    phrase(facing(On, Layout, L-D, Along-Out, Front), Why),
    seat(F-K, Walls, Layout, Seat).

seat(F-K, Walls, Layout, Seat) :-
    (   member(Hand, [front,away(front)]), With = with(F,K,G,Hand), memberchk(With, Layout)
    ->  Seat = With-item(G,_,_,Walls)
    ;   Seat = none ).

%   facing(+On, +Layout, ?Sizes, -Taken, -Front)//: a turned piece takes its depth of the wall.

facing(on(F,K,_,_), Layout, L-D, Along-Out, Front) -->
    (   holds(turned(F,K,Head), Layout)
    ->  { Along = D, Out = L, ( Head == near -> Front = far ; Front = near ) }
    ;   fails(turned(F,K,near)), fails(turned(F,K,far)),
        { Along = L, Out = D, Front = out } ).

%   companion(+Hand, +On, +WallsAndLayout, ?Gap0, ?Gap)//: a companion at this hand stands at Gap0 from what is before,
%   and what follows is joined to it.

companion(Hand, On, Walls-Layout, Gap0, Gap) -->
    { On = on(F,K,_,_), With = with(F,K,G,Hand) },
    (   { memberchk(With, Layout) }
    ->  { make_link([gap(Gap0),role(with(F-K)),item(item(G,L,D,Walls)),along(L),out(D),front(out),seat(none),why([With,On])], Link),
          Gap = joined-[] },
        [Link]
    ;   { Gap = Gap0 } ).
