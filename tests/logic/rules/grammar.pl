%   A tiny grammar: rooms, a cell of them 3 to 4 m wide and 3 m deep, and pieces of fixed size, but for three.

door_width(0.8).
door_clearance(0.5).
passage(0.4).
room_gap(0.3).

room_size(cell, W, 3.0) :- { W >= 3.0, W =< 4.0 }.
room_size(square, W, D) :- { W >= 2.0, W =< 5.0, D = W }.
room_size(wide, W, D) :- { W >= 2.0, W =< 4.0, D >= 2.0, 2*D =< W + 3 }.

piece_size(crate, 1.0, 0.5, _).
piece_size(beam,  L, 0.5, Wall) :- { L = Wall }.
piece_size(shelf, L, D, Wall) :- { L >= 0.5*Wall, L =< Wall, D >= 0.2, D =< 0.4 }.
piece_size(stand, L, D, _) :- { L >= 0.4, L =< 0.6, D = L + 0.1 }.
piece_size(rug,   L, D, Wall-Across) :- { L >= Wall/4, L =< Wall/2, 2*D >= Across, D =< 2.0 }.
piece_size(block, 1.0, 2.7, _).
piece_size(stool, 0.4, 0.4, _).
room_size(closet, 2.0, 2.0).
