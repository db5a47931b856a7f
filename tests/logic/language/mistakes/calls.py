"""Mistakes in calls from Python: the call, the error's class, and its message."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium

from vitruvius.agent.evaluation.protocol import measure
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.released import CheckpointError
from vitruvius.agent.runs.runs import run
from vitruvius.logic import (
    GrammarError,
    House,
    HouseFileError,
    HouseStream,
    Rect,
    RequestError,
    Star,
    check,
    count_layouts,
    generate,
    load,
    save,
)
from vitruvius.sim import HouseEnv, HouseVectorEnv

HOUSE = House.of_star(Star(Rect(0, 0, 4, 4)))
ENVIRONMENT = "Vitruvius/House-v0"


@dataclass(frozen=True)
class Call:
    """Call with these arguments, which ends in an error."""

    call: Callable[..., Any]
    given: dict[str, Any]
    says: tuple[str, ...]
    error: type[Exception] = TypeError


MISTAKES = (
    # keywords
    Call(
        generate, {"room": 4}, ("generate() got an unexpected keyword argument 'room': did you mean rooms?",)
    ),
    Call(generate, {"rooms": 4, "type": {}}, ("unexpected keyword argument 'type': did you mean types?",)),
    Call(
        generate,
        {"rooms": 4, "pieces": {}},
        ("unexpected keyword argument 'pieces': did you mean furniture?",),
    ),
    Call(generate, {"rooms": 4, "n": 9}, ("unexpected keyword argument 'n': did you mean count?",)),
    Call(generate, {"rooms": 4, "theme": 9}, ("unexpected keyword argument 'theme': it has rooms, types",)),
    Call(HouseStream, {"rooms": 4, "number": 9}, ("unexpected keyword argument 'number'",)),
    Call(
        count_layouts, {"rooms": 4, "seed": 1}, ("count_layouts() got an unexpected keyword argument 'seed'",)
    ),
    Call(check, {"house": [HOUSE]}, ("check() takes one House, not list",)),
    Call(
        HouseVectorEnv, {"config": "paper"}, ("unexpected keyword argument 'config': did you mean preset?",)
    ),
    Call(HouseEnv, {"config": "paper"}, ("unexpected keyword argument 'config': did you mean preset?",)),
    Call(gymnasium.make, {"id": ENVIRONMENT, "config": "paper"}, ("'config': did you mean preset?",)),
    Call(gymnasium.make_vec, {"id": ENVIRONMENT, "task": "main"}, ("'task': did you mean targets?",)),
    Call(gymnasium.make_vec, {"id": ENVIRONMENT, "houzes": "a"}, ("'houzes': did you mean houses?",)),
    Call(
        HouseVectorEnv, {"houses": {"room": 4}}, ("unexpected keyword argument 'room': did you mean rooms?",)
    ),
    Call(
        make_envs,
        {"houses": [HOUSE], "config": "paper"},
        ("unexpected keyword argument 'config': did you mean preset?",),
    ),
    Call(
        run,
        {"houses": [HOUSE], "preset": "pqn"},
        ("run() got an unexpected keyword argument 'preset': did you mean config?",),
    ),
    Call(
        measure,
        {"agents": {}, "targets": ["main"]},
        ("unexpected keyword argument 'targets': did you mean modes?",),
    ),
    # values
    Call(generate, {"rooms": "4"}, ("rooms must be a whole number", "'4'"), RequestError),
    Call(generate, {"rooms": 4, "types": {"hall": "2"}}, ("type hall: a count is a", "'2'"), RequestError),
    Call(generate, {"rooms": 4, "grammar": "famly"}, ("did you mean family?",), GrammarError),
    Call(generate, {"rooms": 4, "keep": HOUSE}, ("no room to keep", "only("), RequestError),
    Call(HOUSE.only, {"R0": 1}, ("R0",)),
    Call(HouseVectorEnv, {"preset": "papers"}, ("no preset papers: did you mean paper?",), ValueError),
    Call(HouseVectorEnv, {"backend": "gird"}, ("no backend gird: did you mean grid?",), ValueError),
    Call(HouseVectorEnv, {"targets": "second"}, ("no task second: did you mean secondary?",), ValueError),
    Call(
        HouseVectorEnv,
        {"targets": {"task": "rech", "room": "hall"}},
        ("no task rech: did you mean reach?",),
        ValueError,
    ),
    Call(HouseVectorEnv, {"device": "gpu"}, ("there is no device gpu", "cpu, cuda"), ValueError),
    # files
    Call(load, {"path": "housse.jsonl"}, ("did you mean houses.jsonl?",), HouseFileError),
    Call(save, {"houses": [HOUSE], "path": "x.txt"}, (".txt is not supported",), RequestError),
    Call(save, {"houses": [], "path": "x.jsonl"}, ("no house to write",), RequestError),
    Call(checkpoint.load, {"path": "dqn"}, ("is a preset of train",), CheckpointError),
)
