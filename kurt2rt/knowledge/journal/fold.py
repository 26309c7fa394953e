"""Fold of the journal: the RLA system that its lessons make."""

import math
from collections.abc import Container, Iterable

from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import EventFault, InvalidEventError, RlaCreated, SituationNamed
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError


def fold_journal(journal: Journal, radius: float) -> RlaSystem:
    """Return the RLA system that all lessons of a journal make.

    `radius`: R of all levels, dimensionless; 0.0 or infinity for a fold without matches.

    Raises:
        KnowledgeError: a row is damaged, or a lesson does not fit those before it; names file and row.
    """
    return fold_entries(journal, journal.entries(), radius)


def read_content(journal: Journal) -> tuple[list[JournalEntry], RlaSystem, Statistics]:
    """Return the lessons of a journal, the RLA system that they make, and the statistics, all of one moment.

    Raises:
        KnowledgeError: a row is damaged, or a lesson does not fit those before it; names file and row.
    """
    entries, statistics = journal.read_all()
    return entries, fold_entries(journal, entries, radius=math.inf), statistics


def fold_entries(journal: Journal, entries: Iterable[JournalEntry], radius: float) -> RlaSystem:
    """Return the RLA system that entries of the journal make, one after the other (fold, projection).

    Equal entries give an equal system with an equal hash; robot, replay, undo and merge all use this.

    Args:
        journal: gives features and levels.
        entries: from the first row on, without gaps.
        radius: R of all levels, dimensionless; 0.0 or infinity for a fold without matches.

    Raises:
        KnowledgeError: a lesson does not fit those before it; names file and row.
    """
    binding = journal.binding
    others = {level: Space(len(features.feature_names), radius) for level, features in binding.levels.items()}
    system = RlaSystem(len(binding.feature_names), radius, others=others)
    for sequence, entry in enumerate(entries, start=1):
        try:
            if isinstance(entry.event, RlaCreated):
                _require_level(entry.event.rla.title, entry.event.rla.level, others)
            if isinstance(entry.event, SituationNamed):
                _require_level(f"the situation {entry.event.name!r}", entry.event.level, others)
            system.apply(entry.event)
        except InvalidEventError as error:
            where = f"{journal.path}: row {sequence}"
            raise KnowledgeError(KnowledgeCode.LESSON_MISFIT, where=where, error=event_error_text(error)) from error
    return system


def check_knowledge(journal: Journal) -> list[KnowledgeError]:
    """Return everything that keeps a robot from using the file: damage, else the first lesson that does not fit."""
    errors = journal.check()
    if not errors:
        try:
            fold_journal(journal, radius=0.0)
        except KnowledgeError as error:
            return [error]
    return errors


def _require_level(title: str, level: str, levels: Container[str]) -> None:
    if level != BASIC and level not in levels:
        raise InvalidEventError.of(EventFault.NO_LEVEL, title=title, level=level)
