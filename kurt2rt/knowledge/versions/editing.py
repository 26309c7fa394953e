"""Changes a knowledge file that no robot runs on: opened again, and written together with what its RLAs are worth."""

import math
import os
import uuid
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.settings import ReinforcementSettings, TaughtValues
from kurt2rt.core.rla.rla import Origin, Phase, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import FIRST_VALUE, VALUES_INCLUDE, Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.journal_file import require_no_writer


def open_for_editing(path: Path) -> Journal:
    """To write in a file that is there, whatever task it belongs to. Raises KnowledgeError, also while a robot runs."""
    with Journal.read_only(path) as look:
        binding = look.binding
    return Journal.open(path, binding)


def require_no_robot(path: Path) -> None:
    """Raises KnowledgeError while a robot runs on the file, before a user waits for what comes first."""
    require_no_writer(Path(os.path.realpath(path)))


def new_origin(what: str, teacher: str) -> Origin:
    """Of a change from outside: no robot runs, so there is no tick; to mend what was taught is a correction."""
    return Origin(f"{what}-{uuid.uuid4().hex}", teacher, Phase.CORRECTIONS, tick=0)


def write(journal: Journal, entries: Sequence[JournalEntry], saved: Statistics | None = None) -> None:
    """Append events that fit, and what values become by them, in one transaction. Raises KnowledgeError.

    `saved`: the statistics to go on from; those of the file unless given.
    """
    before, saved = journal.events(), saved or journal.statistics()
    after = statistics_after(before, [entry.event for entry in entries], saved, len(journal.binding.feature_names))
    journal.append_and_checkpoint(entries, after)


def statistics_after(
    before: Sequence[TeachingEvent], new: Sequence[TeachingEvent], saved: Statistics, dimensions: int
) -> Statistics:
    """What the statistics become, by the same account as a robot keeps."""
    if not saved.values and VALUES_INCLUDE not in saved.numbers:
        return saved  # credits of another rule
    first_value = saved.numbers.get(FIRST_VALUE, TaughtValues().first_value)
    settings = ReinforcementSettings(with_teacher=TaughtValues(first_value=first_value, highest_value=None))
    account = Reinforcement(RlaSystem(dimensions, math.inf), DecisionHistory(dimensions), settings, period_s=0.01)
    # An earlier kurt2rt did not say how many rows the values include: all that there were.
    numbers = {VALUES_INCLUDE: float(len(before)), **saved.numbers}
    account.restore([*before, *new], replace(saved, numbers=numbers))
    return account.snapshot()
