:- module(star_areas, [area_conflict/5, greatest_star/4, outline/2, rooms_in_area/5]).

/** <module> The area of a whole star: of the main room, and of the rooms around it

Before there is furniture, the sizes of the types and the sides that they stand on bound the area of a house: what is out of
these bounds is impossible. Furnished rooms have sizes already; where these leave the main room no area, they are furnished once more,
nearer to the least or the greatest size that their furniture allows. All sizes between are possible, since they are
solutions of linear constraints.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(fixed_rooms).
:- use_module('../room/furnish').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(main_room).
:- use_module('../room/record_access').
:- use_module('../room/records').
:- use_module('../room/solution').
:- use_module('../shared_walls/totals').

% - without furniture -------------------------------------------------------------------------------------------

%!  area_conflict(+Rooms, +Corners, +Types, +Without, -Reasons) is semidet.
%
%   No house whose Rooms, in clockwise order, are room(R,Type,Side), or fixed(I,R,Side,Width,Depth) for the I-th fixed room, has
%   the area that the grammar states, where the clauses Without are left out. Reasons are of as few rooms and sides as do: of a
%   room, which types it does not have, so that they hold for all that are still smaller, or larger.

area_conflict(Rooms, Corners, Types, Without, Reasons) :-
    \+ memberchk(house_area, Without),
    total_area(Total),
    maplist(type_sizes(Without), Types, Known),
    maplist(sized_room(Known), Rooms, Sized),
    sides_known(Corners, Without, Sides),
    ( memberchk(fixed(_,_,_,_,_), Rooms) -> Ends = [least] ; Ends = [least,greatest] ),    % a main room reaches fixed ones however far
    member(End, Ends),
    beyond(End, Total, Sides, Sized), !,
    levels(End, Known, Levels),
    loosened(Sized, Levels, beyond(End, Total, Sides), [], Loose),
    maplist(type_atoms(End, Known), Loose, Each), append(Each, Atoms),
    reasons(Loose, Sides, Types, Without, Atoms, Reasons).

%   sized_room(+Known, +Room, -Sized): sized_room(R-Side,Sizes,I), with the Sizes of its type; I is a number for a fixed room, else `free`. Known are
%   Type-sizes(Widths,Areas).

sized_room(Known, room(R,Type,Side), sized_room(R-Side,Sizes,free)) :- memberchk(Type-Sizes, Known).
sized_room(_, fixed(I,R,Side,W,D), sized_room(R-Side,sizes(W-W,Area-Area),I)) :- Area is W*D.

type_sizes(Without, Type, Type-sizes(Widths,Areas)) :-
    (   memberchk(size(Type), Without)
    ->  Widths = 0-1.0e6, Areas = 0-1.0e12
    ;   type_ranges(Type, ranges(Widths,_,Areas)) ).

%   levels(+End, +Known, -Levels): sizes that are as small as those of any types, or as large, and first the least or the largest.

levels(End, Known, Levels) :-
    pairs_values(Known, [First|Others]), foldl(wider, Others, First, Any),
    findall(Area-Sizes, ( member(_-Sizes, Known), Sizes = sizes(_,Areas), at_end(End, Areas, Area) ), Keyed),
    ( End == least -> keysort(Keyed, Sorted) ; sort(1, @>=, Keyed, Sorted) ),
    pairs_values(Sorted, Types),
    Levels = [Any|Types].

wider(sizes(W1-W2,A1-A2), sizes(V1-V2,B1-B2), sizes(Low-High,Least-Most)) :-
    Low is min(W1, V1), High is max(W2, V2), Least is min(A1, B1), Most is max(A2, B2).

%   beside(+End, +Sizes, +Level) is semidet: no less than the Level, or no more.

beside(least, sizes(W-_,A-_), sizes(V-_,B-_))    :- W >= V, A >= B.
beside(greatest, sizes(_-W,_-A), sizes(_-V,_-B)) :- W =< V, A =< B.

%   sides_known(+Corners, +Without, -Sides) is nondet: what is known of the sides: nothing, which rooms stand on each, or the
%   Corners too. Nothing, where the distance between rooms is not.

sides_known(_, _, any).
sides_known(Corners, Without, Sides) :-
    \+ ( member(Name, [room_gap,door_clearance,door_width]), memberchk(length(Name), Without) ),
    member(Sides, [around(any),around(Corners)]).

beyond(End, Total, Sides, Sized) :- whole(End, Sides, Sized, Area), out(End, Total, Area).

out(least, _-Most, Area)     :- Area > Most + 1.0e-6.
out(greatest, Least-_, Area) :- Area < Least - 1.0e-6.

%   whole(+End, +Sides, +Sized, -Area): the least or greatest area of the main room and the rooms.

whole(End, Sides, Sized, Area) :-
    maplist(end_area(End), Sized, Areas),
    sum_list(Areas, Sum), max_list(Areas, Largest),
    main_area(End, Sides, Sized, Largest, Main),
    Area is Sum + Main.

end_area(End, sized_room(_,sizes(_,Areas),_), Area) :- at_end(End, Areas, Area).

at_end(least, X-_, X).
at_end(greatest, _-X, X).

main_area(least, any, _, Largest, Largest).
main_area(greatest, any, Sized, Largest, Area) :-           % two walls are at most as long as all rooms in a row
    findall(W, member(sized_room(_,sizes(_-W,_),_), Sized), Ws),
    in_a_row(Ws, 6, Length),
    Area is max(2*Largest, Length**2).
main_area(End, around(Corners), Sized, Largest, Area) :-
    maplist(wall(End, Corners, Sized), [north,east,south,west], [N,E,S,W]),
    Width is max(N, S), Height is max(E, W),
    least_area(Largest, Width-Height, Least),
    ( End == least -> Area = Least ; Area is 2*Least ).

%!  greatest_star(+Rooms, +Widest, +Largest, -Area) is det.
%
%   No house of so many rooms, none of which is wider or has a larger area, has more than this Area.

greatest_star(Rooms, Widest, Largest, Area) :-
    length(Sized, Rooms), maplist(=(sized_room(_,sizes(_-Widest,_-Largest),free)), Sized),
    whole(greatest, any, Sized, Area).

%   wall(+End, +Corners, +Sized, +Side, -Length): how long the main room's wall must be for the rooms there, at least or at most.

wall(End, Corners, Sized, Side, Length) :-
    findall(W, ( member(sized_room(_-Side,sizes(Widths,_),_), Sized), at_end(End, Widths, W) ), Ws),
    neighbours(Side, Before, After),
    inside(End, Corners, corner(Before,Side,Before), Near),
    inside(End, Corners, corner(Side,After,After), Far),
    wall_length(End, Ws, Near, Far, Length).

inside(least, any, _, 0)    :- !.
inside(greatest, any, _, 1) :- !.
inside(_, Corners, Corner, Inside) :- ( memberchk(Corner, Corners) -> Inside = 1 ; Inside = 0 ).

%   wall_length(+End, +Widths, +Near, +Far, -Length): Near and Far are 1 where the first and the last room end before the corner. Where
%   they do not, only their doors need to stand on the wall.

wall_length(_, [], _, _, 0) :- !.
wall_length(greatest, Ws, Near, Far, Length) :- !,
    ( Ws-Near-Far = [_]-0-0 -> length_of(door_width, Length) ; in_a_row(Ws, Near+Far, Length) ).
wall_length(least, [W], Near, Far, Length) :- !,
    ( Near-Far == 1-1 -> Taken = W ; length_of(door_width, Taken) ), in_a_row([Taken], Near+Far, Length).
wall_length(least, [First|Ws], Near, Far, Length) :-
    append(Middle, [Last], Ws),
    length_of(door_width, Door),
    ( Near =:= 1 -> A = First ; A = Door ), ( Far =:= 1 -> B = Last ; B = Door ),
    in_a_row([A,B|Middle], Near+Far, Length).

in_a_row(Ws, Ends, Length) :- rooms_gap(Gap), length(Ws, N), sum_list(Ws, Sum), Length is Sum + (N-1+Ends)*Gap.

%   loosened(+Sized, +Levels, :Holds, +Done, -Loose): each room has the sizes of the first of the Levels with which that Holds too.

loosened([], _, _, Loose, Loose).
loosened([Room|Rooms], Levels, Holds, Done, Loose) :-
    Holds = beyond(End,_,_), Room = sized_room(Stands,Sizes,Fixed),
    (   Fixed == free, member(Level, Levels), beside(End, Sizes, Level),
        append(Done, [sized_room(Stands,Level,free)|Rooms], All), call(Holds, All)
    ->  append(Done, [sized_room(Stands,Level,free)], Done1)
    ;   append(Done, [Room], Done1) ),
    loosened(Rooms, Levels, Holds, Done1, Loose).

type_atoms(End, Known, sized_room(R-_,Level,free), Atoms) :- !,
    findall(not(room(R,Type)), ( member(Type-Sizes, Known), \+ beside(End, Sizes, Level) ), Atoms).
type_atoms(_, _, sized_room(R-_,_,I), [numbered(I,R)]).

reasons(Sized, Sides, Types, Without, Atoms, Reasons) :-
    findall(size(T), ( member(T, Types), \+ memberchk(size(T), Without) ), Sizes),
    findall(length(L), member(L, [room_gap,door_clearance,door_width]), Lengths),
    findall(side(R,S), ( Sides = around(_), member(sized_room(R-S,_,_), Sized) ), Standing),
    ( Sides = around(Corners), is_list(Corners) -> true ; Corners = [] ),
    append([[house_area],Sizes,Lengths,Atoms,Standing,Corners], Reasons).

% - with furniture ------------------------------------------------------------------------------------------------

%!  outline(+Finished, -Outline) is det.
%
%   Outline is that of a room that is Side-Room, or Side-fixed(size(Width,Depth,Door),at(Along,Wall)): see main_room.pl.

outline(Side-fixed(size(W,D,Door),at(Along,Wall)), outline(Side,W,D,Door,fixed(Along,Wall))) :- !.
outline(Side-Room, outline(Side,W,D,Door,free)) :- room_width(Room, W), room_depth(Room, D), room_door(Room, Door).

%!  rooms_in_area(+Rooms, +Corners, +Finished0, -Finished, -Sizes) is det.
%
%   Finished are the Rooms of a layout (core.pl) with sizes that leave the main room an area, if such are found. Sizes are
%   R-size(Width,Depth) of those that are not as in Finished0.

rooms_in_area(Rooms, Corners, Finished0, Finished, Sizes) :-
    total_area(Total),
    maplist(outline, Finished0, Outlines),
    excess(Total, Outlines, Corners, Excess), Excess =\= 0,
    ( Excess > 0 -> End = least ; End = greatest ),
    maplist(end_size(End), Rooms, Ends),
    between(1, 8, Step),
    Share is (1 - 1.0e-6)*Step/8,
    maplist(resized(Share), Rooms, Finished0, Ends, Finished),
    maplist(outline, Finished, Resized),
    excess(Total, Resized, Corners, 0), !,
    findall(R-size(W,D),
            ( nth0(I, Rooms, room(R,_,_,_,_)), nth0(I, Resized, outline(_,W,D,_,_)), nth0(I, Outlines, outline(_,W0,D0,_,_)), W-D \== W0-D0 ),
            Sizes).
rooms_in_area(_, _, Finished, Finished, []).

%   excess(+Total, +Outlines, +Corners, -Excess) is semidet: by how much each house with these rooms is too large; negative where it is
%   too small.

excess(Least-Most, Outlines, Corners, Excess) :-
    (   memberchk(outline(_,_,_,_,fixed(_,_)), Outlines)
    ->  areas_between(Outlines, Corners, Low-High)
    ;   main_areas(Outlines, Corners, Low-High) ),
    findall(A, ( member(outline(_,W,D,_,_), Outlines), A is W*D ), Areas), sum_list(Areas, Sum),
    Excess0 is max(0, Sum+Low-Most) + min(0, Sum+High-Least),
    ( abs(Excess0) < 1.0e-9 -> Excess = 0 ; Excess = Excess0 ).

%   end_size(+End, +Room, -Size): W-D, the least or greatest size that the furniture of the room allows, as found by three ways.

end_size(_, fixed(_,_,_,_), none).
end_size(End, room(_,Type,_,Layout,_), Size) :-
    findall(Area-(W-D),
            ( member(Way, [width,depth,both]), whole_system(Type, Layout, Room, System), room_width(Room, W0), room_depth(Room, D0),
              posted(System), farthest(End, Way, W0, D0, W, D), Area is W*D ),
            Found),
    ( Found == [] -> Size = none ; End == least -> min_member(_-Size, Found) ; max_member(_-Size, Found) ).

%   farthest(+End, +Way, ?W0, ?D0, -W, -D): the numbers to which the Way goes first are met but for what the solver's numbers are off.

farthest(End, width, W0, D0, W, D) :- bound(End, W0, W), bound(End, D0, D).
farthest(End, depth, W0, D0, W, D) :- bound(End, D0, D), bound(End, W0, W).
farthest(End, both,  W0, D0, W, D) :- bound(End, W0+D0, _), bound(End, W0, W), bound(End, D0, D).

bound(least, Sum, Low)     :- inf(Sum, Low), {Sum =< Low + 1.0e-7}.
bound(greatest, Sum, High) :- sup(Sum, High), {Sum >= High - 1.0e-7}.

%   resized(+Share, +Room, +Finished0, +End, -Finished) is semidet: this share of the way from the size of the room to the End.

resized(_, _, Finished, none, Finished) :- !.
resized(Share, room(_,Type,Side,Layout,Seed), _-Room0, W1-D1, Side-Room) :-
    room_width(Room0, W0), room_depth(Room0, D0),
    maplist(between_ends(Share), [W0,D0], [W1,D1], [W,D]),
    W-D \== W0-D0,
    call(furnished(Type, Layout, sized(W,D), quick, Room), Seed, _),
    is_room(Room), !.
resized(_, _, Finished, _, Finished) :- on_grid.        % not all whole sizes between two have furniture

between_ends(Share, X0, X1, X) :- Between is X0 + Share*(X1-X0), ( on_grid -> X is round(Between) ; X = Between ).
