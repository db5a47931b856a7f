"""Answers of the commands with ``--json``, by name, and ``vitruvius schema``: see ``houses.py``."""

import json
import pkgutil
from dataclasses import dataclass
from typing import Any

import msgspec

from vitruvius.answers.houses import FORMAT, Failure
from vitruvius.logic.errors import RequestError

ANSWERS = {
    "generate": "vitruvius.answers.houses:Generated",
    "check": "vitruvius.answers.houses:Checked",
    "draw": "vitruvius.answers.houses:Drawn",
    "convert": "vitruvius.answers.houses:Written",
    "lint": "vitruvius.answers.houses:Linted",
    "explain": "vitruvius.answers.houses:Explained",
    "info": "vitruvius.commands.info:About",
    "doctor": "vitruvius.commands.doctor:Findings",
    "train": "vitruvius.answers.agents:Trained",
    "evaluate": "vitruvius.agent.evaluation.scores:ScoreFile",
    "record": "vitruvius.answers.houses:Written",
    "export": "vitruvius.answers.houses:Written",
}
"""Type of each command's answer, as ``module:Class``."""


class Trained(msgspec.Struct, frozen=True):
    """Answer of ``train``: the checkpoint, and the last report (``agent.learning.learner.Progress``)."""

    agent: str
    steps: int
    seconds: float
    targets: float
    """Targets picked up per 1500 steps in training."""
    simulator: float
    """Steps per second of the simulator alone; ``learner`` has those of the rest."""
    learner: float
    held_out: float | None = None
    """Mean targets in an episode in held-out houses, in the best evaluation; null without evaluations."""


def schema() -> dict[str, Any]:
    """Return the JSON Schema of the output of any command with ``--json``.

    For each command it has an object with the type of its answer, or with an error.
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
    """Print the JSON Schema of a house, docs/house.schema.json, of a brief, or of what commands print."""

    answers: bool = False
    """Print the schema of what commands print with --json: docs/answers.schema.json."""

    brief: bool = False
    """Print the schema of a brief: docs/brief.schema.json."""

    def run(self) -> int:
        """Print the schema, indented."""
        from vitruvius.logic.house.records import schema as of_house
        from vitruvius.logic.request.brief import schema as of_brief

        kinds = {"answers": (self.answers, schema), "brief": (self.brief, of_brief)}
        asked = [made for wanted, made in kinds.values() if wanted]
        if len(asked) > 1:
            raise RequestError(
                f"one schema at a time: leave out {' or '.join(f'--{name}' for name in kinds)}"
            )
        print(json.dumps(asked[0]() if asked else of_house(), indent=2))
        return 0
