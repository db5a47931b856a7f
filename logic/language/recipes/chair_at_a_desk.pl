room_size(study, W, D) :- { W >= 2.6, W =< 4.0, D >= 2.6, D =< 4.0 }.
piece_size(bureau, L, D, _) :- { L >= 1.0, L =< 1.6, D >= 0.5, D =< 0.8 }.
