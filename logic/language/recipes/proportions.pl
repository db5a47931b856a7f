room_size(gallery, W, D) :- { D >= 2.2, D =< 3.0, W >= 2*D, W =< 3*D }.
piece_size(bench, L, D, _) :- { D >= 0.35, D =< 0.5, L = 3*D }.
