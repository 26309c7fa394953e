"""Delays of teachers in a knowledge file: all of them, and only those that have changed are written."""

from pathlib import Path

from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.statistics_tables import changes
from tests.knowledge.lessons import BINDING

SAVED = Statistics(answer_delays={"Ann": (120, 80, 80, 300), "Ben": (0,)})


def test_statistics_delays_are_read_as_saved(path: Path) -> None:
    with Journal.open(path, BINDING) as journal:
        journal.checkpoint(Statistics(answer_delays={"Ann": (1, 2, 3, 4, 5), "Cid": (7,)}))
        journal.checkpoint(SAVED)
    with Journal.read_only(path) as journal:
        assert journal.statistics() == SAVED


def test_checkpoint_only_changed_delays_are_written() -> None:
    (written,) = changes(SAVED, Statistics(answer_delays={"Ann": (120, 80, 80, 300, 90), "Ben": (0,)}))
    assert written.rows == [("Ann", 4, 90)]
    assert changes(SAVED, SAVED) == []
