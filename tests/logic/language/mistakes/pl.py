"""Mistakes in ``.pl`` files."""

from functools import partial

from tests.logic.language.mistakes import Mistake

BATHROOM = "room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7 }."
BED = "piece_size(bed,       L, D, _) :- { L >= 0.9,  L =< 1.6, D >= 1.9,  D =< 2.1 }."
DESK = "piece_size(desk,      L, D, Wall) :- { L >= 0.7*Wall, L =< Wall, D >= 0.5, D =< 0.65 }."
CHAIR = "piece_size(chair,     L, D, _) :- { L >= 0.4,  L =< 0.5, D = L }."
PASSAGE = "passage(0.42).              % the paper's body measures 0.394 m across its diagonal"
HEADER = "%   The lengths of a family's house, in metres: sizes, clearances, gaps."

bathroom = partial(Mistake, file="sizes.pl", old=BATHROOM)
bed = partial(Mistake, file="sizes.pl", old=BED)
desk = partial(Mistake, file="sizes.pl", old=DESK)
passage = partial(Mistake, file="sizes.pl", old=PASSAGE)
chair = partial(Mistake, file="sizes.pl", old=CHAIR)


def bounds(title: str, bounds: str, says: str, at: str = "") -> Mistake:
    """Return a bathroom with other bounds; the message points at ``at`` in them, or at the clause."""
    return bathroom(title, new=f"room_size(bathroom, W, D) :- {{ {bounds} }}.", says=says, at=at)


def plan(title: str, old: str, new: str, says: str, at: str = "", file: str = "sizes.pl") -> Mistake:
    """Return an edit of the lengths of the home grammar, in which rooms share walls."""
    return Mistake(title, file, old=old, new=new, says=says, at=at, grammar="home")


def appended(title: str, new: str, says: str) -> Mistake:
    """Return an additional clause in the lengths of the home grammar."""
    return plan(title, "", new, says)


def kitchen(title: str, new: str, says: str, at: str = "") -> Mistake:
    """Return another area of its kitchens."""
    return plan(title, "room_area(kitchen,   6.0, 16.0).", new, says, at)


def window(title: str, bounds: str, says: str, at: str = "") -> Mistake:
    """Return other bounds of its windows."""
    clause = "window_size(_, L, Wall) :- {{ {} }}."
    old, new = (clause.format(each) for each in ("L >= 0.6, L >= 0.7*Wall - 1.0, L =< 0.8*Wall", bounds))
    return plan(title, old, new, says, at, file="lengths.pl")


def house(title: str, bounds: str, says: str, at: str = "") -> Mistake:
    """Return other bounds of its houses."""
    clause = "house_size(W, D) :- {{ {} }}."
    old, new = (clause.format(each) for each in ("W =< 2.2*D, D =< 2.2*W", bounds))
    return plan(title, old, new, says, at, file="lengths.pl")


MISTAKES = (
    # - empty sizes
    bounds(
        "a least width above the greatest",
        "W >= 5.0, W =< 4.6, D >= 2.4, D =< 3.7",
        "room_size(bathroom, W, D) allows no size: W >= 5.0 and W =< 4.6 exclude each other",
    ),
    bounds("two values for one side", "W = 3, W = 4, D = 3", "W = 3 and W = 4 exclude each other"),
    bounds(
        "three bounds of which any two hold",
        "W >= 2.4, W =< D, W + D >= 8, D =< 3.7",
        "W =< D, W + D >= 8 and D =< 3.7 exclude each other",
    ),
    bounds("a bound that holds for no number", "W >= 2.4, W =< 3.7, D = 3, 4 =< 3", "4 =< 3 never holds"),
    bathroom(
        "two values by unification",
        new="room_size(bathroom, W, D) :- W = 3, D = 3, W = 4.",
        says="W = 3 and W = 4 exclude each other",
    ),
    bathroom(
        "bounds of two predicates that exclude each other",
        new="room_size(bathroom, W, D) :- wide(W), { W =< 3.7, D = W }.\nwide(X) :- { X >= 5.0 }.",
        says="allows no size: X >= 5.0 (line 15) and W =< 3.7 exclude each other",
    ),
    bathroom(
        "a call that no clause matches",
        new="room_size(bathroom, W, D) :- sides(small, W, D).\nsides(large, W, W) :- { W >= 4, W =< 5 }.",
        says="allows no size: sides(small, W, D) never holds",
    ),
    bed(
        "a piece whose least length is above the greatest",
        new="piece_size(bed, L, D, _) :- { L >= 1.9, L =< 1.6, D >= 1.9, D =< 2.1 }.",
        says="piece_size(bed, L, D, _) allows no size: L >= 1.9 and L =< 1.6 exclude each other",
    ),
    desk(
        "a piece that is to be longer and shorter than its wall",
        new="piece_size(desk, L, D, Wall) :- { L >= 1.7*Wall, L =< Wall, D >= 0.5, D =< 0.65 }.",
        says="L >= 1.7*Wall and L =< Wall exclude each other",
    ),
    desk(
        "a piece that is longer than its wall",
        new="piece_size(desk, L, D, Wall) :- { L >= 1.2*Wall, L =< 2*Wall, D >= 0.5, D =< 0.65 }.",
        says="L >= 1.2*Wall and L =< Wall exclude each other",
    ),
    bed(
        "a piece that is longer than the walls of its room",
        new="piece_size(bed, L, D, _) :- { L >= 5.3, L =< 5.6, D >= 5.3, D =< 5.6 }.",
        says="L >= 5.3, L =< Wall and Wall =< 5.2 (in bedroom, line 13) exclude each other",
    ),
    Mistake(
        "a piece that is longer than the walls of one type of room",
        "sizes.pl",
        old="piece_size(cupboard,  L, D, _) :- { L >= 0.9,  L =< 2.0, D >= 0.4,  D =< 0.5 }.",
        new="piece_size(cupboard, L, D, _) :- { L >= 6.2, L =< 7.0, D >= 0.4, D =< 0.5 }.",
        says="L >= 6.2, L =< Wall and Wall =< 6.1 (in hall, line 16) exclude each other",
    ),
    # - constraints that are not linear
    bounds(
        "a decimal comma",
        "W >= 2.4, W =< 4,6, D >= 2.4, D =< 3.7",
        "4,6 is read as two terms: write 4.6",
        at="4,6",
    ),
    bounds(
        "a decimal comma in a factor",
        "W >= 0,5*D, W =< 3.7, D = 3",
        "0,5 is read as two terms: write 0.5",
        at="0,5",
    ),
    bounds("a variable alone", "W, W =< 3.7, D = 3", "W is only a variable: state a bound", at="W, W"),
    bounds("=> for >=", "W => 2.4, W =< 3.7, D = 3", "=> is not a constraint: write >=", at="=>"),
    bounds("<= for =<", "W >= 2.4, W <= 3.7, D = 3", "<= is not a constraint: write =<", at="<="),
    bounds("≤ for =<", "W >= 2.4, W ≤ 3.7, D = 3", "≤ is not a constraint: write =<", at="≤"),
    bounds("== for =", "W >= 2.4, W =< 3.7, D == 3", "== is not a constraint: write =", at="=="),
    bounds(
        "and for a comma", "W >= 2.4 and W =< 3.7, D = 3", "and is not a constraint: write a comma", at="and"
    ),
    bounds("an excluded size", "W >= 2.4, W =< 3.7, W =\\= 3, D = 3", "a size has one range", at="=\\="),
    bounds("text for a number", 'W >= "2.4", W =< 3.7, D = 3', "write 2.4 without quotes", at='"2.4"'),
    bounds(
        "a word for a number",
        "W >= wide, W =< 3.7, D = 3",
        "wide is a name, not a number: a variable begins in upper case",
        at="wide",
    ),
    bounds(
        "a variable in lower case",
        "W >= 2.4, W =< 3.7, D = 3, w >= D",
        "w is a name, not a number: did you mean the variable W?",
        at="w >=",
    ),
    bounds(
        "a function that CLP(R) does not know",
        "W >= 2.4, W =< sqrt(D), D = 3",
        "sqrt(D) is not arithmetic: CLP(R) accepts numbers, variables, +, -, * and /",
        at="sqrt",
    ),
    bounds(
        "a product of sides",
        "W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7, W*D =< 12",
        "W*D =< 12 is nonlinear, but CLP(R) decides only linear constraints: bound a side by a number",
        at="W*D",
    ),
    bounds(
        "a quotient of sides",
        "W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7, W/D >= 1.2",
        "W/D >= 1.2 is nonlinear, but CLP(R) decides only linear constraints: multiply by the divisor",
        at="W/D",
    ),
    bounds(
        "a power",
        "W >= 2.4, W =< 3.7, D = 3, W^2 =< 12",
        "W^2 =< 12 is nonlinear, but CLP(R) decides only linear constraints: bound the size itself",
        at="W^2",
    ),
    bounds("a sine", "W >= 2.4, W =< 3.7, D =< sin(W), D >= 0.1", "D =< sin(W) is nonlinear", at="D =<"),
    bathroom(
        "a product in a predicate of its own",
        new="room_size(bathroom, W, D) :- area(W, D).\narea(A, B) :- { A = 3, B >= 2, C >= B*B, C =< 9 }.",
        says="C >= B*B is nonlinear",
        at="C >= B*B",
    ),
    desk(
        "the square of a wall",
        new="piece_size(desk, L, D, Wall) :- { Wall*Wall >= 9, L >= 0.7*Wall, L =< Wall, D = 0.5 }.",
        says="Wall*Wall >= 9 is nonlinear",
        at="Wall*Wall",
    ),
    # - bounds and variables
    bounds(
        "no upper bound", "W >= 2.4, D >= 2.4, D =< 3.7", "room_size(bathroom, W, D): W has no upper bound"
    ),
    bounds("no bound but by each other", "W >= D, W =< 2*D", "W has no upper bound, D has no upper bound"),
    bounds(
        "a wall in the size of a room",
        "W >= 0.7*Wall, W =< Wall, D >= 2.4, D =< 3.7",
        "W has no upper bound (Wall gives none, because it is not in the head)",
    ),
    bounds(
        "a wall that stands once in the size of a room",
        "W >= 0.7*Wall, W =< 3.7, D >= 2.4, D =< 3.7",
        "only piece_size/4 has a Wall, not room_size/3",
        at="Wall",
    ),
    desk(
        "a piece without an upper bound",
        new="piece_size(desk, L, D, Wall) :- { L >= 0.7*Wall, D >= 0.5, D =< 0.65 }.",
        says="piece_size(desk, L, D, Wall): L has no upper bound",
    ),
    bounds(
        "a size below zero", "W >= -2.4, W =< 3.7, D = 3", "W can be -2.4 m, but a size must be more than 0"
    ),
    bounds("a size of zero", "W >= 0, W =< 3.7, D = 3", "W can be 0.0 m, but a size must be more than 0"),
    bathroom(
        "a side without bounds",
        new="room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7 }.",
        says="D occurs nowhere else in its clause, so it has no bounds: state D >= ... and D =< ...",
        at="D)",
    ),
    bathroom(
        "a misspelt variable",
        new="room_size(bathroom, Width, D) :- { Width >= 2.4, Widht =< 3.7, D = 3 }.",
        says="Widht occurs nowhere else in its clause: did you mean Width?",
        at="Widht",
    ),
    bounds("a variable without use", "W >= 2.4, W =< 3.7, D = 3, X >= 1", "X occurs nowhere else", at="X >="),
    # - clauses
    bathroom(
        "a second clause",
        new=f"{BATHROOM} room_size(bathroom, 3.0, 3.0).",
        says="room_size(bathroom, 3.0, 3.0) is a second clause: the first is in line 14. State one",
        at="room_size(bathroom, 3.0",
    ),
    bathroom(
        "two sizes in one clause",
        new="room_size(bathroom, W, D) :- ( { W = 3 } ; { W = 3.5 } ), { D = 3 }.",
        says="room_size(bathroom, W, D) has more than one solution: state one",
    ),
    bathroom(
        "a clause for all types beside others",
        new="room_size(_, W, D) :- { W >= 2.4, W =< 3.7, D = W }.",
        says="room_size(_, W, D) applies to every type, but some types have their own clause",
    ),
    bathroom(
        "a size of no type",
        new=f"{BATHROOM} room_size(attic, 3, 3).",
        says="room_size: attic is no room type: see type/1",
        at="room_size(attic",
    ),
    bathroom(
        "a misspelt type",
        new=BATHROOM.replace("bathroom", "bathrom"),
        says="room_size: bathrom is no room type: see type/1. Did you mean bathroom?",
    ),
    bed(
        "a size of no piece",
        new=f"{BED}\npiece_size(lamp, 0.3, 0.3, _).",
        says="piece_size: lamp is no piece in any room: see may/4",
        at="piece_size(lamp",
        severity="warning",
    ),
    bed(
        "a size of a piece that is called nearly as another that has its size",
        new=f"{BED}\npiece_size(bedd, 0.3, 0.3, _).",
        says="piece_size: bedd is no piece in any room: see may/4. Did you mean bed?",
        at="piece_size(bedd",
        severity="warning",
    ),
    bed(
        "a misspelt piece",
        new=BED.replace("bed,", "bedd,"),
        says="piece_size: bedd is no piece in any room: see may/4. Did you mean bed?",
    ),
    Mistake(
        "a type without a size",
        "rooms.lp",
        old="type(bedroom; bathroom; kitchen; hall).",
        new="type(bedroom; bathroom; kitchen; hall).\ntype(attic). may(attic,bed,1,1).",
        says="room_size/3 has no clause for attic",
        at="type(attic)",
    ),
    Mistake(
        "a piece without a size",
        "furniture.lp",
        old="",
        new="may(bedroom,lamp,0,1). stands(lamp,left).",
        says="piece_size/4 has no clause for lamp: add one to a .pl file",
    ),
    bathroom(
        "another number of arguments",
        new="room_size(bathroom, W) :- { W >= 2.4, W =< 3.7 }.",
        says="nothing uses room_size/2: did you mean room_size/3?",
    ),
    bathroom(
        "a decimal comma in a size",
        new="room_size(bathroom, 2,4, 3).",
        says="nothing uses room_size/4: 2,4 is read as two terms: write 2.4",
    ),
    bathroom(
        "a predicate that there is not",
        new="room_size(bathroom, W, D) :- squre(W), square(D).\nsquare(X) :- { X >= 2.4, X =< 3.7 }.",
        says="there is no predicate squre/1: did you mean square/1?",
        at="squre",
    ),
    bathroom(
        "bounds without braces",
        new="room_size(bathroom, W, D) :- W >= 2.4, W =< 3.7, D = 3.",
        says="W >= 2.4 is computed, but a variable has no value yet: write constraints in braces",
        at="W >= 2.4",
    ),
    bathroom(
        "a word in arithmetic",
        new="room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7 }, D is 2*wide.",
        says="D is 2*wide: wide is a name, not a number",
        at="D is",
    ),
    bathroom(
        "bounds of another library",
        new="room_size(bathroom, W, D) :- W #>= 2, { W =< 3.7, D = W }.",
        says="there is no predicate #>=/2: did you mean a constraint, { W >= 3.0, W =< 4.6 }?",
        at="W #>=",
    ),
    bathroom(
        "a clause that calls itself",
        new="room_size(bathroom, W, D) :- room_size(bathroom, D, W).",
        says="room_size(bathroom, W, D) never ends: room_size/3 calls itself in line 14",
    ),
    bed(
        "a predicate that calls itself, with bounds that never end",
        new="piece_size(bed, L, D, _) :- side(L), side(D).\nside(X) :- { X >= 1 }, side(X).",
        says="piece_size(bed, L, D, _) never ends: side/1 calls itself in line 23",
    ),
    bathroom(
        "code in a clause",
        new="room_size(bathroom, 3.0, 3.0) :- shell(ls).",
        says="shell/1 runs code: a clause may contain only CLP(R) constraints, arithmetic and comparison",
        at="shell",
    ),
    bathroom(
        "an arrow for a neck",
        new="room_size(bathroom, W, D) => { W >= 2.4, W =< 3.7, D = W }.",
        says="write :- between the head and the body of a clause, not =>",
    ),
    # - named lengths
    passage(
        "a length with a decimal comma",
        new="passage(0,42).",
        says="nothing uses passage/2: 0,42 is read as two terms: write 0.42",
    ),
    passage(
        "a negative length",
        new="passage(-0.42).",
        says="passage(-0.42) must be a number of metres, 0 or more",
    ),
    passage("a word for a length", new="passage(wide).", says="passage(wide) must be a number of metres"),
    passage(
        "a range for a length",
        new="passage(P) :- { P >= 0.4, P =< 0.5 }.",
        says="passage(P) must be a number of metres, 0 or more",
    ),
    passage(
        "a length that is stated twice",
        new="passage(0.42).\npassage(0.5).",
        says="passage(0.5) is a second clause: the first is in line 6. State one",
        at="passage(0.5)",
    ),
    Mistake(
        "a length that is not stated",
        "sizes.pl",
        old=f"""{HEADER}
%   Each clause states linear CLP(R) constraints between its variables.

door_width(0.762).          % the paper's 2.5 feet
""",
        new="%   There are no doors.\n",
        says="door_width/1 has no clause: add one, as door_width(0.5). for half a metre",
    ),
    Mistake(
        "a misspelt length",
        "sizes.pl",
        old="room_gap(0.6).",
        new="room_gab(0.6).",
        says="nothing uses room_gab/1: did you mean room_gap/1?",
    ),
    # - units
    bathroom(
        "a room in centimetres",
        new="room_size(bathroom, W, D) :- { W >= 240, W =< 370, D >= 240, D =< 370 }.",
        says="bathroom: 240 m. Lengths are in metres: 240 cm are 2.4",
        severity="warning",
    ),
    bed(
        "a piece thinner than a centimetre",
        new="piece_size(bed, L, D, _) :- { L >= 0.009, L =< 1.6, D >= 1.9, D =< 2.1 }.",
        says="bed: 0.009 m. Lengths are in metres",
        severity="warning",
    ),
    passage(
        "a passage in centimetres", new="passage(42).", says="passage: 42 m. Lengths are", severity="warning"
    ),
    # - syntax
    passage(
        "a missing full stop",
        new="passage(0.42) % the body's diagonal",
        says="syntax error: operator_expected: a full stop is missing",
        at=" %",
    ),
    chair(
        "a missing full stop at the end of the file",
        new="piece_size(chair, 0.4, 0.4, _) % square",
        says="syntax error: end_of_file: a full stop is missing",
        at=" %",
    ),
    chair(
        "a brace that is not closed",
        new="piece_size(chair, L, D, _) :- { L >= 0.4, L =< 0.5, D = L.",
        says="{ is not closed",
        at="{",
    ),
    bounds("a missing comma", "W >= 2.4 W =< 3.7, D = 3", "a comma or an operator is missing", at="W =<"),
    bounds("a comma too many", "W >= 2.4, W =< 3.7, D = 3,", "nothing follows the comma", at=", }"),
    bounds("a blank within =<", "W >= 2.4, W < = 3.7, D = 3", "write =< for < =", at="< ="),
    bounds("two bounds in one", "2.4 =< W =< 3.7, D = 3", "write 2.4 =< W, W =< 3.7", at="2.4 =<"),
    bounds(
        "a unit",
        "W >= 2.4m, W =< 3.7, D = 3",
        "2.4m: a number has no unit, and lengths are metres",
        at="2.4m",
    ),
    bounds("a product without a sign", "W >= 2D, W =< 3.7, D = 1", "2D: write *", at="2D"),
    bounds(
        "a number without its first digit", "W >= .5, W =< 3.7, D = 3", "write 0 before the point", at=".5"
    ),
    bounds("not equal", "W != 2.4, W =< 3.7, D = 3", "a size has one range: state its bounds", at="!="),
    bathroom(
        "a bracket of another kind",
        new="room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D = 3 ).",
        says=") stands here, and { is open",
        at=").",
    ),
    bathroom(
        "no neck",
        new="room_size(bathroom, W, D) { W >= 2.4, W =< 3.7, D = 3 }.",
        says="write :- before the braces",
        at="{",
    ),
    bathroom(
        "a predicate in upper case", new="Room_size(bathroom, 3, 3).", says="begins in lower case: room_size"
    ),
    bathroom("a constant of .lp files", new="#const most = 3.", says="#const belongs in a .lp file"),
    bathroom("a fact of .lp files", new=f"type(attic).\n{BATHROOM}", says="type belongs in a .lp file"),
    bathroom(
        "a rule of .lp files",
        new=f":- room(0,hall).\n{BATHROOM}",
        says="a rule that begins with :- belongs in a .lp file",
    ),
    bathroom(
        "bounds in square brackets",
        new="room_size(bathroom, W, D) :- [W >= 2.4, W =< 3.7, D = 3].",
        says="a list is not a goal: write constraints in braces",
        at="[W",
    ),
    bathroom(
        "a range as a list",
        new="room_size(bathroom, [2.4,3.7], 3.0).",
        says="cannot be solved: a size is a number, or a variable with bounds in braces",
    ),
    bathroom(
        "a size that is text",
        new='room_size(bathroom, "3", 3.0).',
        says="cannot be solved: a size is a number, or a variable with bounds in braces",
    ),
    bounds("a range by two points", "W = 2.4..3.7, D = 3", "a range is two bounds", at="2.4.."),
    bounds("a range by in", "W in 2..4, D = 3", "a range is two bounds", at="in 2"),
    bathroom(
        "a type in upper case",
        new=BATHROOM.replace("bathroom", "Bathroom"),
        says="a name begins in lower case: did you mean bathroom?",
        at="Bathroom",
    ),
    bathroom(
        "a whole number too many",
        new="room_size(bathroom, 3, 3, 3).",
        says="nothing uses room_size/4: did you mean room_size/3?",
    ),
    bathroom("a comment of another language", new="# small", says="a comment begins with %"),
    bathroom(
        "a quote that does not end",
        new="room_size('bathroom, W, D) :- { W >= 2.4, W =< 3.7, D = 3 }.",
        says="a quote begins here and does not end",
        at="'",
    ),
    # - what a file must not contain
    passage(
        "a directive", new=":- initialization(halt).", says="a directive runs code when the file is read"
    ),
    passage(
        "the library for whole numbers",
        new=":- use_module(library(clpfd)).",
        says="lengths are real numbers: write library(clpr) for library(clpfd)",
    ),
    passage("an expansion", new="term_expansion(a, b).", says="nothing uses term_expansion/2"),
    passage(
        "a grammar rule of Prolog",
        new="passage --> [0.42].",
        says="a grammar may not contain DCG rules: write the clause with :-",
    ),
    passage(
        "a misspelt length",
        new=f"{PASSAGE}\ndoor_widht(0.9).",
        says="nothing uses door_widht/1: did you mean door_width/1?",
        at="door_widht",
    ),
    # - what this topology cannot express
    passage(
        "a size of the main room",
        new=f"{PASSAGE}\nroom_size(main, W, D) :- {{ W >= 5, W =< 8, D = W }}.",
        says="not expressible in this topology: the size of the main room",
        at="room_size(main",
    ),
    passage(
        "a largest size of the house",
        new=f"{PASSAGE}\nhouse_size(W, D) :- {{ W + D =< 30 }}.",
        says="not expressible in this topology: the size of the house",
        at="house_size",
    ),
    passage(
        "a corridor",
        new=f"{PASSAGE}\ncorridor(1.2).",
        says="not expressible in this topology: corridors",
        at="corridor",
    ),
    Mistake(
        "a length beyond all houses",
        "sizes.pl",
        old="passage(0.42).",
        new="passage(1.0e300).",
        says="passage: 1e+300 m, more than the 1000 m of a house",
    ),
    Mistake(
        "a size beyond all houses",
        "sizes.pl",
        old="room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7",
        new="room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7e9",
        says="bathroom: 3.7e+09 m, more than the 1000 m of a house",
    ),
    # - lengths of plans: names, numbers, and contradictions with another clause
    kitchen(
        "an area above the size",
        "room_area(kitchen,30.0,40.0).",
        "30.0 m2 at least, but room_size(kitchen, W, D) "
        "in line [sizes.pl: room_size(kitchen] allows at most 17.64 m2",
    ),
    kitchen(
        "an area below the size",
        "room_area(kitchen, 0.5, 3.0).",
        "3.0 m2 at most, but room_size(kitchen, W, D) "
        "in line [sizes.pl: room_size(kitchen] allows at least 4.0 m2",
    ),
    kitchen(
        "an area of an oblong size",
        "room_area(kitchen, 6.0, 16.0).\nroom_area(corridor, 15.0, 20.0).",
        "room_size(corridor, W, D) in line [sizes.pl: room_size(corridor] allows at most 14.4 m2",
        at="room_area(corridor",
    ),
    kitchen(
        "a least area above the greatest",
        "room_area(kitchen,12.0,10.0).",
        "must give the least and the greatest area in square metres",
    ),
    kitchen(
        "an area below zero",
        "room_area(kitchen,-1.0,10.0).",
        "must give the least and the greatest area in square metres",
    ),
    kitchen(
        "an area without end",
        "room_area(kitchen,1.0,inf).",
        "must give the least and the greatest area in square metres",
    ),
    kitchen(
        "an area by bounds",
        "room_area(kitchen,L,M) :- { L >= 6, M =< 16 }.",
        "must give the least and the greatest area in square metres",
    ),
    appended(
        "an area of a misspelt type",
        "room_area(corridr,3.0,5.0).",
        "room_area: corridr is no room type: see type/1. Did you mean corridor?",
    ),
    appended(
        "an area of a type in upper case",
        "room_area('KITCHEN',3.0,5.0).",
        "KITCHEN is no room type: see type/1. Did you mean kitchen?",
    ),
    appended("an area of two types", "room_area((wc;living),3.0,5.0).", "wc;living is no room type"),
    appended(
        "an area of misspelt types by a body",
        "room_area(T,3.0,5.0) :- member(T, [corridr]).",
        "corridr is no room type: see type/1. Did you mean corridor?",
    ),
    appended(
        "a second area",
        "room_area(kitchen,3.0,5.0).",
        "room_area(kitchen,3.0,5.0) is a second clause: the first is "
        "in line [sizes.pl: room_area(kitchen]. State one",
    ),
    appended(
        "an area for all types beside others",
        "room_area(_,3.0,5.0).",
        "room_area(_,3.0,5.0) applies to every type, but some types have their own clause",
    ),
    appended(
        "a window of a misspelt type",
        "window_size(livng, L, _) :- { L = 1.2 }.",
        "window_size: livng is no room type: see type/1. Did you mean living?",
    ),
    appended(
        "a free square of a misspelt type",
        "turning(bathrom, 1.5).",
        "turning: bathrom is no room type: see type/1. Did you mean bathroom?",
    ),
    appended(
        "a free square that is no length",
        "turning(bathroom, large).",
        "turning(bathroom, large) must be a number of metres, 0 or more",
    ),
    appended(
        "a free square that is larger than its rooms",
        "turning(bathroom, 3.5).",
        "no such room is large enough: room_size(bathroom",
    ),
    appended(
        "an opening of a misspelt type",
        "opening_size(kitchen, livng, L, _) :- { L = 1.2 }.",
        "opening_size: livng is no room type: see type/1. Did you mean living?",
    ),
    appended(
        "the size of an opening that there is not",
        "opening_size(kitchen, living, L, _) :- { L = 1.2 }.",
        "no opening joins such rooms: state opening(kitchen,living) in a .lp file",
    ),
    appended(
        "the area of a room with parts that has none",
        "whole_area(living, 20.0, 30.0).",
        "whole_area(living, 20.0, 30.0): no room is a part of a room of type living: state which",
    ),
    window(
        "a window without size",
        "L >= 0.6*Wall, L =< 0.4*Wall",
        "allows no size: L >= 0.6*Wall, L =< 0.4*Wall and Wall >= ",
    ),
    window(
        "a window longer than any wall",
        "L >= 5.0, L =< Wall",
        "with window_margin(0.65) "
        "in line [lengths.pl: window_margin] on both sides no such window fits in room_size(",
    ),
    window("a window without a least length", "L =< 0.6*Wall", "L has no lower bound"),
    plan(
        "a product in the size of a room where areas are stated",
        "room_size(kitchen,  W, D) :- { W >= 2.0, W =< 4.2, D >= 2.0, D =< 4.2 }.",
        "room_size(kitchen,  W, D) :- { W >= 2.0, W =< 4.2, D >= 2.0, D =< 4.2, W*D =< 9 }.",
        "decides only linear constraints: state the area by room_area(Type,Least,Most)",
        at="W*D",
    ),
    window(
        "a window of a product",
        "L >= 0.6, L =< 2.4, L*Wall =< 4",
        "L*Wall =< 4 is nonlinear, but CLP(R) decides only linear constraints",
        at="L*Wall",
    ),
    house(
        "a house without size",
        "W >= 10, W =< 9, D =< W",
        "house_size(W, D) allows no size: W >= 10 and W =< 9 exclude each other",
    ),
    house(
        "a house smaller than each room",
        "W =< 0.7, D =< 8",
        "house_size(W, D): no room fits in a house of this size, not even room_size(wc, W, D) "
        "in line [sizes.pl: room_size(wc] of sizes.pl",
    ),
    house(
        "an area of the house by a product",
        "W*D =< 60",
        "decides only linear constraints: state the area by house_area(Least,Most)",
        at="W*D",
    ),
    appended(
        "an area of the house that is less than any room's",
        "house_area(0.5, 1.0).",
        "house_area(0.5, 1.0): 1.0 m2 at most, but no room is smaller than room_area(",
    ),
    house(
        "sides of the house that do not allow its area",
        "W =< 7, D =< 7 }.\nhouse_area(L, M) :- { L = 50.0, M = 60.0",
        "50.0 m2 at least, but house_size(W, D) in line [lengths.pl: house_size] allows at most 49.0 m2",
        at="house_area",
    ),
    *(
        Mistake(
            f"{title} of a star",
            "sizes.pl",
            old="",
            new=f"house_area({bounds}).",
            says=f"house_area({bounds}){says}",
        )
        for title, bounds, says in (
            (
                "an area",
                "5.0, 11.0",
                ": 11.0 m2 at most, but neither the main room nor another is smaller than room_size(bathroom",
            ),
            (
                "an area that no number of rooms has",
                "9.0e5, 9.1e5",
                ": 900000.0 m2 at least, but a house of 128 rooms, the largest",
            ),
            (
                "a least area above the greatest",
                "60.0, 50.0",
                " must give the least and the greatest area in square metres",
            ),
        )
    ),
    appended(
        "an area of the house that no number of rooms has",
        "house_area(4000.0, 4100.0).",
        "house_area(4000.0, 4100.0): 4000.0 m2 at least, but a house of 128 rooms, the largest number, has",
    ),
    Mistake(
        "an area of a house of units",
        "sizes.pl",
        old="",
        new="house_area(300.0, 400.0).",
        says="house_area(300.0, 400.0): houses of units have no stated area",
        grammar="apartments",
    ),
    appended(
        "a least area of the house above the greatest",
        "house_area(60.0, 50.0).",
        "must give the least and the greatest area in square metres",
    ),
    plan(
        "a second area of the house",
        "",
        "house_area(50.0, 60.0).\nhouse_area(50.0, 70.0).",
        "is a second clause: the first is in line",
        at="house_area(50.0, 70.0)",
    ),
    appended("an area of the house alone", "house_area(50.0).", "house_area/1"),
    appended(
        "a second size of the house",
        "house_size(W, D) :- { W =< 20, D =< 20 }.",
        "house_size(W, D) is a second clause: the first is "
        "in line [lengths.pl: house_size] of lengths.pl. State one",
    ),
    appended(
        "a depth of units where there are none",
        "unit_depth(D) :- { D >= 7.0, D =< 9.0 }.",
        "unit_depth(D): houses of this topology have no units",
    ),
    Mistake(
        "a depth of units that is a square",
        "sizes.pl",
        old="D >= 7.0, D =< 8.8",
        new="D >= 7.0, D =< 8.8, D*D =< 70",
        says="D*D =< 70 is nonlinear",
        at="D*D",
        grammar="apartments",
    ),
    Mistake(
        "a depth of units without size",
        "sizes.pl",
        old="unit_depth(D) :- { D >= 7.0, D =< 8.8 }.",
        new="unit_depth(D) :- { D >= 9.0, D =< 8.8 }.",
        says="unit_depth(D) allows no size: D >= 9.0 and D =< 8.8 exclude each other",
        grammar="apartments",
    ),
    plan(
        "a door wider than walls",
        "door_width(0.8).",
        "door_width(3.9).",
        "door_margin(0.1) in line [lengths.pl: door_margin], but room_size(wc, W, D) "
        "in line [sizes.pl: room_size(wc] of sizes.pl allows at most 2.0 m",
        file="lengths.pl",
    ),
    plan(
        "a door of no width",
        "door_width(0.8).",
        "door_width(0).",
        "door_width(0) must be a number of metres more than 0",
        file="lengths.pl",
    ),
    plan(
        "a room that no door fits",
        "room_size(wc,       W, D) :- { W >= 0.9, W =< 2.0, D >= 0.9, D =< 2.0 }.",
        "room_size(wc, W, D) :- { W = 0.6, D = 0.6 }.",
        "of lengths.pl with door_margin(0.1) in line [lengths.pl: door_margin] of lengths.pl, "
        "but this allows at most 0.6 m",
    ),
    plan(
        "a margin below zero",
        "door_margin(0.1).",
        "door_margin(-0.1).",
        "door_margin(-0.1) must be a number of metres, 0 or more",
        file="lengths.pl",
    ),
    plan(
        "a word for a margin",
        "door_margin(0.1).",
        "door_margin(wide).",
        "door_margin(wide) must be a number of metres, 0 or more",
        file="lengths.pl",
    ),
    plan(
        "a second margin",
        "door_margin(0.1).",
        "door_margin(0.1). door_margin(0.2).",
        "door_margin(0.2) is a second clause",
        at="door_margin(0.2)",
        file="lengths.pl",
    ),
    plan(
        "a margin as long as the walls",
        "window_margin(0.65).",
        "window_margin(20.0).",
        "no window fits with this margin on both sides in room_size(living, W, D) "
        "in line [sizes.pl: room_size(living] of sizes.pl",
        file="lengths.pl",
    ),
    plan(
        "a gap between rooms that share walls",
        "room_gap(0.0).",
        "room_gap(0.6).",
        "rooms share walls in this topology: state room_gap(0.0)",
        file="lengths.pl",
    ),
    Mistake(
        "a door wider than the rooms around a main room",
        "sizes.pl",
        old="door_width(0.762).",
        new="door_width(5.0).",
        says="a door needs 5.0 m of the width, but room_size(bathroom, W, D) in line 14 allows at most 3.7 m",
    ),
    passage(
        "a number that no machine holds", new="passage(1.0e400).", says="no length is so large", at="1.0e400"
    ),
)
