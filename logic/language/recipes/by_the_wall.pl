piece_size(shelf,   L, D, Wall) :- { L >= Wall/3, L =< Wall/2, D = 0.3 }.
piece_size(cabinet, L, D, Wall) :- { L >= Wall - 3, L =< Wall - 2, D = 0.5 }.
