%   The lengths of a clinic, in metres, and areas in square metres: a wheelchair passes everywhere.

door_width(0.95).
door_margin(0.1).
window_margin(0.65).        % as deep as a fridge at the next wall
door_clearance(0.5).
passage(0.9).
room_gap(0.0).              % rooms share walls

%!  room_size(?Type, -Width, -Depth)
%
%   Of corridors and washrooms, which are oblong, the width is across.

room_size(corridor,   W, D) :- { W >= 1.8, W =< 2.4, D >= 4.5, D =< 50.0 }.
room_size(reception,  W, D) :- { W >= 4.5, W =< 8.0, D >= 4.5, D =< 8.0 }.
room_size(waiting,    W, D) :- { W >= 4.0, W =< 7.0, D >= 4.0, D =< 7.0 }.
room_size(consulting, W, D) :- { W >= 4.6, W =< 6.0, D >= 4.6, D =< 6.0 }.
room_size(treatment,  W, D) :- { W >= 4.8, W =< 6.0, D >= 4.8, D =< 6.0 }.
room_size(ward,       W, D) :- { W >= 4.5, W =< 7.5, D >= 4.5, D =< 7.5 }.
room_size(laboratory, W, D) :- { W >= 3.6, W =< 6.0, D >= 3.6, D =< 6.0 }.
room_size(staff,      W, D) :- { W >= 4.4, W =< 6.0, D >= 4.4, D =< 6.0 }.
room_size(washroom,   W, D) :- { W >= 1.9, W =< 2.8, D >= 2.2, D =< 6.0 }.
room_size(storage,    W, D) :- { W >= 2.4, W =< 6.0, D >= 2.4, D =< 6.0 }.

%!  room_area(?Type, -Least, -Most)

room_area(washroom, 4.5, 12.0).
room_area(storage,  6.0, 26.0).

%!  window_size(?Type, -Length, +Wall)

window_size(_, L, Wall) :- { L >= 1.2, L =< 0.7*Wall, L =< 3.6 }.

%!  piece_size(?Type, -Length, -Depth, +Wall): length runs along the wall behind the piece.

piece_size(counter,        L, D, _) :- { L >= 1.8, L =< 2.6, D >= 0.7, D =< 0.9 }.
piece_size(cabinet,        L, D, _) :- { L >= 0.8, L =< 1.6, D >= 0.4, D =< 0.5 }.
piece_size(bench,          L, D, _) :- { L >= 1.6, L =< 2.4, D >= 0.5, D =< 0.6 }.
piece_size(plant,          L, D, _) :- { L >= 0.3, L =< 0.5, D = L }.
piece_size(consultingDesk, L, D, _) :- { L >= 1.2, L =< 1.6, D >= 0.7, D =< 0.8 }.
piece_size(couch,          L, D, _) :- { L >= 0.65, L =< 0.75, D >= 1.85, D =< 1.95 }.
piece_size(basin,          L, D, _) :- { L >= 0.5, L =< 0.7, D >= 0.4, D =< 0.5 }.
piece_size(treatmentTable, L, D, _) :- { L >= 0.7, L =< 0.8, D >= 1.9, D =< 2.1 }.
piece_size(trolley,        L, D, _) :- { L >= 0.6, L =< 0.8, D >= 0.4, D =< 0.5 }.
piece_size(bed,            L, D, _) :- { L >= 0.9, L =< 1.0, D >= 2.0, D =< 2.2 }.
piece_size(locker,         L, D, _) :- { L >= 0.45, L =< 0.55, D = L }.
piece_size(screen,         L, D, _) :- { L >= 1.2, L =< 1.8, D >= 0.1, D =< 0.2 }.
piece_size(workbench,      L, D, Wall) :- { L >= 0.7*Wall, L =< Wall, D >= 0.7, D =< 0.8 }.
piece_size(fridge,         L, D, _) :- { L >= 0.6, L =< 0.7, D >= 0.6, D =< 0.65 }.
piece_size(sofa,           L, D, _) :- { L >= 1.6, L =< 2.2, D >= 0.8, D =< 0.95 }.
piece_size(staffTable,     L, D, _) :- { L >= 1.2, L =< 1.8, D >= 0.8, D =< 1.0 }.
piece_size(lockers,        L, D, _) :- { L >= 0.9, L =< 1.8, D >= 0.45, D =< 0.55 }.
piece_size(toilet,         L, D, _) :- { L >= 0.38, L =< 0.42, D = L + 0.3 }.
piece_size(shelf,          L, D, _) :- { L >= 0.8, L =< 2.4, D >= 0.4, D =< 0.6 }.
piece_size(chair,          L, D, _) :- { L >= 0.45, L =< 0.5, D = L }.
piece_size(stool,          L, D, _) :- { L >= 0.35, L =< 0.4, D = L }.
