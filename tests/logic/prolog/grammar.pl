%   A tiny grammar: one type of room, 3 to 4 m wide and 3 m deep, and pieces of fixed size.

door_width(0.8).
door_clearance(0.5).
passage(0.4).
room_gap(0.3).

room_size(cell, W, 3.0) :- { W >= 3.0, W =< 4.0 }.

piece_size(crate, 1.0, 0.5, _).
piece_size(beam,  L, 0.5, Wall) :- { L = Wall }.
piece_size(block, 1.0, 2.7, _).
piece_size(stool, 0.4, 0.4, _).
