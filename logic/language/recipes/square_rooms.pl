square(Least, Most, W, D) :- { W >= Least, W =< Most, D = W }.
room_size(cell,   W, D) :- square(2.8, 3.4, W, D).
room_size(chapel, W, D) :- square(4.0, 6.0, W, D).
