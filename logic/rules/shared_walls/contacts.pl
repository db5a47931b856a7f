:- module(contacts, [all_contacts//2, least_contact/1]).

/** <module> Which rooms of a plan share a wall, where stage 1 has chosen it

contact(R,Q,Axis,How): the rooms R and Q lie on both sides of a line that runs along the Axis, R on its west or north side.
There they `share` a part of the wall, or R ends `before` Q begins, or `after` its end R begins.
*/

:- use_module(library(lists)).
:- use_module('../linear/grid').
:- use_module(openings).

%!  least_contact(-Metres) is det.
%
%   So much of a wall do rooms share that share one: about what one wall takes that ends at another. What is less would be a
%   corner that two rooms share.

least_contact(0.1).

%!  all_contacts(+Atoms, +Rooms)// describes the constraints.

all_contacts(Atoms, Rooms) -->
    { least_contact(M), in_unit(M, Least),
      findall(contact(R,Q,Axis,How), member(contact(R,Q,Axis,How), Atoms), Contacts) },
    contacts(Contacts, Rooms, Least).

contacts([], _, _) --> [].
contacts([contact(R,Q,Axis,How)|Contacts], Rooms, Least) -->
    { memberchk(room(R,_,SidesR,EdgesR), Rooms), memberchk(room(Q,_,SidesQ,EdgesQ), Rooms),
      span(Axis, SidesR, EdgesR, A1, A2, WhyR), span(Axis, SidesQ, EdgesQ, B1, B2, WhyQ),
      append([[contact(R,Q,Axis,How)],WhyR,WhyQ], Why) },
    contact_constraints(How, A1-A2, B1-B2, Least, Why),
    contacts(Contacts, Rooms, Least).

contact_constraints(share,  A1-A2, B1-B2, Least, Why) --> [(A1+Least =< B2)-Why, (B1+Least =< A2)-Why].
contact_constraints(before, _-A2,  B1-_,  _,     Why) --> [(A2 =< B1)-Why].
contact_constraints(after,  A1-_,  _-B2,  _,     Why) --> [(B2 =< A1)-Why].
