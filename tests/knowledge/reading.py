"""Knowledge files as a test looks at them; each is checked on the way."""

import math
from pathlib import Path

from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.knowledge.journal.fold import check_knowledge, fold_journal
from kurt2rt.knowledge.journal.journal import Journal


def events_in(path: Path) -> list[TeachingEvent]:
    """Return the events of a knowledge file."""
    with Journal.read_only(path) as journal:
        assert check_knowledge(journal) == []
        return list(journal.events())


def folded(path: Path) -> RlaSystem:
    """Return the RLAs that the events of a knowledge file make."""
    with Journal.read_only(path) as journal:
        assert check_knowledge(journal) == []
        return fold_journal(journal, radius=math.inf)
