"""Expectations in a knowledge file: to the last bit, and only those that have changed are written."""

from pathlib import Path

import numpy as np

from kurt2rt.core.rla.statistics import Expectation, Statistics, pack
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.statistics_tables import changes
from tests.knowledge.lessons import BINDING

MEAN = np.array([1 / 3, -0.0, 5e-324, 1e150])


def expectation(count: int = 7) -> Expectation:
    return Expectation("create-1", count, 12.5, pack(MEAN), pack(MEAN * MEAN))


def test_statistics_expectations_are_read_as_saved(path: Path) -> None:
    saved = Statistics(expectations={1: expectation(), 7: expectation(8)})
    with Journal.open(path, BINDING) as journal:
        journal.checkpoint(saved)
    with Journal.read_only(path) as journal:
        assert journal.statistics() == saved
        assert journal.statistics().expectations[1].mean.tolist() == MEAN.tolist()


def test_checkpoint_only_changed_expectations_are_written() -> None:
    before = Statistics(expectations={1: expectation(), 2: expectation(), 3: expectation()})
    kept = before.expectations[1]
    after = Statistics(expectations={1: kept, 2: expectation(8)})
    gone, written = changes(before, after)
    assert gone.rows == [(3,)]
    assert [row[:3] for row in written.rows] == [(2, "create-1", 8)]
    assert changes(after, after) == []
