"""Messages between this process and a solver process: questions, answers and remarks, each a line of JSON."""

from typing import Any

import msgspec

from vitruvius.logic.errors import Finding
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.why.answer import Why


class Question(msgspec.Struct, frozen=True, kw_only=True, tag=True):
    """Question that the solver process must answer in ``seconds``."""

    seconds: float = 0.0


class Prepare(Question, frozen=True, tag=True):
    """Request to get ready to load the grammar in this directory. Answer: ``Prepared``."""

    grammar: str


class Open(Question, frozen=True, tag=True):
    """Request to load the grammar in a directory, once.

    Answer: ``Loaded``, or ``Judged`` for a wrong grammar if ``errors`` is True.

    Without ``remarks``, and in a shipped grammar without ``errors``, clingo's remarks are no errors. With
    ``trial`` the process first tries to load the grammar step by step, also for houses with these numbers of
    rooms. Each step has ``step`` seconds of processor time.
    """

    grammar: str
    cell: float = 0.0
    errors: bool = False
    remarks: bool = True
    trial: tuple[int, ...] | None = None
    step: float = 0.0


class MakeHouse(Question, frozen=True, tag=True):
    """Request for house ``index`` of a request. Answer: ``Made``."""

    request: HouseRequest
    seed: int
    index: int


class MovePlan(Question, frozen=True, tag=True):
    """Request for the smallest change of a plan that satisfies the grammar's lengths. Answer: ``Moved``."""

    request: HouseRequest
    seed: int


class CountLayouts(Question, frozen=True, tag=True):
    """Request to count layouts. Answers: ``Counted`` several times in ``share`` seconds, then ``Done``."""

    request: HouseRequest
    share: float


class Explain(Question, frozen=True, tag=True):
    """Request to explain a part of a house.

    Answers: ``Explained`` for each part as it is found, then ``Done``.
    """

    target: str
    house: dict[str, Any]
    searching: float
    """Seconds for the search for alternatives, after the house is generated again."""


class Ease(Question, frozen=True, tag=True):
    """Request for changes that make layouts easy to find.

    Answers: ``Eased`` for each as found, then ``Done``.
    """

    request: HouseRequest


class Promise(Question, frozen=True, tag=True):
    """Request for the promises of the houses of a request. Answer: ``Promised``."""

    request: HouseRequest


class Lint(Question, frozen=True, tag=True):
    """Request for rules without effect in any house. Answer: ``Judged``."""


class Warn(Question, frozen=True, tag=True):
    """Request for rules without effect in houses of ``rooms`` rooms. Answer: ``Judged``.

    The search has ``processor`` seconds of processor time.
    """

    rooms: int
    processor: float


class Prepared(msgspec.Struct, frozen=True, tag=True):
    """Answer of a process that is ready to load a grammar."""


class Loaded(msgspec.Struct, frozen=True, tag=True):
    """Versions of the solvers, furniture of each room type, and the topology's largest number of rooms."""

    versions: dict[str, str]
    types: dict[str, list[str]]
    most_rooms: int


class Judged(msgspec.Struct, frozen=True, tag=True):
    """Findings about the rules."""

    findings: list[Finding]


class Made(msgspec.Struct, frozen=True, tag=True):
    """House in the form of ``House.to_dict``."""

    house: dict[str, Any]


class Moved(msgspec.Struct, frozen=True, tag=True):
    """Plan with moved walls, or None if no places of the walls satisfy the lengths."""

    plan: OwnPlan | None


class Counted(msgspec.Struct, frozen=True, tag=True):
    """Number of layouts found so far. ``exact`` is None until the end of a count."""

    name: str
    number: int
    exact: bool | None


class Explained(msgspec.Struct, frozen=True, tag=True):
    """Part of an explanation."""

    why: Why


class Eased(msgspec.Struct, frozen=True, tag=True):
    """Change of the request with which a layout is soon found."""

    how: str


class Promised(msgspec.Struct, frozen=True, tag=True):
    """Promises that the houses keep."""

    promises: Promises


class Done(msgspec.Struct, frozen=True, tag=True):
    """Sent after the last answer to a question."""


class Failed(msgspec.Struct, frozen=True, tag=True):
    """Error instead of an answer, in the form of ``errors.to_record``."""

    error: dict[str, Any]


class Trying(msgspec.Struct, frozen=True, tag=True):
    """Sent before an answer: the error to report if no answer follows. None at the end of a trial."""

    error: dict[str, Any] | None


class Working(msgspec.Struct, frozen=True, tag=True):
    """Sent before an answer that takes long: the current stage."""

    stage: str


class Late(msgspec.Struct, frozen=True, tag=True):
    """Sent instead of an answer on timeout: what the process was doing."""

    account: str


Asked = Prepare | Open | MakeHouse | MovePlan | CountLayouts | Explain | Ease | Promise | Lint | Warn
Answer = Prepared | Loaded | Judged | Made | Moved | Counted | Explained | Eased | Promised | Done
Said = Answer | Failed | Trying | Working | Late
