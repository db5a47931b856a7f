%   The lengths of a hotel, in metres.

door_width(0.8).
door_margin(0.1).
window_margin(0.65).
door_clearance(0.45).
passage(0.42).
room_gap(0.0).
house_size(W, D) :- { W =< 9*D, D =< 9*W }.
room_size(corridor, W, D) :- { W >= 1.4, W =< 2.2, D >= 4.0, D =< 80.0 }.
room_size(guest,    W, D) :- { W >= 3.0, W =< 4.5, D >= 3.8, D =< 6.0 }.
room_size(bath,     W, D) :- { W >= 1.6, W =< 2.4, D >= 2.4, D =< 6.0 }.
window_size(_, L, Wall) :- { L >= 0.6, L =< 0.6*Wall, L =< 2.4 }.
piece_size(bed,         L, D, _) :- { L >= 0.9,  L =< 1.8, D >= 2.0,  D =< 2.1 }.
piece_size(wardrobe,    L, D, _) :- { L >= 1.0,  L =< 2.0, D >= 0.58, D =< 0.65 }.
piece_size(writingDesk, L, D, _) :- { L >= 1.0,  L =< 1.6, D >= 0.6,  D =< 0.8 }.
piece_size(sink,        L, D, _) :- { L >= 0.5,  L =< 0.9, D >= 0.4,  D =< 0.55 }.
piece_size(toilet,      L, D, _) :- { L >= 0.36, L =< 0.4, D = L + 0.33 }.
piece_size(shower,      L, D, _) :- { L >= 0.8,  L =< 1.0, D = L }.
