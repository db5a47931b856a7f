room_size(classroom, W, D) :- { W >= 4.5, W =< 7.0, D >= 5.5, D =< 7.0 }.
piece_size(schoolDesk, L, D, _) :- { L >= 1.2, L =< 1.6, D >= 0.5, D =< 0.7 }.
