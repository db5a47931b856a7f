%   The lengths of a family's house, in metres: sizes, clearances, gaps.
%   Each clause states linear CLP(R) constraints between its variables.

door_width(0.762).          % the paper's 2.5 feet
door_clearance(0.45).       % nothing stands nearer to a door
passage(0.42).              % the paper's body measures 0.394 m across its diagonal
room_gap(0.6).              % between neighbouring rooms

%!  room_size(?Type, -Width, -Depth)
%
%   Width runs along the wall with the door, depth away from it.

room_size(bedroom,  W, D) :- { W >= 3.2, W =< 5.2, D >= 3.2, D =< 5.2 }.
room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7 }.
room_size(kitchen,  W, D) :- { W >= 3.0, W =< 4.6, D >= 3.0, D =< 4.6 }.
room_size(hall,     W, D) :- { W >= 4.2, W =< 6.1, D >= 4.2, D =< 6.1 }.

%!  piece_size(?Type, -Length, -Depth, +Wall)
%
%   Length runs along the wall behind the piece, whose length is Wall; depth stands out from it.

piece_size(bed,       L, D, _) :- { L >= 0.9,  L =< 1.6, D >= 1.9,  D =< 2.1 }.
piece_size(wardrobe,  L, D, _) :- { L >= 1.0,  L =< 2.2, D >= 0.5,  D =< 0.65 }.
piece_size(toilet,    L, D, _) :- { L >= 0.36, L =< 0.4, D = L + 0.3 }.
piece_size(shower,    L, D, _) :- { L >= 0.8,  L =< 1.2, D = L }.
piece_size(sink,      L, D, _) :- { L >= 0.5,  L =< 1.0, D >= 0.45, D =< 0.55 }.
piece_size(desk, L, D, _) :- { L >= 1.2, L =< 2.8, D >= 0.5, D =< 0.65 }.
piece_size(table,     L, D, _) :- { L >= 0.8,  L =< 1.6, D >= 0.7,  D =< 1.0 }.
piece_size(sofa,      L, D, _) :- { L >= 1.6,  L =< 2.4, D >= 0.8,  D =< 1.0 }.
piece_size(cupboard,  L, D, _) :- { L >= 0.9,  L =< 2.0, D >= 0.4,  D =< 0.5 }.
piece_size(hallTable, L, D, _) :- { L >= 1.0,  L =< 2.0, D >= 0.8,  D =< 1.2 }.
piece_size(bedside,   L, D, _) :- { L >= 0.4,  L =< 0.6, D = L }.
