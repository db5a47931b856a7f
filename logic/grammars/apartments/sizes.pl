:- include('home/furniture.pl').     % how large a flat's furniture is
:- include('home/lengths.pl').       % and its doors, windows and passages

%   How large the rooms of a building of flats are, in metres, and their floors, in square metres.
%   Each clause states linear CLP(R) constraints between its variables.

%!  unit_depth(-Depth)

unit_depth(D) :- { D >= 7.0, D =< 8.8 }.

%!  room_size(?Type, -Width, -Depth)
%
%   Of a corridor, which is oblong, the width is across.

room_size(commonCorridor, W, D) :- { W >= 1.5, W =< 2.2, D >= 3.0, D =< 120.0 }.
room_size(corridor, W, D) :- { W >= 1.1, W =< 1.6, D >= 2.4, D =< 9.0 }.
room_size(hall,     W, D) :- { W >= 1.5, W =< 4.0, D >= 1.5, D =< 4.0 }.
room_size(living,   W, D) :- { W >= 3.4, W =< 7.0, D >= 3.4, D =< 7.0 }.
room_size(dining,   W, D) :- { W >= 2.6, W =< 4.8, D >= 2.6, D =< 4.8 }.
room_size(kitchen,  W, D) :- { W >= 2.0, W =< 4.5, D >= 2.0, D =< 4.5 }.
room_size(bedroom,  W, D) :- { W >= 2.5, W =< 5.0, D >= 2.5, D =< 5.0 }.
room_size(bathroom, W, D) :- { W >= 1.6, W =< 3.6, D >= 1.6, D =< 3.6 }.
room_size(wc,       W, D) :- { W >= 0.9, W =< 2.2, D >= 0.9, D =< 2.2 }.
room_size(storage,  W, D) :- { W >= 1.0, W =< 3.0, D >= 1.0, D =< 3.0 }.
room_size(study,    W, D) :- { W >= 2.2, W =< 4.2, D >= 2.2, D =< 4.2 }.

%!  room_area(?Type, -Least, -Most)

room_area(hall,      3.0, 11.0).
room_area(living,   15.0, 36.0).
room_area(dining,    8.0, 18.0).
room_area(kitchen,   6.0, 16.0).
room_area(bedroom,   8.0, 20.0).
room_area(bathroom,  3.4,  9.5).
room_area(wc,        1.2,  3.5).
room_area(storage,   1.2,  6.0).
room_area(study,     6.0, 14.0).
