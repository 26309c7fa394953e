"""From the journal to the RLA system that it is the history of."""

from collections.abc import Container, Iterable

from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.rla.rla import BASIC, RlaCreated, SituationNamed
from kurt2rt.core.rla.rla_system import EventFault, InvalidEventError, RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError


def fold_journal(journal: Journal, radius: float) -> RlaSystem:
    """The RLA system that all lessons together make. Raises KnowledgeError that names file and row of an unfit one."""
    return fold_entries(journal, journal.entries(), radius)


def fold_entries(journal: Journal, entries: Iterable[StoredEntry], radius: float) -> RlaSystem:
    """The RLA system that entries read from the journal make, all its levels with that radius. Raises as above."""
    binding = journal.binding
    others = {level: Space(len(features.feature_names), radius) for level, features in binding.levels.items()}
    system = RlaSystem(len(binding.feature_names), radius, others=others)
    for entry in entries:
        try:
            if isinstance(entry.event, RlaCreated):
                _require_level(entry.event.rla.title, entry.event.rla.level, others)
            if isinstance(entry.event, SituationNamed):
                _require_level(f"the situation {entry.event.name!r}", entry.event.level, others)
            system.apply(entry.event)
        except InvalidEventError as error:
            raise KnowledgeError(
                f"row {entry.sequence}: does not fit the lessons before it: {event_error_text(error)}",
                where=journal.path,
                do="keep the file, and go on with a backup copy",
            ) from error
    return system


def check_knowledge(journal: Journal) -> list[str]:
    """Everything that would keep a robot from using the file, one line each: damage, and lessons that do not fit."""
    problems = journal.check()
    if problems:
        return problems
    try:
        fold_journal(journal, radius=0.0)
    except KnowledgeError as error:
        return [str(error)]
    return []


def _require_level(what: str, level: str, levels: Container[str]) -> None:
    if level != BASIC and level not in levels:
        raise InvalidEventError(
            EventFault.NO_LEVEL, f"{what} is of the level {level!r}, of which the file does not name the features"
        )
