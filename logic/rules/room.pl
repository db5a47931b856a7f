:- module(room, [room/3, room_constraints//1, room_items/2, widest_core/1, room_chains/2]).

/** <module> One room in its own frame: the door on the front wall, x to the right and y inwards

Stage 1 has made every choice, so the constraints here are a conjunction of linear ones, as data (linear.pl). A
free rectangle, the core, is kept empty: it holds the door's span and is at least a passage wide each way. The
pieces along each wall stand outside it; where two walls meet, one owns the corner. Every gap on a stretch is
either closed or opens onto the core by at least a passage, so no floor is shut in.

    room(Type,W,D,Door,core(X1,X2,Y1,Y2),Stretches,islands(Row,Islands))
    stretch(Name,Links,Blocks)       Blocks are a chain (chain.pl) of the Links that are joined to each other
    link(Gap,Role,Item,Along,Out,Front,Why)     Gap is joined-Why or apart-Why: to what is before it;
                                     Role is piece(K) or with(F-K); it takes Along of the wall, and stands Out from it
    island(Item,Across,Inwards,XBlock,YBlock,Seats,Front)    in the middle, with seat(Hand,Item) around it
    item(Type,Length,Depth,Wall)     what has a size, see piece_size/4
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(yall)).
:- use_module(chain).
:- use_module(grammar).

%!  room(+Type, +Layout, -Room) is det.
%
%   Room has the furniture of Layout, the atoms of stage 1; what is to be solved for is unbound in it.

room(Type, Layout, room(Type,W,D,Door,Core,Stretches,islands(Row,Islands))) :-
    Core = core(X1,X2,Y1,Y2),
    maplist(all_links(Layout, W, D), [front_left,left,back,right,front_right], Chains),
    Chains = [_-FrontLeft,_-Left,_-Back,_-Right,_-FrontRight],
    ( Left == []  -> X1 = 0.0 ; true ),
    ( Right == [] -> X2 = W   ; true ),
    ( FrontLeft == [], FrontRight == [] -> Y1 = 0.0 ; true ),
    ( Back == []  -> Y2 = D   ; true ),
    maplist(stretch(Chains, Layout, frame(W,D,Door,Core)), Chains, Stretches),
    ( memberchk(row(R), Layout) -> Row = R ; Row = across ),
    numbered(Layout, middle, Middle),
    maplist(island(Layout, W, Core, Row), Middle, Islands).

numbered(Layout, Place, Sorted) :-
    findall(N-(F-K), member(on(F,K,Place,N), Layout), Found),
    keysort(Found, Sorted).

% - links: what stands along a stretch, from its near end ------------------------------------------------

all_links(Layout, W, D, Stretch, Stretch-Links) :-
    numbered(Layout, Stretch, Names),
    wall_length(Stretch, W, D, Wall),
    phrase(links(Names, Stretch, Layout, Wall), Links).

wall_length(left,  _, D, D) :- !.
wall_length(right, _, D, D) :- !.
wall_length(_,     W, _, W).

links([], _, _, _) --> [].
links([N-(F-K)|Names], Stretch, Layout, Wall) -->
    { On = on(F,K,Stretch,N),
      ( memberchk(joined(F,K), Layout) -> Gap = joined-[joined(F,K),On] ; Gap = apart-[not(joined(F,K)),On] ),
      turned(F, K, Layout, Wall, Item, Along, Out, Front, Turned),
      companion(near, F, K, Layout, Wall, On, Near),
      companion(far, F, K, Layout, Wall, On, Far),
      append([Near,[link(joined-[],piece(K),Item,Along,Out,Front,[On|Turned])],Far], [link(_,R,I,A,O,Fr,Why)|Others]) },
    [link(Gap,R,I,A,O,Fr,Why)],
    Others,
    links(Names, Stretch, Layout, Wall).

turned(F, K, Layout, Wall, item(F,L,D,Wall), D, L, Front, [turned(F,K,Head)]) :-
    memberchk(turned(F,K,Head), Layout), !,
    ( Head == near -> Front = far ; Front = near ).
turned(F, K, _, Wall, item(F,L,D,Wall), L, D, out, [not(turned(F,K,near)),not(turned(F,K,far))]).

companion(Hand, F, K, Layout, Wall, On, [link(joined-[],with(F-K),item(G,L,D,Wall),L,D,out,[With,On])]) :-
    With = with(F,K,G,Hand),
    memberchk(With, Layout), !.
companion(_, _, _, _, _, _, []).

% - stretches --------------------------------------------------------------------------------------------

stretch(_, _, _, Name-[], stretch(Name,[],[])) :- !.
stretch(Chains, Layout, Frame, Name-Links, stretch(Name,Links,Blocks)) :-
    along(Name, Frame, Length, From, To, Why),
    end(Name, near, Chains, Layout, free(0.0,From,[]), Near),
    end(Name, far,  Chains, Layout, free(Length,To,Why), Far),
    joined_parts(Links, Parts),
    length_of(passage, P),
    ( memberchk(end(Name), Layout) -> End = joined-[end(Name)] ; End = apart-[not(end(Name))] ),
    memberchk(last(Name,N), Layout),
    blocks(Parts, ends(Near,Far,P), last(End,last(Name,N)), first, Blocks).

%   along(+Stretch, +Frame, -Length, -From, -To, -Why): along a stretch of this Length the core lies From..To. The
%   right half of the front wall counts from the right, so that both halves start in their corner and end at the
%   door, where any gap will do.

along(front_left, frame(_,_,Door,core(X1,_,_,_)), Length, X1, Length+P, [length(door_clearance)]) :-
    length_of(door_clearance, C), length_of(passage, P),
    Length = Door-C.
along(front_right, frame(W,_,Door,core(_,X2,_,_)), Length, W-X2, Length+P, [length(door_clearance),length(door_width)]) :-
    length_of(door_clearance, C), length_of(passage, P), length_of(door_width, DoorWidth),
    Length = W-Door-DoorWidth-C.
along(left,  frame(_,D,_,core(_,_,Y1,Y2)), D, Y1, Y2, []).
along(right, frame(_,D,_,core(_,_,Y1,Y2)), D, Y1, Y2, []).
along(back,  frame(W,_,_,core(X1,X2,_,_)), W, X1, X2, []).

%   end(+Stretch, +End, +Chains, +Layout, free(+Wall,+Core,+Why), -at(At,AtWhy,Edge,EdgeWhy)): a piece joined to this
%   end stands At: at the wall, or at the piece in a corner that the other stretch owns. A gap opens onto the core
%   from its Edge on, or from the wall on where no furniture stands round the corner.

end(Stretch, End, Chains, Layout, free(Wall,Core,Why), at(At,AtWhy,Edge,EdgeWhy)) :-
    (   corner(Stretch, End, Other, OtherEnd, A, B)
    ->  (   memberchk(Other-[Link|Links], Chains)
        ->  Edge = Core, EdgeWhy = [busy(Other)]
        ;   Edge = Wall, EdgeWhy = [] ),
        (   memberchk(corner(A,B,Other), Layout)
        ->  standing(OtherEnd, Other, [Link|Links], Layout, Depth, Standing),
            ( End == near -> At = Depth ; At = Wall-Depth ),
            AtWhy = [corner(A,B,Other)|Standing]
        ;   At = Wall, AtWhy = [not(corner(A,B,Other))] )
    ;   At = Wall, AtWhy = Why, Edge = Core, EdgeWhy = Why ).

%   corner(?Stretch, ?End, -Other, -OtherEnd, -A, -B): two ends meet in a corner, which stage 1 calls corner(A,B,_).

corner(front_left,  near, left,        near, front_left, left).
corner(left,        near, front_left,  near, front_left, left).
corner(left,        far,  back,        near, left, back).
corner(back,        near, left,        far,  left, back).
corner(back,        far,  right,       far,  back, right).
corner(right,       far,  back,        far,  back, right).
corner(right,       near, front_right, near, right, front_right).
corner(front_right, near, right,       near, right, front_right).

standing(near, _, [link(_,_,_,_,Out,_,Why)|_], _, Out, Why).
standing(far, Other, Links, Layout, Out, [last(Other,N)|Why]) :-
    memberchk(last(Other,N), Layout),
    last(Links, link(_,_,_,_,Out,_,Why)).

joined_parts([], []).
joined_parts([Link|Links], [[Link|Joined]|Parts]) :-
    joined_links(Links, Joined, Rest),
    joined_parts(Rest, Parts).

joined_links([Link|Links], [Link|Joined], Rest) :-
    Link = link(joined-_,_,_,_,_,_,_), !,
    joined_links(Links, Joined, Rest).
joined_links(Links, [], Links).

%   blocks(+Parts, +Ends, +Last, +Place, -Blocks): each part is a block, bound by its near side, the joints within it
%   and its far side. Place says whether it is the first.

blocks([], _, _, _, []).
blocks([Part|Parts], Ends, Last, Place, [block(_,Length,Bounds,Why)|Blocks]) :-
    Part = [link(Gap,_,_,_,_,_,_)|_],
    Gap = _-Why,
    near_bound(Gap, Place, Ends, Near),
    shut(Near, Parts, Last, Ends, NearMargin, FarMargin),
    joints(Part, Ends, NearMargin, FarMargin, Length, LengthWhy, Joints),
    far_bound(Parts, Ends, Last, Length, LengthWhy, Far),
    append([Near|Joints], [Far], Bounds),
    blocks(Parts, Ends, Last, later, Blocks).

near_bound(joined-Why, first, ends(at(At,AtWhy,_,_),_,_), at(At)-Reasons) :- !, append(Why, AtWhy, Reasons).
near_bound(apart-Why, _, ends(at(_,_,Edge,EdgeWhy),_,P), at_least(Edge+P)-[length(passage)|Reasons]) :-
    append(Why, EdgeWhy, Reasons).

%   shut(+Near, +LaterParts, +Last, +Ends, -NearMargin, -FarMargin): a part that reaches into a corner where other
%   furniture stands may shut floor in between that and a link that stands out more: so its joints keep a passage.

shut(Near, Parts, last(End-_,_), ends(at(_,_,_,LowWhy),at(_,_,_,HighWhy),P), NearMargin, FarMargin) :-
    ( Near = at(_)-_, LowWhy \== [] -> NearMargin = P ; NearMargin = 0 ),
    ( Parts == [], End == joined, HighWhy \== [] -> FarMargin = P ; FarMargin = 0 ).

%   joints(+Links, +Ends, +NearMargin, +FarMargin, -Length, -Why, -Bounds): the joint between two links lies at the core,
%   so that what stands out less is not shut in behind.

joints([link(_,_,_,Along,_,_,Why)|Links], Ends, NearMargin, FarMargin, Length, LengthWhy, Bounds) :-
    later_joints(Links, Ends, NearMargin-FarMargin, Along, Why, Length, LengthWhy, Bounds).

later_joints([], _, _, Length, Why, Length, Why, []).
later_joints([link(_-GapWhy,_,_,Along,_,_,LinkWhy)|Links], Ends, Margins, Offset, Why, Length, LengthWhy,
             [at_least(Low+NearMargin-Offset)-LowReasons, at_most(High-FarMargin-Offset)-HighReasons|Bounds]) :-
    Ends = ends(at(_,_,Low,LowWhy),at(_,_,High,HighWhy),_),
    Margins = NearMargin-FarMargin,
    append([[length(passage)],GapWhy,Why,LowWhy], LowReasons),
    append([[length(passage)],GapWhy,Why,HighWhy], HighReasons),
    append(Why, LinkWhy, Why1),
    later_joints(Links, Ends, Margins, Offset+Along, Why1, Length, LengthWhy, Bounds).

far_bound([[link(_-GapWhy,_,_,_,_,_,_)|_]|_], ends(_,at(_,_,High,HighWhy),P), _, Length, Why, at_most(High-P-Length)-Reasons) :-
    append([[length(passage)],GapWhy,Why,HighWhy], Reasons).
far_bound([], Ends, last(End-EndWhy,Last), Length, Why, Bound-Reasons) :-
    end_bound(End, Ends, Length, Bound, Own),
    append([[Last],EndWhy,Why,Own], Reasons).

end_bound(joined, ends(_,at(At,AtWhy,_,_),_),   Length, at(At-Length), AtWhy).
end_bound(apart,  ends(_,at(_,_,High,Why),P), Length, at_most(High-P-Length), [length(passage)|Why]).

% - in the middle ------------------------------------------------------------------------------------------

island(Layout, W, core(X1,X2,Y1,Y2), Row, N-(F-K),
       island(item(F,L,D,W),Across,Inwards,block(_,FullAcross,XBounds,Apart),block(_,FullInwards,YBounds,Apart),Seats,Front)) :-
    On = on(F,K,middle,N),
    ( memberchk(faces(F,K,Front), Layout) -> Faces = [faces(F,K,Front)] ; Front = none, Faces = [] ),
    ( memberchk(Front, [left,right]) -> Across = D, Inwards = L ; Across = L, Inwards = D ),
    findall(seat(Hand,item(G,_,_,_)), member(with(F,K,G,Hand), Layout), Found),
    maplist(seated(W), Found, Seats),
    full(Across, left, right, Seats, FullAcross),
    full(Inwards, outwards, inwards, Seats, FullInwards),
    findall(with(F,K,G,Hand), member(with(F,K,G,Hand), Layout), With),
    append([[On,length(passage)],Faces,With], Why),
    length_of(passage, P), length_of(door_clearance, C),
    XBounds = [at_least(X1+P)-Why, at_most(X2-P-FullAcross)-Why],
    YBounds = [at_least(Y1+P)-Why, at_least(C)-[On,length(door_clearance)], at_most(Y2-P-FullInwards)-Why],
    N0 is N - 1,
    ( memberchk(on(F0,K0,middle,N0), Layout) -> Apart = [row(Row),on(F0,K0,middle,N0)|Why] ; Apart = Why ).

seated(W, seat(Hand,Item), seat(Hand,Item)) :- Item = item(_,_,_,W).

full(Size, Low, High, Seats, Full) :-
    ( memberchk(seat(Low,item(_,_,A,_)), Seats)  -> Full1 = A+Size ; Full1 = Size ),
    ( memberchk(seat(High,item(_,_,B,_)), Seats) -> Full = Full1+B ; Full = Full1 ).

% - constraints --------------------------------------------------------------------------------------------

%!  room_constraints(+Room)// describes all constraints of a room but those of its sizes, see linear.pl.

room_constraints(room(_,W,D,Door,Core,Stretches,Islands)) -->
    core(Stretches, W, D, Door, Core),
    each(Stretches, stretch_constraints(W, D, Core)),
    island_constraints(Islands).

each([], _)        --> [].
each([X|Xs], Part) --> call(Part, X), each(Xs, Part).

core(Stretches, W, D, Door, core(X1,X2,Y1,Y2)) -->
    { length_of(passage, P), length_of(door_clearance, C), length_of(door_width, DoorWidth),
      Door2 = Door+DoorWidth, Width = [length(door_width)] },
    [(0 =< Door)-[], (Door2 =< W)-Width, (X1+P =< X2)-[length(passage)], (Y1+P =< Y2)-[length(passage)]],
    beside(busy(left),  Stretches, X1+C =< Door,  [length(door_clearance)]),
    beside(busy(right), Stretches, Door2+C =< X2, [length(door_clearance)|Width]),
    beside(busy(back),  Stretches, C =< Y2,       [length(door_clearance)]),
    within(W, D, X1, X2, Y1, Y2).

beside(busy(Name), Stretches, Constraint, Why) -->
    ( { memberchk(stretch(Name,[],_), Stretches) } -> [] ; [Constraint-[busy(Name)|Why]] ).

within(W, D, X1, X2, Y1, Y2) --> [(0 =< X1)-[], (X2 =< W)-[], (0 =< Y1)-[], (Y2 =< D)-[]].

stretch_constraints(W, D, Core, stretch(Name,Links,Blocks)) -->
    { room_behind(Name, W, D, Core, Room), length_of(passage, P) },
    stand_within(Links, Room),
    chain_constraints(Blocks, P).

room_behind(front_left,  _, _, core(_,_,Y1,_), Y1).
room_behind(front_right, _, _, core(_,_,Y1,_), Y1).
room_behind(left,        _, _, core(X1,_,_,_), X1).
room_behind(right,       W, _, core(_,X2,_,_), W-X2).
room_behind(back,        _, D, core(_,_,_,Y2), D-Y2).

stand_within([], _) --> [].
stand_within([link(_,_,_,_,Out,_,Why)|Links], Room) --> [(Out =< Room)-Why], stand_within(Links, Room).

island_constraints(Islands) -->
    { Islands = islands(_,List), length_of(passage, P), island_chains(Islands, Chains) },
    chains_constraints(Chains, P),
    each(List, seat_constraints).

chains_constraints([], _)              --> [].
chains_constraints([Chain|Chains], P)  --> chain_constraints(Chain, P), chains_constraints(Chains, P).

%   A row is one chain the one way, and each of its islands a chain of its own the other way.

island_chains(islands(_,[]), []) :- !.
island_chains(islands(Row,Islands), [Chain|Singles]) :-
    maplist(island_block(Row), Islands, Chain),
    ( Row == across -> Other = inwards ; Other = across ),
    maplist(alone(Other), Islands, Singles).

island_block(across,  island(_,_,_,X,_,_,_), X).
island_block(inwards, island(_,_,_,_,Y,_,_), Y).

alone(Row, Island, [Block]) :- island_block(Row, Island, Block).

seat_constraints(island(_,Across,Inwards,_,block(_,_,[_-Why|_],_),Seats,_)) --> fitted(Seats, Across, Inwards, Why).

fitted([], _, _, _) --> [].
fitted([seat(Hand,item(_,Length,_,_))|Seats], Across, Inwards, Why) -->
    { memberchk(Hand, [left,right]) -> Side = Inwards ; Side = Across },
    [(Length =< Side)-Why],
    fitted(Seats, Across, Inwards, Why).

% - what is to be drawn --------------------------------------------------------------------------------------

%!  room_items(+Room, -Items) is det.
%
%   Items are Kind-Item: free, or filling(Along,Out) where nothing but sizes fills a stretch from end to end.

room_items(room(_,_,_,_,_,Stretches,islands(_,Islands)), Items) :-
    maplist(stretch_items, Stretches, OnWalls),
    maplist(island_items, Islands, Free),
    append(OnWalls, A), append(Free, B), append(A, B, Items).

stretch_items(stretch(_,Links,Blocks), Items) :-
    ( Blocks = [block(_,_,[at(_)-_|Bounds],_)], memberchk(at(_)-_, Bounds) -> Kind = filling ; Kind = free ),
    maplist(link_item(Kind), Links, Items).

link_item(free,    link(_,_,Item,_,_,_,_), free-Item).
link_item(filling, link(_,_,Item,Along,Out,_,_), filling(Along,Out)-Item).

island_items(island(Item,_,_,_,_,Seats,_), [free-Item|Items]) :- maplist([seat(_,I),free-I]>>true, Seats, Items).

%!  widest_core(?Room) is det.
%
%   Where the sizes are known: the core reaches as near to each wall as the deepest piece there lets it.

widest_core(room(_,W,D,_,core(X1,X2,Y1,Y2),Stretches,_)) :-
    Stretches = [stretch(_,FrontLeft,_),stretch(_,Left,_),stretch(_,Back,_),stretch(_,Right,_),stretch(_,FrontRight,_)],
    append(FrontLeft, FrontRight, Front),
    ( Left == []  -> true ; deepest(Left, X1) ),
    ( Front == [] -> true ; deepest(Front, Y1) ),
    ( Right == [] -> true ; deepest(Right, R), X2 is W - R ),
    ( Back == []  -> true ; deepest(Back, B), Y2 is D - B ).

deepest(Links, Most) :- foldl([link(_,_,_,_,Out,_,_),M0,M]>>(M is max(M0, Out)), Links, 0, Most).

%!  room_chains(+Room, -Chains) is det.
%
%   All chains of a room, to be drawn where everything else is known.

room_chains(room(_,_,_,_,_,Stretches,Islands), Chains) :-
    maplist([stretch(_,_,Blocks),Blocks]>>true, Stretches, OnWalls),
    island_chains(Islands, Free),
    append(OnWalls, Free, Chains).
