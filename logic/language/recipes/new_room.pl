room_size(study, W, D) :- { W >= 2.5, W =< 4.0, D >= 2.5, D =< W }.
piece_size(lectern, L, D, _) :- { L >= 0.5, L =< 0.8, D = 0.5 }.
piece_size(globe, L, D, _) :- { L >= 0.4, L =< 0.6, D = L }.
