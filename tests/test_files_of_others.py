"""Readers of untrusted files, with contents that once failed and with random changes of valid contents."""

import random

import pytest

from benchmarks.reliability.random_changes import changed
from benchmarks.reliability.readers import CORPUS, READ, READERS, REFUSED, answer, begin

CHANGES = 25
"""Number of changes of a reader's contents; ``vitruvius bench fuzz`` tries more."""

SLOW = {"answer-sets": 2, "prolog": 0}
"""Smaller numbers of changes for slow readers."""

LARGEST = 300_000
"""Largest size of the whole corpus, in bytes."""


@pytest.mark.parametrize("name", READERS)
def test_a_content_is_read_or_refused_in_one_line(name, tmp_path):
    reader, contents, rng = READERS[name], begin(name), random.Random(name)
    made = (
        changed(rng.choice(contents), rng, reader.is_json, contents) for _ in range(SLOW.get(name, CHANGES))
    )
    for content in (*contents, *made):
        assert answer(reader, content, tmp_path) in (READ, REFUSED)


def test_the_corpus_is_small_and_each_reader_reads_some_of_it(tmp_path):
    assert sum(file.stat().st_size for file in CORPUS.rglob("*") if file.is_file()) < LARGEST
    unread = {
        "ifc",
        "other-plans",
    }  # IfcOpenShell is left out; the others are plans of no format that is read
    for name in READERS.keys() - unread - {"prolog", "answer-sets"}:
        assert any(answer(READERS[name], content, tmp_path) == READ for content in begin(name)), name
