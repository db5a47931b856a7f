"""Words of a grammar's .lp files: misspelt words, and words that nothing uses."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from clingo.ast import AST, ASTSequence, ASTType, Sign

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import ADJACENT, IN_PROLOG, PLANS, STAR
from vitruvius.logic.language.asp.audit import STAGES, UNITS
from vitruvius.logic.language.asp.causes import Mistake, misspelt_name
from vitruvius.logic.language.asp.inexpressible import inexpressible
from vitruvius.logic.language.asp.statements import Statement, error_at, read
from vitruvius.logic.layout.program import CORE
from vitruvius.logic.layout.reading import children
from vitruvius.logic.spelling import closest

Signature = tuple[str, int]

CHOICES = {("pick", 2), ("picks", 2), ("turn", 2)}
"""Predicates whose first argument names a choice of ``option/3``."""


PLAIN_ATOM = re.compile(r"(?:not )?(?!option\b|picks?\b|turn\b)([a-z_]\w*)(?:\(([^()\"';|&]*)\))?")
"""Text of a literal of an atom whose arguments have no parts, and that is about no choice of ``option/3``."""

WORD = re.compile(r"[a-z\"'#&]")
"""Pattern of a character that each text with a word contains. Variables may contain it, too."""

CONSTANT = re.compile(r"(?<![\w#])_*[a-z]\w*")
"""Text of a constant among such arguments."""


class Use(NamedTuple):
    """Word in a statement: its node, or the literal that has it."""

    node: Any
    statement: Statement


@dataclass
class Words:
    """Predicates that statements derive and use, constants and #const names, each with its uses."""

    derived: dict[Signature, list[Use]] = field(default_factory=dict)
    used: dict[Signature, list[Use]] = field(default_factory=dict)
    constants: dict[str, list[Use]] = field(default_factory=dict)
    stated: set[str] = field(default_factory=set)
    """Constants in heads."""
    defined: dict[str, Use] = field(default_factory=dict)
    rules: list[Statement] = field(default_factory=list)
    opened: dict[Signature, Use] = field(default_factory=dict)
    """Names of ``#defined``: in the core the predicates that a grammar may state."""
    documented: set[Signature] = field(default_factory=set)
    """Predicates that a comment ``%*! p(A,B): ... *%`` describes."""
    core: "Words | None" = None
    """Words of the core with the grammar's topology, for the words of a grammar."""


def words(statements: Iterable[Statement], core: Words | None = None, *, are_shipped: bool = False) -> Words:
    """Return all words of these statements.

    Plain literals of statements that are shipped are read as text. clingo writes no text of terms that are
    nested very deep: it ends the process.
    """
    found = Words(core=core)
    for statement in statements:
        node = statement.node
        if node.ast_type == ASTType.Rule:
            found.rules.append(statement)
            if not are_shipped or not _read_plain(node.head, statement, found, found.derived):
                _read(node.head, statement, found, found.derived)
            for literal in node.body:
                if not are_shipped or not _read_plain(literal, statement, found, found.used):
                    _read(literal, statement, found, found.used)
        elif node.ast_type == ASTType.Defined:
            found.opened[node.name, node.arity] = Use(node, statement)
        elif node.ast_type == ASTType.Definition:
            found.defined[node.name] = Use(node, statement)
        elif node.ast_type == ASTType.Comment and node.value.startswith("%*!"):
            for name, arguments in re.findall(r"\b([a-z]\w*)\(([^()]*)\):", node.value):
                found.documented.add((name, arguments.count(",") + 1))
    return found


def _read_plain(node: AST, statement: Statement, found: Words, atoms: dict[Signature, list[Use]]) -> bool:
    """Collect the words of a plain literal by its text, in a fourth of the time. Return True if it is one.

    It is for the core alone, since mistakes of a grammar need the place of each word.
    """
    text = str(node)
    if not WORD.search(text):
        return True
    plain = PLAIN_ATOM.fullmatch(text)
    if not plain or (atoms is found.derived and text.startswith("not ")):
        return False
    name, arguments = plain.groups()
    use = Use(node, statement)
    atoms.setdefault((name, arguments.count(",") + 1 if arguments else 0), []).append(use)
    constants = CONSTANT.findall(arguments or "")
    for constant in constants:
        found.constants.setdefault(constant, []).append(use)
    if atoms is found.derived:
        found.stated.update(constants)
    return True


@cache
def core_words(topology: tuple[Path, ...] = (STAR,)) -> Words:
    """Return the words of the core with these files of a topology and the files read on demand."""
    return words(_core(topology), are_shipped=True)


def _core(topology: tuple[Path, ...]) -> list[Statement]:
    named = [ADJACENT] if set(PLANS) <= set(topology) and ADJACENT not in topology else []
    return read([CORE, *topology, *named])


@cache
def opened(topology: tuple[Path, ...]) -> set[Signature]:
    """Return the predicates that a grammar may state with these files of a topology.

    The result is ``core_words(topology).opened``, in a tenth of the time.
    """
    nodes = [statement.node for statement in _core(topology)]
    return {(node.name, node.arity) for node in nodes if node.ast_type == ASTType.Defined}


def stages(core: Words) -> tuple[str, ...]:
    """Return the programs of a layout with these words of the core, in order."""
    return (UNITS, *STAGES) if ("unit", 2) in core.derived else STAGES


def _read(node: Any, statement: Statement, found: Words, atoms: dict[Signature, list[Use]]) -> None:
    """Collect atoms and constants below a node. Conditions and negative literals in a head count as used."""
    if isinstance(node, ASTSequence | list | tuple):
        for part in node:
            _read(part, statement, found, atoms)
        return
    if not isinstance(node, AST):
        return
    kind = node.ast_type
    if kind == ASTType.ConditionalLiteral:
        _read(node.literal, statement, found, atoms)
        _read(node.condition, statement, found, found.used)
        return
    if kind == ASTType.Literal and node.sign != Sign.NoSign:
        atoms = found.used
    if kind == ASTType.SymbolicAtom:
        for atom in alternatives(node.symbol):
            if atom.ast_type == ASTType.Function:
                arguments = atom.arguments
                atoms.setdefault((atom.name, len(arguments)), []).append(Use(atom, statement))
                _read(arguments, statement, found, atoms)
        return
    name = ""
    if kind == ASTType.Function and not node.arguments:
        name = str(node.name)
    elif kind == ASTType.SymbolicTerm and not re.fullmatch(r"-?\d+|#\w+", str(node.symbol)):
        name = str(node.symbol)
    if name:
        found.constants.setdefault(name, []).append(Use(node, statement))
        if atoms is found.derived:
            found.stated.add(name)
    for child in children(node):
        _read(child, statement, found, atoms)


def alternatives(symbol: Any) -> list[Any]:
    """Return the functions of an atom: those of a pool, or the one below classical negation."""
    if symbol.ast_type == ASTType.Pool:
        return [each for part in symbol.arguments for each in alternatives(part)]
    if symbol.ast_type == ASTType.UnaryOperation:
        return alternatives(symbol.argument)
    return [symbol]


def misspelt_predicates(own: Words) -> Iterator[Mistake]:
    """Yield a mistake for each predicate that nothing derives or uses."""
    core = own.core or core_words()
    known = {*core.used, *core.derived, *core.opened}
    for signature, uses in ({each: [use] for each, use in own.opened.items()} | own.used).items():
        if signature not in own.derived and signature not in known:
            yield _unknown(signature, "derives", uses[0], known | set(own.derived), core)
    inputs = {each for each in known if each not in core.derived or each in core.opened}
    for signature, uses in own.derived.items():
        if signature not in own.used and signature not in known:
            yield _unknown(signature, "uses", uses[0], inputs | set(own.used), core)


def unknown_choices(own: Words) -> Iterator[Mistake]:
    """Yield a mistake for each picked or weighed choice that no option/3 of grammar or core offers."""
    core = own.core or core_words()
    offers = [*own.derived.get(("option", 3), ()), *core.derived.get(("option", 3), ())]
    of_grammar = {each for use in own.derived.get(("option", 3), ()) for each in _heads(use)}
    names = {each for use in offers for each in _heads(use)}
    if "" in of_grammar:
        return  # A choice whose name is a variable may be any.
    said = {""}
    for signature in sorted(CHOICES):
        for use in (*own.used.get(signature, ()), *own.derived.get(signature, ())):
            for name in sorted(_heads(use) - names - said):
                said.add(name)
                choice = f"{signature[0]}({','.join(map(str, use.node.arguments))})"
                error = error_at(use.node, f"{choice}: no option/3 has this name{_meant(name, names)}")
                meant = closest(name, names) or ""
                yield Mistake(error, frozenset({name, meant} - {""}), frozenset({f"{name}, a choice"}))


def _heads(use: Use) -> set[str]:
    """Return the possible names in the first argument of an atom, an empty text for a term without a name."""
    found = (re.match(r"[a-z]\w*", str(each)) for each in alternatives(use.node.arguments[0]))
    return {name[0] if name else "" for name in found}


def misspelt_names(own: Words, sized: Iterable[str]) -> Iterator[Mistake]:
    """Yield a mistake for each constant that no other statement names.

    ``sized`` are the names that the ``.pl`` files know.
    """
    core = own.core or core_words()
    known = {*core.used, *core.derived, *core.opened}
    # Values of a choice may only be picked, and a group of pieces need not be asked about.
    values = [str(use.node.arguments[1]) for use in own.derived.get(("option", 3), ())]
    for signature in (("topology", 1), ("one_room", 2)):
        values += [str(use.node.arguments[0]) for use in own.derived.get(signature, ())]
    elsewhere = {*core.constants, *core.defined, *sized, *re.findall(r"[\w']+", " ".join(values))}
    spoken = {each for each in elsewhere if len(each) > 1}  # Letters are parameters of the core's programs.
    others = {*elsewhere, *own.stated, *own.defined}
    lines = _line_names(own)
    for name, uses in own.constants.items():
        if name in own.defined or name in elsewhere:
            continue
        if name in lines and not closest(name, others - {name}):
            continue  # A line for sides of one kind, as at a court.
        if len(uses) == 1 and (beside := _beside(name, own, known)) is not None and not beside & spoken:
            continue  # A value in a table of the grammar, such as zone(kitchen,loud).
        if len(uses) == 1:
            yield _misspelt(name, uses[0], "occurs nowhere else", others - {name})
        elif name not in own.stated:
            yield _misspelt(name, uses[0], "stands in no fact or head", others)
    for name, use in own.defined.items():
        if name not in own.constants:
            error = error_at(use.node, f"#const {name} is not used{_meant(name, core.defined)}")
            yield misspelt_name(error, name, "")


def _line_names(own: Words) -> dict[str, list[Use]]:
    """Return the names in the lines on which a topology puts rooms, as ``joint`` in ``joint(R)``."""
    found: dict[str, list[Use]] = {}
    for use in own.derived.get(("edge", 3), ()):
        for name in re.findall(r"\b[a-z]\w*", str(use.node.arguments[2])):
            found.setdefault(name, []).append(use)
    return found


def misspelt_lines(own: Words) -> Iterator[Mistake]:
    """Yield a mistake for each line that occurs once and resembles another: ``outlin(S)``, ``outline(S)``."""
    lines = _line_names(own)
    others = {*lines, "outline"}
    for name, uses in lines.items():
        near = closest(name, others - {name})
        if near and len(uses) == 1 and name not in own.constants and name != "outline":
            yield _misspelt(name, uses[0], "is a line that occurs nowhere else", {near})


def _misspelt(name: str, use: Use, what: str, others: set[str]) -> Mistake:
    error = error_at(use.node, f"{name} {what}{_meant(name, others)}")
    return misspelt_name(error, name.strip("'"), closest(name, others) or "")


def capitalised(own: Words) -> Iterator[GrammarError]:
    """Yield errors for variables that occur once in a rule and resemble a constant, as in ``room(R,Hall)``.

    Such a rule concerns any room.
    """
    names = own.constants.keys()
    for statement in own.rules:
        variables = re.findall(r"\b[A-Z][a-z]\w+", str(statement.node))
        for variable in variables:
            name = variable[0].lower() + variable[1:]
            if name in names and variables.count(variable) == 1:
                yield statement.error(f"{variable} stands for anything here: did you mean {name}?")


def contradictory(own: Words) -> Iterator[GrammarError]:
    """Yield an error for each rule whose body requires a literal and its negation."""
    for statement in own.rules:
        literals = {str(each) for each in statement.node.body}
        for each in sorted(literals):
            if f"not {each}" in literals:
                yield statement.error(f"this rule never binds: {each} and not {each}")


def _beside(name: str, own: Words, known: set[Signature]) -> set[str] | None:
    """Return the other values in the same argument of a grammar's own predicate, or None."""
    for signature, uses in own.derived.items():
        columns = [] if signature in known else zip(*(use.node.arguments for use in uses), strict=True)
        for arguments in columns:
            values = set(re.findall(r"\"[^\"]*\"|[\w']+", " ".join(map(str, arguments))))
            if name in values:
                return values - {name}
    return None


def _unknown(signature: Signature, what: str, use: Use, known: Iterable[Signature], core: Words) -> Mistake:
    name, arity = signature
    here = f"{name}/{arity}"
    if name in IN_PROLOG:
        why = f"{name} belongs in a .pl file: see docs/rules.md#lengths-in-pl-files"
        return misspelt_name(error_at(use.node, why), here, "")
    if sentence := inexpressible(name):
        return misspelt_name(error_at(use.node, sentence), here, "")
    if name in core_words().defined:
        error = error_at(use.node, f"{name} is a constant: write {name} = {use.node.arguments[0]}")
        return misspelt_name(error, here, "")
    if signature in core_words(PLANS).documented - core.documented:
        why = (
            f"{here} is known where rooms share walls, which those around a main room do not: see topology/1"
        )
        return misspelt_name(error_at(use.node, why), here, "")
    meant = _meant_predicate(signature, known, core)
    hint = f": did you mean {meant}?" if meant else ""
    return misspelt_name(error_at(use.node, f"nothing {what} {here}{hint}"), here, meant)


def _meant_predicate(signature: Signature, known: Iterable[Signature], core: Words) -> str:
    """Return the intended predicate, as in ``window/2``, or an empty text.

    Its name is this one or the most similar one. Predicates with the same number of arguments come first,
    then documented ones.
    """
    name, arity = signature
    known = set(known) - {signature}
    close = name if any(other == name for other, _ in known) else closest(name, {other for other, _ in known})
    same = [each for each in known if each[0] == close]
    best = min(same, key=lambda each: (each[1] != arity, each not in core.documented, each), default=None)
    return f"{best[0]}/{best[1]}" if best else ""


def _meant(name: str, names: Iterable[str]) -> str:
    close = closest(name, names)
    return f": did you mean {close}?" if close else ""
