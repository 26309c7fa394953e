"""People who taught in a knowledge file."""

from pathlib import Path

from kurt2rt.core.rla.programs import PROGRAMS
from kurt2rt.knowledge.journal.journal import Journal


def read_teachers(path: Path) -> tuple[str, ...]:
    """Return the names of the people who taught in the file at `path`, the first one first. Raises KnowledgeError."""
    with Journal.read_only(path) as journal:
        names = dict.fromkeys(event.origin.teacher for event in journal.events())
    return tuple(name for name in names if name not in PROGRAMS)
