%   How large rooms are that a brief says nothing of, in metres, and what doors and windows need.

%!  room_size(?Type, -Width, -Depth)

room_size(room, W, D) :- { W >= 0.9, W =< 40.0, D >= 0.9, D =< 40.0 }.

door_width(0.8).
door_margin(0.05).
window_margin(0.2).
door_clearance(0.45).       % nothing stands nearer to a door
passage(0.42).              % a body of 0.394 m across its diagonal walks there
room_gap(0.0).              % rooms share walls

%!  window_size(?Type, -Length, +Wall)

window_size(_, L, Wall) :- { L >= 0.6, L =< 0.8*Wall, L =< 2.4 }.
