:- module(stretch, [stretch/5, stretch_constraints//2, fronts_constraints//1, stretch_items/2, filled_between/3, deepest/2]).

/** <module> A stretch of wall as a chain of blocks, each of links (links.pl) that are joined to each other

The links stand outside the room's core; where two stretches meet, one owns the corner. Every gap on a stretch is
either closed or opens onto the core by at least a passage, so no floor is shut in.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module('../linear/chain').
:- use_module('../language/lengths').
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).

%!  stretch(+Chains, +Layout, +Room, +NameAndLinks, -Stretch) is det.
%
%   Stretch has the bounds of its links, where Chains are all stretches' Name-Links.

stretch(_, _, _, Name-[], stretch(Name,[],[])) :- !.
stretch(Chains, Layout, Room, Name-Links, stretch(Name,Links,Blocks)) :-
    phrase(along(Name, Room, Length, From, To), Why),
    stretch_end(Name, near, Chains-Layout, free(0.0,From,Why), Near),
    stretch_end(Name, far,  Chains-Layout, free(Length,To,Why), Far),
    joined_parts(Links, Parts),
    phrase(last_gap(Name, Layout, LastGap), LastWhy),
    blocks(Parts, first, ends(Near,Far,LastGap-LastWhy), Blocks).

%   along(+Name, +Room, -Length, -From, -To)//: along a stretch of this Length the core lies From..To. A half of a wall
%   counts from its corner, so that it ends at a door, where any gap will do; what is between two doors, as its wall does.

along(Name, Room, Length, From, To) -->
    { room_doors(Room, AllDoors), stretch_wall(Name, Wall), wall_doors(Wall, AllDoors, Doors),
      wall_size(Wall, Room, Size), wall_span(Wall, Room, Low, High) },
    along_doors(Doors, Name, Size, Low-High, Length, From, To).

along_doors([], _, Size, Low-High, Size, Low, High) --> [].
along_doors([Door|Doors], between(_,I), _, _, Length, From, Length+P) --> !,
    { nth1(I, [Door|Doors], door(Start,Width,Why)), nth1(I, Doors, door(Length0,_,_)), length_of(passage, P) },
    required(door_clearance, C), because(Why),
    { Length = Length0-C, From = Start+Width+C-P }.
along_doors([Door|Doors], Name, Size, Low-High, Length, From, Length+P) -->
    { length_of(passage, P) },
    required(door_clearance, C),
    (   { counted(Name, along) }
    ->  { Door = door(Start,_,_), Length = Start-C, From = Low }
    ;   { last([Door|Doors], door(Start,Width,Why)) },
        because(Why),
        { Length = Size-Start-Width-C, From = Size-High } ).

%   stretch_end(+Name, +Hand, +ChainsAndLayout, +Free, -End): End is end(At-AtWhy,Edge-EdgeWhy), where Free is
%   free(Wall,Core,Why). A piece joined to this end stands At: at the wall, or at the piece in a corner that the other
%   stretch owns. A gap opens onto the core from its Edge on, or from the wall on where no furniture stands round the
%   corner. In an open corner it keeps clear of a door.

stretch_end(Name, Hand, Chains-Layout, free(Wall,Core,Why), end(At,Edge)) :-
    (   meeting(Name, Hand, Chains, Other-OtherHand, Owned, Open)
    ->  (   memberchk(Open, Layout)
        ->  At = Edge, clear_of_door(Hand, Wall, Open, Edge)
        ;   (   memberchk(Other-[Link|Links], Chains)
            ->  Edge = Core-[busy(Other)]
            ;   Edge = Wall-[] ),
            (   memberchk(Owned, Layout)
            ->  phrase(standing(OtherHand, Other, [Link|Links], Layout, Depth), Standing),
                ( Hand == near -> Place = Depth ; Place = Wall-Depth ),
                At = Place-[Owned|Standing]
            ;   At = Wall-[not(Owned)] ) )
    ;   At = Wall-Why, Edge = Core-Why ).

clear_of_door(Hand, Wall, Open, Edge-[Open,length(door_clearance)]) :-
    length_of(passage, P), length_of(door_clearance, C),
    ( Hand == near -> Edge = C-P ; Edge = Wall-C+P ).

%   standing(+Hand, +Name, +Links, +Layout, -Out)//: how far the link at this end of a stretch stands out.

standing(near, _, [Link|_], _, Out) --> link_depth(Link, Out).
standing(far, Name, Links, Layout, Out) -->
    holds(last(Name,_), Layout),
    { last(Links, Link) },
    link_depth(Link, Out).

link_depth(Link, Out) --> { link_out(Link, Out), link_why(Link, Why) }, because(Why).

last_gap(Name, Layout, Gap) -->
    holds(last(Name,_), Layout),
    ( holds(end(Name), Layout) -> { Gap = joined } ; fails(end(Name)), { Gap = apart } ).

joined_parts([], []).
joined_parts([Link|Links], [[Link|Joined]|Parts]) :-
    joined_links(Links, Joined, Rest),
    joined_parts(Rest, Parts).

joined_links([Link|Links], [Link|Joined], Rest) :-
    link_gap(Link, joined-_), !,
    joined_links(Links, Joined, Rest).
joined_links(Links, [], Links).

%   blocks(+Parts, +Position, +Ends, -Blocks): each part is a block, bound by its near side, the joints within it and its
%   far side. Position is first or later; Ends is ends(Near,Far,LastGap-Why).

blocks([], _, _, []).
blocks([Part|Parts], Position, Ends, [block(_,Length,Bounds,Why)|Blocks]) :-
    Part = [Link|Links],
    link_gap(Link, Gap-Why), link_along(Link, Along), link_why(Link, LinkWhy),
    phrase(near_bound(Gap-Why, Position, Ends, Near), NearWhy),
    margins(Near, Parts, Ends, Margins),
    phrase(joints(Links, Ends, Margins, Along-LinkWhy, Length-LengthWhy), Joints, [Far-FarWhy]),
    phrase(far_bound(Parts, Ends, Length, Far), FarWhy, LengthWhy),
    Bounds = [Near-NearWhy|Joints],
    blocks(Parts, later, Ends, Blocks).

near_bound(joined-Why, first, ends(end(At-AtWhy,_),_,_), at(At)) --> !, because(Why), because(AtWhy).
near_bound(apart-Why, _, ends(end(_,Edge-EdgeWhy),_,_), at_least(Edge+P)) -->
    required(passage, P), because(Why), because(EdgeWhy).

%   margins(+Near, +LaterParts, +Ends, -Margins): a part that reaches into a corner where other furniture stands may shut
%   floor in between that and a link that stands out more: so its joints keep a passage from that end.

margins(Near, Parts, ends(end(_,_-LowWhy),end(_,_-HighWhy),LastGap-_), NearMargin-FarMargin) :-
    length_of(passage, P),
    ( Near = at(_), LowWhy \== [] -> NearMargin = P ; NearMargin = 0 ),
    ( Parts == [], LastGap == joined, HighWhy \== [] -> FarMargin = P ; FarMargin = 0 ).

%   joints(+Links, +Ends, +Margins, +Offset, -Length)//: the bounds of the joints between links, where the first lies at
%   Offset, a Value-Why as Length is. A joint lies at the core, so that what stands out less is not shut in behind.

joints([], _, _, Length, Length) --> [].
joints([Link|Links], Ends, Margins, Offset-Why, Length) -->
    { Ends = ends(end(_,Low-LowWhy),end(_,High-HighWhy),_),
      Margins = NearMargin-FarMargin,
      link_gap(Link, _-GapWhy), link_along(Link, Along), link_why(Link, LinkWhy),
      phrase(( because(GapWhy), because(Why) ), JointWhy),
      phrase(because(LowWhy), LowReasons, [length(passage)|JointWhy]),
      phrase(because(HighWhy), HighReasons, [length(passage)|JointWhy]),
      phrase(because(Why), Why1, LinkWhy) },
    [at_least(Low+NearMargin-Offset)-LowReasons, at_most(High-FarMargin-Offset)-HighReasons],
    joints(Links, Ends, Margins, Offset+Along-Why1, Length).

%   far_bound(+LaterParts, +Ends, +Length, -Bound)//: the bound of a block of this length at its far side.

far_bound([[Link|_]|_], ends(_,end(_,High-Why),_), Length, at_most(High-P-Length)) -->
    { link_gap(Link, _-GapWhy) },
    required(passage, P), because(GapWhy), because(Why).
far_bound([], ends(_,end(At,Edge),Gap-GapWhy), Length, Bound) -->
    because(GapWhy),
    last_bound(Gap, At, Edge, Length, Bound).

last_bound(joined, At-Why, _, Length, at(At-Length))          --> because(Why).
last_bound(apart, _, High-Why, Length, at_most(High-P-Length)) --> required(passage, P), because(Why).

% - constraints, and what is to be sampled -----------------------------------------------------------------

%!  stretch_constraints(+Stretch, +Room)// describes the constraints of what stands along a stretch, see linear.pl.

stretch_constraints(stretch(_,[],_), _) --> !.
stretch_constraints(stretch(Name,Links,Blocks), Room) -->
    { depth_before_core(Name, Room, Depth), length_of(passage, P) },
    stand_within(Links, Depth),
    chain_constraints(Blocks, P).

depth_before_core(Name, Room, Depth) :- stretch_wall(Name, Wall), wall_depth(Wall, Room, Depth).

wall_depth(front, Room, Y1)   :- room_core(Room, core(_,_,Y1,_)).
wall_depth(left,  Room, X1)   :- room_core(Room, core(X1,_,_,_)).
wall_depth(right, Room, W-X2) :- room_core(Room, core(_,X2,_,_)), room_width(Room, W).
wall_depth(back,  Room, D-Y2) :- room_core(Room, core(_,_,_,Y2)), room_depth(Room, D).

stand_within([], _) --> [].
stand_within([Link|Links], Depth) -->
    { link_out(Link, Out), link_seat(Link, Seat), link_why(Link, Why) },
    (   { Seat = With-item(_,_,Own,_) }
    ->  ( { With = with(_,_,_,front) } -> [(Out+Own =< Depth)-[With|Why]] ; away(Out+Own, Depth, [With|Why]) )
    ;   [(Out =< Depth)-Why] ),
    stand_within(Links, Depth).

away(Out, Depth, Why) --> { length_of(passage, P) }, [(Out+P =< Depth)-[length(passage)|Why]].

%!  fronts_constraints(+Stretches)// describes: what is in front of a piece is no longer than the piece.

fronts_constraints([]) --> [].
fronts_constraints([stretch(_,Links,_)|Stretches]) --> fronts(Links), fronts_constraints(Stretches).

fronts([]) --> [].
fronts([Link|Links]) -->
    { link_seat(Link, Seat), link_along(Link, Along), link_why(Link, Why) },
    ( { Seat = With-item(_,Length,_,_) } -> [(Length =< Along)-[With|Why]] ; [] ),
    fronts(Links).

%!  stretch_items(+Stretch, -Items) is det.
%
%   Items are Kind-Item: free, or filling(Along,Out) where nothing but sizes fills the stretch from end to end.

stretch_items(Stretch, Items) :-
    Stretch = stretch(_,Links,_),
    (   filled_between(Stretch, _, _)
    ->  maplist(filling_item, Links, Own)
    ;   maplist(free_item, Links, Own) ),
    seat_items(Links, Own, Items).

seat_items([], Items, Items).
seat_items([Link|Links], Own, Items) :-
    link_seat(Link, Seat),
    ( Seat = _-Item -> Items = [free-Item|Others] ; Items = Others ),
    seat_items(Links, Own, Others).

%!  filled_between(+Stretch, -Start, -Last) is semidet.
%
%   Nothing but sizes fills the stretch from end to end: what stands there starts at Start, which is the same place as Last.

filled_between(stretch(_,_,[block(_,_,[at(Start)-_|Bounds],_)]), Start, Last) :- memberchk(at(Last)-_, Bounds).

free_item(Link, free-Item) :- link_item(Link, Item).

filling_item(Link, filling(Along,Out)-Item) :- link_item(Link, Item), link_along(Link, Along), link_out(Link, Out).

%!  deepest(+Links, -Out) is det.
%
%   Out is how far the deepest of links stands out, where the sizes are known.

deepest(Links, Out) :- foldl(deeper, Links, 0, Out).

deeper(Link, Out0, Out) :-
    link_out(Link, Own), link_seat(Link, Seat),
    ( Seat = with(_,_,_,Hand)-item(_,_,Depth,_) -> hand(Hand, _, Gap), Out is max(Out0, Own+Gap+Depth) ; Out is max(Out0, Own) ).
