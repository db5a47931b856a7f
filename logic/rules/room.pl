:- module(room, [furnished/3, draw_room//1]).

/** <module> One room in its own frame: the door on the front wall, x to the right and y inwards

Stage 1 has made every choice, so the constraints here are a conjunction of linear ones. A free rectangle, the
core, is kept empty: it holds the door's span and is at least a passage wide each way. The pieces along each
wall stand outside it; where two walls meet, one owns the corner. Every gap on a stretch is either closed or
opens onto the core by at least a passage, so no floor is shut in.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(draw).
:- use_module(grammar).

%!  furnished(+Type, +Layout, -Room) is semidet.
%
%   Room is room(Type,Width,Depth,Door,Core,Chains,Islands), metres, under all constraints of a room of this type with
%   the furniture of Layout, the atoms of stage 1. Fails if, and only if, they have no solution.

furnished(Type, Layout, room(Type,W,D,Door,Core,Chains,Islands)) :-
    once(grammar:room_size(Type, W, D)),
    metres(door_width, DoorWidth),
    { Door >= 0, Door + DoorWidth =< W },
    maplist(stretch_chain(Layout, W, D), [front_left,left,back,right,front_right], Chains),
    core(Chains, W, D, Door, DoorWidth, Core),
    Frame = frame(W,D,Door,DoorWidth,Core),
    maplist(along_wall(Chains, Layout, Frame), Chains),
    numbered(Layout, middle, Free),
    maplist(island(Frame), Free, Islands),
    ( memberchk(row(Direction), Layout) -> in_row(Direction, Islands) ; true ).

% - pieces ---------------------------------------------------------------------
% chain(Stretch,Pieces,End): the pieces in order from the near end; End says if the last is joined to the far one.
% piece(Type,Start,Length,Depth,Joined): Start counts from the near end; Joined says joined or apart.

stretch_chain(Layout, W, D, Stretch, chain(Stretch,Pieces,End)) :-
    numbered(Layout, Stretch, Names),
    wall_length(Stretch, W, D, Wall),
    maplist(wall_piece(Layout, Wall), Names, Pieces),
    ( memberchk(end(Stretch), Layout) -> End = joined ; End = apart ).

numbered(Layout, Place, Names) :-
    findall(N-(F-K), member(on(F,K,Place,N), Layout), Numbered),
    keysort(Numbered, Sorted),
    pairs_values(Sorted, Names).

wall_length(left,  _, D, D) :- !.
wall_length(right, _, D, D) :- !.
wall_length(_,     W, _, W).

wall_piece(Layout, Wall, F-K, piece(F,_,Length,Depth,Joined)) :-
    once(grammar:piece_size(F, Length, Depth, Wall)),
    ( memberchk(joined(F,K), Layout) -> Joined = joined ; Joined = apart ).

% - the core ---------------------------------------------------------------------

core(Chains, W, D, Door, DoorWidth, core(X1,X2,Y1,Y2)) :-
    metres(passage, P),
    metres(door_clearance, C),
    ( busy(left, Chains)  -> { X1 >= 0, X1 + C =< Door }             ; X1 = 0.0 ),
    ( busy(right, Chains) -> { X2 =< W, X2 >= Door + DoorWidth + C } ; X2 = W ),
    ( ( busy(front_left, Chains) ; busy(front_right, Chains) ) -> { Y1 >= 0 } ; Y1 = 0.0 ),
    ( busy(back, Chains)  -> { Y2 =< D, Y2 >= C }                    ; Y2 = D ),
    { X2 - X1 >= P, Y2 - Y1 >= P, X1 =< Door, Door + DoorWidth =< X2 }.

busy(Stretch, Chains) :- memberchk(chain(Stretch,[_|_],_), Chains).

% - along a wall -------------------------------------------------------------------

along_wall(_, _, _, chain(_,[],_)) :- !.
along_wall(Chains, Layout, Frame, chain(Stretch,Pieces,End)) :-
    stretch(Stretch, Frame, Length, From, To, Room),
    maplist(stands_within(Room), Pieces),
    end(Stretch, near, Chains, Layout, free(0.0,From), free(Near,Low)),
    end(Stretch, far,  Chains, Layout, free(Length,To), free(Far,High)),
    Pieces = [piece(_,Start,_,_,Joined)|_],
    first(Joined, Start, Near, Low),
    chained(Pieces, Low, High, Last),
    last(End, Last, Far, High).

%   stretch(+Stretch, +Frame, -Length, -From, -To, -Room): along a stretch of this Length the core lies
%   From..To, and Room is left between wall and core. The right half of the front wall counts from the right,
%   so that both halves start in their corner and end at the door, where any gap will do.

stretch(front_left, frame(_,_,Door,_,core(X1,_,Y1,_)), Length, X1, To, Y1) :-
    beside_door(Door, Length, To).
stretch(front_right, frame(W,_,Door,DoorWidth,core(_,X2,Y1,_)), Length, From, To, Y1) :-
    { From = W - X2, Beyond = W - Door - DoorWidth },
    beside_door(Beyond, Length, To).
stretch(left,  frame(_,D,_,_,core(X1,_,Y1,Y2)), D, Y1, Y2, X1).
stretch(right, frame(W,D,_,_,core(_,X2,Y1,Y2)), D, Y1, Y2, Room) :- { Room = W - X2 }.
stretch(back,  frame(W,D,_,_,core(X1,X2,_,Y2)), W, X1, X2, Room) :- { Room = D - Y2 }.

beside_door(Beyond, Length, To) :-
    metres(door_clearance, C), metres(passage, P),
    { Length = Beyond - C, To = Length + P }.

stands_within(Room, piece(_,_,_,Depth,_)) :- { Depth =< Room }.

%   end(+Stretch, +End, +Chains, +Layout, free(+Wall,+Core), free(-At,-Edge)): a piece joined to this end stands
%   At: at the wall, or at the piece in a corner that the other stretch owns. A gap opens onto the core from its
%   Edge on, or from the wall on where no furniture stands round the corner.

end(Stretch, End, Chains, Layout, free(Wall,Core), free(At,Edge)) :-
    (   corner(Stretch, End, Other, OtherEnd), standing(Other, OtherEnd, Chains, piece(_,_,_,Depth,_))
    ->  Edge = Core,
        ( owns(Stretch, Other, Layout) -> At = Wall
        ; End == near                  -> At = Depth
        ; { At = Wall - Depth } )
    ;   corner(Stretch, End, _, _) -> At = Wall, Edge = Wall
    ;   At = Wall, Edge = Core ).

corner(front_left,  near, left,        near).
corner(left,        near, front_left,  near).
corner(left,        far,  back,        near).
corner(back,        near, left,        far).
corner(back,        far,  right,       far).
corner(right,       far,  back,        far).
corner(right,       near, front_right, near).
corner(front_right, near, right,       near).

owns(A, B, Layout) :- ( memberchk(corner(A,B,A), Layout) -> true ; memberchk(corner(B,A,A), Layout) ).

standing(Stretch, near, Chains, Piece) :- memberchk(chain(Stretch,[Piece|_],_), Chains).
standing(Stretch, far,  Chains, Piece) :- memberchk(chain(Stretch,Pieces,_), Chains), last(Pieces, Piece).

%   Pieces are joined, or apart by a passage that opens onto the core.

first(joined, Start, Near, _) :- { Start = Near }.
first(apart,  Start, _, Low)  :- metres(passage, P), { Start >= Low + P }.

chained([Last], _, _, Last) :- !.
chained([piece(_,S1,L1,_,_), Next|Pieces], Low, High, Last) :-
    Next = piece(_,S2,_,_,Joined),
    next(Joined, S1, L1, S2, Low, High),
    chained([Next|Pieces], Low, High, Last).

next(joined, S1, L1, S2, Low, High) :- { S2 = S1 + L1, S2 >= Low, S2 =< High }.
next(apart,  S1, L1, S2, Low, High) :-
    metres(passage, P),
    { S2 >= S1 + L1 + P, S2 >= Low + P, S1 + L1 + P =< High }.

last(joined, piece(_,S,L,_,_), Far, _)  :- { S + L = Far }.
last(apart,  piece(_,S,L,_,_), _, High) :- metres(passage, P), { S + L + P =< High }.

% - in the middle ---------------------------------------------------------------------
% island(Name,X,Y,Length,Depth): with a passage around it.

island(frame(W,_,_,_,core(X1,X2,Y1,Y2)), F-_, island(F,X,Y,L,D)) :-
    once(grammar:piece_size(F, L, D, W)),
    metres(passage, P), metres(door_clearance, C),
    { X >= X1 + P, X + L + P =< X2, Y >= Y1 + P, Y + D + P =< Y2, Y >= C }.

in_row(Direction, [A,B|Islands]) :- !, before(Direction, A, B), in_row(Direction, [B|Islands]).
in_row(_, _).

before(across,  island(_,X1,_,L,_), island(_,X2,_,_,_)) :- metres(passage, P), { X1 + L + P =< X2 }.
before(inwards, island(_,_,Y1,_,D), island(_,_,Y2,_,_)) :- metres(passage, P), { Y1 + D + P =< Y2 }.

% - drawing -----------------------------------------------------------------------------

%!  draw_room(+Room)// is det.
%
%   Fixes every length of a furnished room: sizes first, then the walls, then the widest core, then the places.

draw_room(room(Type,W,D,Door,core(X1,X2,Y1,Y2),Chains,Islands)) -->
    { room_extent(Type, W1, W2, D1, D2) },
    draw_each(draw_sizes(Type), Chains),
    draw_each(draw_island_size(Type), Islands),
    uniform(W, W1, W2), uniform(D, D1, D2),
    { lowest(X1), highest(X2), lowest(Y1), highest(Y2) },
    uniform(Door),
    draw_each(draw_chain, Chains),
    draw_each(draw_island, Islands).

draw_each(_, [])         --> [].
draw_each(Draw, [X|Xs])  --> call(Draw, X), draw_each(Draw, Xs).

draw_sizes(Type, chain(_,Pieces,_)) --> draw_each(draw_size(Type), Pieces).

draw_size(Type, piece(F,_,Length,Depth,_)) --> draw_extent(Type, F, Length, Depth).
draw_island_size(Type, island(F,_,_,L,D))  --> draw_extent(Type, F, L, D).

draw_extent(Type, F, Length, Depth) -->
    { piece_extent(Type, F, L1, L2, D1, D2) },
    uniform(Length, L1, L2), uniform(Depth, D1, D2).

draw_chain(chain(_,Pieces,End)) -->
    { gaps(Pieces, End, Gaps) },
    draw_starts(Pieces, Gaps).

%   gaps(+Pieces, +End, -Gaps): so many gaps of a chain are open, the one behind its last piece included.

gaps([], joined, 0).
gaps([], apart,  1).
gaps([piece(_,_,_,_,Joined)|Pieces], End, Gaps) :-
    gaps(Pieces, End, Behind),
    ( Joined == apart -> Gaps is Behind + 1 ; Gaps = Behind ).

draw_starts([], _) --> [].
draw_starts([piece(_,Start,_,_,apart)|Pieces], Gaps) --> !,
    { Behind is Gaps - 1 },
    start(Start, Behind),
    draw_starts(Pieces, Behind).
draw_starts([piece(_,Start,_,_,joined)|Pieces], Gaps) -->
    uniform(Start),
    draw_starts(Pieces, Gaps).

draw_island(island(_,X,Y,_,_)) --> uniform(X), uniform(Y).
