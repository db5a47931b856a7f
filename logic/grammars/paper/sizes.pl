%   The lengths of the original program's houses. Its unit is the foot: 0.3048 m, 8.5 pixels in its files.

door_width(0.762).          % 2.5 feet
room_gap(0.762).            % 2.5 feet
door_clearance(0.4572).     % 1.5 feet
passage(0.42).              % its body measures 0.394 m across its diagonal

room_size(bedroom,  W, D) :- { W >= 12*0.3048, W =< 17*0.3048, D >= 12*0.3048, D =< 17*0.3048 }.
room_size(bathroom, W, D) :- { W >=  8*0.3048, W =< 12*0.3048, D >=  8*0.3048, D =< 12*0.3048 }.
room_size(kitchen,  W, D) :- { W >= 10*0.3048, W =< 15*0.3048, D >= 10*0.3048, D =< 15*0.3048 }.
room_size(hall,     W, D) :- { W >= 15*0.3048, W =< 20*0.3048, D >= 15*0.3048, D =< 20*0.3048 }.

piece_size(bed,       L, D, _) :- { L >= 2*0.3048,   L =< 3*0.3048,   D = L + 3*0.3048 }.
piece_size(bedside,   L, D, _) :- { L >= 1.5*0.3048, L =< 2*0.3048,   D = L }.
piece_size(wardrobe,  L, D, _) :- { L >= 3*0.3048,   L =< 7.5*0.3048, D >= 1.5*0.3048, D =< 2*0.3048 }.
piece_size(toilet,    L, D, _) :- { L >= 1*0.3048,   L =< 1.3*0.3048, D = L + 0.7*0.3048 }.
piece_size(shower,    L, D, _) :- { L >= 3*0.3048,   L =< 4*0.3048,   D = L }.
piece_size(sink,      L, D, _) :- { L >= 2.5*0.3048, L =< 3.5*0.3048, D = 2/3*L }.
piece_size(desk,      L, D, Wall) :- { L >= 0.7*Wall, L =< Wall, D >= 1.5*0.3048, D =< 1.8*0.3048 }.
piece_size(cupboard,  L, D, _) :- { L >= 3*0.3048,   L =< 12*0.3048,  D >= 1.5*0.3048, D =< 2*0.3048 }.
piece_size(sofa,      L, D, _) :- { L >= 6*0.3048,   L =< 8*0.3048,   D >= 2.5*0.3048, D =< 3*0.3048 }.
piece_size(table,     L, D, Width-Depth) :- { L >= Width/5, L =< 3/10*Width, D >= Depth/5, D =< 3/10*Depth }.
piece_size(chair,     L, D, _) :- { L >= 0.7*0.3048, L =< 1*0.3048, D = L }.

%   A hall's table has sides of 2.5 to 6 feet and an area of 8 to 15 square feet. The curve L*D = 8 lies below its chord
%   between the tables of 2.5 by 3.2 and of 3.2 by 2.5, the curve L*D = 15 above its tangent at the longest of 6 by 2.5.

piece_size(hallTable, L, D, _) :-
    { L >= 2.5*0.3048, D >= 2.5*0.3048, 5.7*0.3048 =< L + D, 5*L + 12*D =< 60*0.3048 }.
