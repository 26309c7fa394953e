"""Whether what an exported file holds is what a knowledge file may hold, beyond the types of its values."""

from collections.abc import Iterable
from datetime import datetime

import numpy as np

from kurt2rt.core.rla.rla import BASIC, RlaCreated
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.exchange.attachments import KNOWLEDGE, STATISTICS, KnownLesson
from kurt2rt.knowledge.journal.binding import KnowledgeBinding

_BYTES = np.dtype("<f8").itemsize


def require_times(lessons: Iterable[KnownLesson]) -> None:
    """Each lesson has a stamp with its time zone. Raises ValueError."""
    for number, lesson in enumerate(lessons, start=1):
        try:
            whole = datetime.fromisoformat(lesson.stamped_at).tzinfo is not None
        except ValueError:
            whole = False
        if not whole:
            raise ValueError(f"{KNOWLEDGE}: line {number}: its stamp {lesson.stamped_at[:40]!r} is no time")


def require_fitting(statistics: Statistics, lessons: Iterable[KnownLesson], binding: KnowledgeBinding) -> None:
    """Each expectation has one finite number for each feature of its RLA's level. Raises ValueError."""
    events = (lesson.event for lesson in lessons)
    levels = {event.rla.rla_id: event.rla.level for event in events if isinstance(event, RlaCreated)}
    for rla_id, expectation in statistics.expectations.items():
        level = levels.get(rla_id, BASIC)
        features = binding.levels.get(level)
        names = binding.feature_names if level == BASIC or features is None else features.feature_names
        for packed in (expectation.packed_mean, expectation.packed_squares):
            if len(packed) != len(names) * _BYTES or not np.isfinite(np.frombuffer(packed, dtype="<f8")).all():
                raise ValueError(f"{STATISTICS}: what is expected of RLA {rla_id} is not {len(names)} finite numbers")
