room_size(suite, W, D) :- { W >= 5.2, W =< 6.0, D >= 5.2, D =< 6.0 }.
piece_size(armchair, L, D, _) :- { L >= 0.7, L =< 0.9, D = L }.
