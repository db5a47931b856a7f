"""A task has a name in words, in whichever form it is written; no page shows its JSON."""

import json

import pytest

from vitruvius.sim.tasks.words import in_words

NAMES = {
    "main": "targets in the main room",
    "secondary": "targets in secondary rooms",
    "mixed": "targets in all rooms",
    "all": "targets in all rooms",
    "habit": "targets in habitual places",
    "paper-secondary": "targets in secondary rooms, paper's",
    '{"task": "object", "piece": "bed"}': "find a bed",
    '{"task":"object","piece":"coffeeTable"}': "find a coffee table",
    '{"task": "object", "piece": "armchair"}': "find an armchair",
    '{"task": "reach", "room": "kitchen"}': "reach a kitchen",
    '{"rooms": ["bedroom"]}': "targets in rooms of type bedroom",
    '{"rooms": ["bedroom", "study", "wc"]}': "targets in rooms of type bedroom, study or wc",
    '{"task": "collect", "main": false}': "targets in secondary rooms",
    '{"task": "habit", "share": 0.8, "seed": 2}': "targets in habitual places, share 0.8, seed 2",
    '{"points": [[2.5, 3.0]]}': "targets at 1 given place",
    '{"task": "main", "terms": "gone:Away"}': "targets in the main room, terms away",
    '{"task": "vitruvius.sim.tasks.tasks:Reach", "room": "hall"}': "task reach, room hall",
    '{"task": "tests.sim.tasks.test_words:Largest", "share": 2}': "task largest, share 2",
    '{"task": "reach", "room": "wc", "terms": {"targets": 2}}': "reach a wc, targets 2",
    "visit": "visit all rooms",
    '{"task": "visit", "terms": {"types": ["wc", "hall"], "step": -1}}': (
        "visit rooms of type wc and hall, step -1"
    ),
    '{"task": "all", "terms": {"class": "visit", "most": 9}}': "targets in all rooms, terms visit, most 9",
    "battery": "targets in all rooms, terms battery",
    "of another program": "of another program",
    '{"task": "gone:Away"}': "task away",
}


class Largest:
    """A user's own task."""

    ends_on_pick_up = False

    def __init__(self, share: int) -> None:
        """Take an argument."""

    def spaces(self, house) -> list:
        """Return no rectangle."""
        return []


@pytest.mark.parametrize(("targets", "words"), NAMES.items())
def test_a_task_has_a_name_in_words(targets: str, words: str) -> None:
    assert in_words(targets) == words
    if targets.startswith("{"):
        assert in_words(json.loads(targets)) == words
