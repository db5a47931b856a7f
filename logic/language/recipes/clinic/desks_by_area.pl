room_size(office2, W, D) :- office(W, D).
room_size(office3, W, D) :- office(W, D).
room_size(office4, W, D) :- office(W, D).
office(W, D) :- { W >= 3.2, W =< 7.5, D >= 3.2, D =< 7.5 }.
room_area(office2, 12.0, 17.9).
room_area(office3, 18.0, 23.9).
room_area(office4, 24.0, 29.9).
piece_size(desk, L, D, _) :- { L >= 1.2, L =< 1.4, D >= 0.6, D =< 0.7 }.
