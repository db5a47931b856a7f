:- module(reasons, [holds//2, fails//1, because//1, required//2]).

/** <module> Reasons, collected by a DCG

A nonterminal that says why a constraint binds describes its reasons: the atoms of stage 1, not(Atom) for one that does
not hold, and the grammar's clauses length(Name), size(RoomType) and size(RoomType,Piece).
*/

:- use_module('../language/lengths').

%!  holds(?Atom, +Layout)// is semidet.
%
%   Atom is the first of its form in the layout, and a reason.

holds(Atom, Layout) --> { memberchk(Atom, Layout) }, [Atom].

%!  fails(+Atom)// is det.
%
%   That Atom is not in the layout is a reason.

fails(Atom) --> [not(Atom)].

%!  because(+Why)// is det.
%
%   Why lists reasons that are known already.

because([])        --> [].
because([Why|Whys]) --> [Why], because(Whys).

%!  required(+Name, -Length)// is det.
%
%   Length is that of the grammar by this name (length_of/2), and a reason.

required(Name, Length) --> { length_of(Name, Length) }, [length(Name)].
