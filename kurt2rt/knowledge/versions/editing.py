"""Edits of a knowledge file that no robot runs on: events from outside, with the values after them."""

import math
import os
import uuid
from collections.abc import Sequence
from pathlib import Path

from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, TaughtValues
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import Origin, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.journal_file import require_no_writer


def open_for_editing(path: Path) -> Journal:
    """Open an existing file for writing, whatever its task. Raises KnowledgeError, also while a robot runs on it."""
    with Journal.read_only(path) as journal:
        binding = journal.binding
    return Journal.open(path, binding)


def require_no_robot(path: Path) -> None:
    """Raise KnowledgeError if a robot runs on the file; call it before a user waits for a long preparation."""
    require_no_writer(Path(os.path.realpath(path)))


def new_origin(kind: str, teacher: str) -> Origin:
    """Return the origin of an undo or redo that a user makes in a file, while no robot runs on it.

    Its tick is 0, its phase that of corrections. `kind`: first part of the new command id.
    """
    return Origin(f"{kind}-{uuid.uuid4().hex}", teacher, Phase.CORRECTIONS, tick=0)


def append_with_values(journal: Journal, entries: Sequence[JournalEntry]) -> None:
    """Append events that fit, and the values after them, in one transaction.

    Raises:
        KnowledgeError: the file cannot be read, or the disk does not take the rows.
        InvalidEventError: an event does not fit.
    """
    new, dimensions = [entry.event for entry in entries], len(journal.binding.feature_names)
    after = statistics_after(journal.events(), new, journal.statistics(), dimensions)
    journal.append(entries, after)


def statistics_after(
    before: Sequence[TeachingEvent], new: Sequence[TeachingEvent], saved: Statistics, dimensions: int
) -> Statistics:
    """Return the statistics after `new` events, computed as a robot does.

    Args:
        before: events that `saved` is about.
        new: events that follow them.
        saved: statistics after `before`.
        dimensions: number of features of the basic level.

    Raises:
        InvalidEventError: an event does not fit those before it.
    """
    if VALUES_INCLUDE not in saved.numbers:
        return saved  # no robot has saved values yet: the first one computes them from the credits
    first_value = saved.numbers.get(FIRST_VALUE, TaughtValues().first_value)
    settings = ReinforcementSettings(with_teacher=TaughtValues(first_value=first_value, highest_value=None))
    account = Reinforcement(RlaSystem(dimensions, math.inf), DecisionHistory(dimensions), settings, period_s=0.01)
    account.restore([*before, *new], saved)
    return account.snapshot()
