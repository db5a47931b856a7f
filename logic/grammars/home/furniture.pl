%   How large a home's furniture is, in metres.
%
%   Kitchens, bathrooms and WCs: DIN 18022 (1989), Küchen, Bäder und WCs im Wohnungsbau, tables 1 and 2 (units 0.6 m deep;
%   toilet 0.4 by 0.75; washbasin 0.6 by 0.55; hand basin 0.45 by 0.35; shower 0.8 by 0.8; bath 1.7 by 0.75). Living and
%   sleeping: DIN 18011 (1967), Stellflächen im Wohnungsbau, and Neufert, Architects' Data (4th ed., 2012), Part Living.

%!  piece_size(?Type, -Length, -Depth, +Wall)
%
%   Length runs along the wall behind the piece, whose length is Wall; depth stands out from it.

piece_size(sofa,           L, D, _) :- { L >= 1.5,  L =< 2.6, D >= 0.8,  D =< 1.0 }.
piece_size(armchair,       L, D, _) :- { L >= 0.7,  L =< 0.9, D >= 0.7,  D =< 0.9 }.
piece_size(tvBench,        L, D, _) :- { L >= 1.0,  L =< 2.0, D >= 0.4,  D =< 0.5 }.
piece_size(coffeeTable,    L, D, _) :- { L >= 0.7,  L =< 1.2, D >= 0.5,  D =< 0.7 }.
piece_size(bookshelf,      L, D, _) :- { L >= 0.8,  L =< 2.0, D >= 0.28, D =< 0.4 }.
piece_size(sideboard,      L, D, _) :- { L >= 1.1,  L =< 2.0, D >= 0.4,  D =< 0.5 }.
piece_size(cabinet,        L, D, _) :- { L >= 0.8,  L =< 1.2, D >= 0.4,  D =< 0.5 }.
piece_size(plant,          L, D, _) :- { L >= 0.3,  L =< 0.5, D = L }.
piece_size(diningTable,    L, D, _) :- { L >= 0.8,  L =< 1.8, D >= 0.8,  D =< 1.0 }.
piece_size(table,          L, D, _) :- { L >= 0.6,  L =< 1.2, D >= 0.6,  D =< 0.8 }.
piece_size(chair,          L, D, _) :- { L >= 0.4,  L =< 0.5, D = L }.
piece_size(kitchenSink,    L, D, _) :- { L >= 0.6,  L =< 1.2, D = 0.6 }.
piece_size(stove,          L, D, _) :- { L = 0.6,   D = 0.6 }.
piece_size(fridge,         L, D, _) :- { L = 0.6,   D = 0.6 }.
piece_size(worktop,        L, D, _) :- { L >= 0.4,  L =< 2.4, D = 0.6 }.
piece_size(bed,            L, D, _) :- { L >= 0.9,  L =< 1.8, D >= 2.0,  D =< 2.1 }.
piece_size(bedside,        L, D, _) :- { L >= 0.35, L =< 0.5, D = L }.
piece_size(wardrobe,       L, D, _) :- { L >= 1.0,  L =< 2.5, D >= 0.58, D =< 0.65 }.
piece_size(dresser,        L, D, _) :- { L >= 0.8,  L =< 1.4, D >= 0.4,  D =< 0.5 }.
piece_size(writingDesk,    L, D, _) :- { L >= 1.0,  L =< 1.6, D >= 0.6,  D =< 0.8 }.
piece_size(sink,           L, D, _) :- { L >= 0.5,  L =< 0.9, D >= 0.4,  D =< 0.55 }.
piece_size(handBasin,      L, D, _) :- { L >= 0.36, L =< 0.5, D >= 0.25, D =< 0.35 }.
piece_size(toilet,         L, D, _) :- { L >= 0.36, L =< 0.4, D = L + 0.33 }.
piece_size(shower,         L, D, _) :- { L >= 0.8,  L =< 1.0, D = L }.
piece_size(bathtub,        L, D, _) :- { L >= 1.6,  L =< 1.8, D >= 0.7,  D =< 0.8 }.
piece_size(washingMachine, L, D, _) :- { L = 0.6,   D = 0.6 }.
piece_size(shelf,          L, D, _) :- { L >= 0.6,  L =< 1.8, D >= 0.3,  D =< 0.5 }.
piece_size(freezer,        L, D, _) :- { L >= 0.55, L =< 0.9, D = 0.6 }.
piece_size(coatRack,       L, D, _) :- { L >= 0.5,  L =< 1.2, D >= 0.25, D =< 0.4 }.
piece_size(shoeCabinet,    L, D, _) :- { L >= 0.5,  L =< 1.0, D >= 0.2,  D =< 0.35 }.
piece_size(bench,          L, D, _) :- { L >= 0.6,  L =< 1.2, D >= 0.35, D =< 0.45 }.
