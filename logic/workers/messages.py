"""What this process and a solver process say to each other: questions, answers and remarks, a line each."""

from typing import Any

import msgspec

from logic.errors import Finding
from logic.house.promises import Promises
from logic.why.answer import Why


class Question(msgspec.Struct, frozen=True, kw_only=True, tag=True):
    """Something to be answered in these seconds."""

    seconds: float = 0.0


class Prepare(Question, frozen=True, tag=True):
    """Be ready to load a grammar of this directory: ``Prepared``."""

    grammar: str


class Open(Question, frozen=True, tag=True):
    """Load the grammar of a directory, once: ``Loaded``, or ``Judged`` where it has ``errors`` that are asked
    for. Without ``remarks`` only what is wrong is looked for.

    With ``trial`` it is tried step by step before, for houses of these numbers of rooms too, each in ``step``
    seconds of processor time.
    """

    grammar: str
    cell: float = 0.0
    errors: bool = False
    remarks: bool = True
    trial: tuple[int, ...] | None = None
    step: float = 0.0


class MakeHouse(Question, frozen=True, tag=True):
    """House ``index`` of a request, as ``Request.to_dict`` has it: ``Made``."""

    request: dict[str, Any]
    seed: int
    index: int
    inferences: int


class MovePlan(Question, frozen=True, tag=True):
    """The least change of a request's plan with which it keeps the grammar's lengths: ``Moved``."""

    request: dict[str, Any]
    seed: int


class CountLayouts(Question, frozen=True, tag=True):
    """The layouts of a request: ``Counted`` again and again in ``share`` seconds, then ``Done``."""

    request: dict[str, Any]
    share: float


class Explain(Question, frozen=True, tag=True):
    """Why a part of a house is as it is: ``Explained``, part by part as it is found, then ``Done``."""

    target: str
    house: dict[str, Any]
    inferences: int
    searching: float
    """Seconds in which it is searched for what could be instead, once the house is made again."""


class Ease(Question, frozen=True, tag=True):
    """What makes a layout of a request easy to find: ``Eased``, as it is found, then ``Done``."""

    request: dict[str, Any]


class Promise(Question, frozen=True, tag=True):
    """What houses of a request promise, as ``Request.to_dict`` has it: ``Promised``."""

    request: dict[str, Any]


class Lint(Question, frozen=True, tag=True):
    """What is of no use in the rules, whatever is asked for: ``Judged``."""


class Warn(Question, frozen=True, tag=True):
    """The same for houses of so many rooms, in these seconds of processor time: ``Judged``."""

    rooms: int
    processor: float


class Prepared(msgspec.Struct, frozen=True, tag=True):
    """The process is ready to load a grammar."""


class Loaded(msgspec.Struct, frozen=True, tag=True):
    """The solvers' versions, the pieces of each type of room, and the most rooms that the topology allows."""

    versions: dict[str, str]
    types: dict[str, list[str]]
    most_rooms: int


class Judged(msgspec.Struct, frozen=True, tag=True):
    """What is found in the rules."""

    findings: list[Finding]


class Made(msgspec.Struct, frozen=True, tag=True):
    """A house, as ``House.to_dict`` has it."""

    house: dict[str, Any]


class Moved(msgspec.Struct, frozen=True, tag=True):
    """A plan, as ``Request.to_dict`` has it; None where walls can be nowhere."""

    plan: dict[str, Any] | None


class Counted(msgspec.Struct, frozen=True, tag=True):
    """How many layouts there are so far; ``exact`` is known at the end of a count."""

    name: str
    number: int
    exact: bool | None


class Explained(msgspec.Struct, frozen=True, tag=True):
    """A part of an answer."""

    why: Why


class Eased(msgspec.Struct, frozen=True, tag=True):
    """With or without what a layout is soon found."""

    how: str


class Promised(msgspec.Struct, frozen=True, tag=True):
    """What houses keep."""

    promises: Promises


class Done(msgspec.Struct, frozen=True, tag=True):
    """There are no more answers to this question."""


class Failed(msgspec.Struct, frozen=True, tag=True):
    """The error that there is in the place of an answer, as ``errors.to_record`` has it."""

    error: dict[str, Any]


class Trying(msgspec.Struct, frozen=True, tag=True):
    """Before an answer: what is wrong if none comes; at the end of a trial, nothing."""

    error: dict[str, Any] | None


class Working(msgspec.Struct, frozen=True, tag=True):
    """Before an answer that takes long: which stage is at work on it."""

    stage: str


class Late(msgspec.Struct, frozen=True, tag=True):
    """In the place of an answer: what the process did when its time was over."""

    account: str


Asked = Prepare | Open | MakeHouse | MovePlan | CountLayouts | Explain | Ease | Promise | Lint | Warn
Answer = Prepared | Loaded | Judged | Made | Moved | Counted | Explained | Eased | Promised | Done
Said = Answer | Failed | Trying | Working | Late
