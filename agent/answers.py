"""What the commands print with ``--json``, by name, and ``vitruvius schema``: see ``logic.answers``."""

import json
import pkgutil
from dataclasses import dataclass
from typing import Any

import msgspec

from logic.answers import FORMAT, Failure

ANSWERS = {
    "generate": "logic.answers:Generated",
    "check": "logic.answers:Checked",
    "draw": "logic.answers:Drawn",
    "convert": "logic.answers:Written",
    "lint": "logic.answers:Linted",
    "explain": "logic.answers:Explained",
    "info": "agent.info.commands:About",
    "train": "agent.answers:Trained",
    "evaluate": "agent.evaluation.scores:ScoreFile",
    "record": "logic.answers:Written",
    "export": "logic.answers:Written",
    "import-keras": "logic.answers:Written",
}
"""Where the type of a command's answer is, ``module:Class``."""


class Trained(msgspec.Struct, frozen=True):
    """Of ``train``: the checkpoint, and the last report of the run (``agent.learner.Progress``)."""

    agent: str
    steps: int
    seconds: float
    targets: float
    """Picked up per 1500 steps while learning."""
    simulator: float
    """Steps a second of the simulator alone; ``learner`` of all else."""
    learner: float


def schema() -> dict[str, Any]:
    """The JSON Schema of what any command prints with ``--json``: for each an object with its answer's type,
    or with an error.
    """
    kinds = {name: pkgutil.resolve_name(place) for name, place in ANSWERS.items()}
    pattern = "#/$defs/{name}"
    references, parts = msgspec.json.schema_components([*kinds.values(), Failure], ref_template=pattern)
    *answers, failure = references
    common = {"format": {"const": FORMAT}, "exit_code": {"type": "integer"}}
    keys = ["format", "command", "exit_code", "answer", "error"]
    found = [
        {
            "properties": {**common, "command": {"const": name}, "answer": answer, "error": {"type": "null"}},
            "required": keys,
            "additionalProperties": False,
        }
        for name, answer in zip(kinds, answers, strict=True)
    ]
    failed = {"command": {"type": "string"}, "answer": {"type": "null"}, "error": failure}
    found.append({"properties": common | failed, "required": keys, "additionalProperties": False})
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "What vitruvius prints with --json",
        "type": "object",
        "oneOf": found,
        "$defs": parts,
    }
    return json.loads(json.dumps(schema))


@dataclass(frozen=True)
class Schema:
    """Print the JSON Schema of a house, docs/house.schema.json, or of what commands print with --json."""

    answers: bool = False
    """Of what commands print with --json: docs/answers.schema.json."""

    def run(self) -> int:
        """Print it, indented."""
        from logic.records import schema as of_house

        print(json.dumps(schema() if self.answers else of_house(), indent=2))
        return 0
