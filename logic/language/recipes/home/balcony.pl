room_size(balcony, W, D) :- { W >= 1.4, W =< 4.5, D >= 1.4, D =< 4.5 }.
room_area(balcony, 3.0, 9.0).
