"""Manifest of a package, and checks of the content that it describes."""

from collections.abc import Iterable, Mapping
from datetime import datetime
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError

from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.exchange.attachments import KNOWLEDGE, STATISTICS
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.event_codec import StoredText

_BYTES = np.dtype("<f8").itemsize


class _Features(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True)
    hash: StoredText
    names: list[StoredText]

    @property
    def of_level(self) -> LevelFeatures:
        return LevelFeatures(self.hash, tuple(self.names))


class Manifest(BaseModel):
    """Fields of a manifest that an import needs; a manifest may have more."""

    model_config = ConfigDict(strict=True, frozen=True)
    task: StoredText
    """Name of the task whose settings are in the file."""
    exported_at: StoredText
    """UTC, ISO 8601."""
    system: StoredText
    robot: StoredText
    features: _Features
    levels: dict[StoredText, _Features]

    @property
    def binding(self) -> KnowledgeBinding:
        """Features and task that the knowledge in the package is bound to."""
        basic = self.features.of_level
        levels = {level: features.of_level for level, features in self.levels.items()}
        return KnowledgeBinding(basic.feature_hash, basic.feature_names, self.system, self.robot, levels)


def read_manifest(content: Mapping[str, Any]) -> Manifest:
    """Return the manifest in its JSON content. Raises ValueError, which names the field."""
    try:
        return Manifest.model_validate(content)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        raise ValueError(f"its manifest: {'.'.join(map(str, problem['loc']))}: {problem['msg']}") from error


def require_times(lessons: Iterable[JournalEntry]) -> None:
    """Raise ValueError unless each lesson of a package has a stamp with a time zone."""
    for number, lesson in enumerate(lessons, start=1):
        try:
            whole = datetime.fromisoformat(lesson.stamped_at).tzinfo is not None
        except ValueError:
            whole = False
        if not whole:
            raise ValueError(f"{KNOWLEDGE}: line {number}: its stamp {lesson.stamped_at[:40]!r} is not a time")


def require_expectations(statistics: Statistics, lessons: Iterable[JournalEntry], binding: KnowledgeBinding) -> None:
    """Raise ValueError unless each expectation has one finite number for each feature of its RLA's level."""
    events = (lesson.event for lesson in lessons)
    levels = {event.rla.rla_id: event.rla.level for event in events if isinstance(event, RlaCreated)}
    for rla_id, expectation in statistics.expectations.items():
        level = levels.get(rla_id, BASIC)
        features = binding.levels.get(level)
        names = binding.feature_names if level == BASIC or features is None else features.feature_names
        for packed in (expectation.packed_mean, expectation.packed_squares):
            if len(packed) != len(names) * _BYTES or not np.isfinite(np.frombuffer(packed, dtype="<f8")).all():
                raise ValueError(f"{STATISTICS}: the expectation of RLA {rla_id} is not {len(names)} finite numbers")
