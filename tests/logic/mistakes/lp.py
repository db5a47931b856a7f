"""Mistakes in ``.lp`` files."""

from tests.logic.mistakes import Mistake

MISTAKES = (
    # - words
    Mistake(
        "a predicate that nothing derives",
        "rooms.lp",
        old=":- rooms >= 3, basic(T), not room(_,T).",
        new=":- rooms >= 3, basic(T), not rom(_,T).",
        at="rom(_,T)",
        says="nothing derives rom/2: did you mean room/2?",
    ),
    Mistake(
        "a predicate that nothing uses",
        "rooms.lp",
        old="type(bedroom;",
        new="typ(attic). type(bedroom;",
        says="nothing uses typ/1: did you mean type/1?",
    ),
    Mistake(
        "another number of arguments",
        "furniture.lp",
        old="",
        new="may(bedroom,bed,1).",
        says="nothing uses may/3: did you mean may/4?",
    ),
    Mistake(
        "a misspelt type",
        "furniture.lp",
        old="may(hall,sofa,",
        new="may(hal,sofa,",
        says="no room type has this name",
    ),
    Mistake(
        "a misspelt basic type",
        "rooms.lp",
        old="basic(bedroom; bathroom;",
        new="basic(bedroom; bathrom;",
        at="bathrom",
        says="bathrom stands nowhere else: did you mean bathroom?",
    ),
    Mistake(
        "a misspelt place",
        "furniture.lp",
        old="stands(wardrobe, (front; left; back; right)).",
        new="stands(wardrobe, (front; left; bakc; right)).",
        says="no such place: front, left, back, right or middle",
    ),
    Mistake(
        "a misspelt piece in a rule",
        "arrangement.lp",
        old=":- turned(bed,K,E)",
        new=":- turned(bde,K,E)",
        at="bde",
        says="bde stands nowhere else: did you mean bed?",
    ),
    Mistake(
        "a constant without use",
        "rooms.lp",
        old="type(bedroom;",
        new="#const rom = 3.\ntype(bedroom;",
        says="#const rom is not used: did you mean rooms?",
    ),
    # - facts that contradict each other
    Mistake(
        "a piece that stands nowhere",
        "furniture.lp",
        old="",
        new="may(bedroom,lamp,0,1).",
        says="may(bedroom,lamp,0,1): the piece stands nowhere: see stands/2",
    ),
    Mistake(
        "counts upside down",
        "furniture.lp",
        old="beside(bed,bedside,0,2)",
        new="beside(bed,bedside,2,0)",
        says="the lesser first",
    ),
    # - no rules
    Mistake(
        "a choice",
        "furniture.lp",
        old="",
        new="{ cosy }.",
        says="option/3",
    ),
    Mistake(
        "an external",
        "furniture.lp",
        old="",
        new="#external cosy.",
        says="#external",
    ),
    Mistake(
        "a script",
        "rooms.lp",
        old="type(bedroom;",
        new="#script (python)\nprint(1)\n#end.\ntype(bedroom;",
        says="no scripts",
    ),
    # - rules without effect
    Mistake(
        "a rule that never binds",
        "rooms.lp",
        old="",
        new=":- room(R,T), R > 999.",
        says="never binds: :- room(R,T), R > 999.",
        severity="warning",
    ),
    Mistake(
        "a furniture rule that never binds",
        "arrangement.lp",
        old="",
        new=":- on(bed,K,middle,_).",
        says="never binds: :- on(bed,K,middle,_).",
        severity="warning",
    ),
)
