piece_size(plant, L, D, _) :- { L >= 0.3, L =< 0.5, D = L }.
piece_size(stool, L, D, _) :- { L = 0.4, D = L }.
