"""Lessons for the tests of this folder. Light to import: the killed children of test_kill.py start with it."""

import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from kurt2rt.core.rla.condition import LevelFeatures
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
    SessionBegun,
    SessionEnded,
    TeachingEvent,
)
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from kurt2rt.knowledge.journal.binding import KnowledgeBinding
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.journal import Journal

BINDING = KnowledgeBinding(
    feature_hash="0123456789abcdef",
    feature_names=("s1", "s2", "maximum front", "wheel speed left"),
    system="wall following",
    robot="kurt2",
)

CIRCUMSTANCES = LevelFeatures(feature_hash="fedcba", feature_names=("left_m", "speed_m_s", "bumped"))
WITH_CRITIC = replace(BINDING, levels={CRITIC: CIRCUMSTANCES})

STAMP = "2004-04-26T10:00:00.000+00:00"


def origin(command_id: str, tick: int = 100, phase: Phase = Phase.SUPERVISED) -> Origin:
    return Origin(command_id, "Hertha", phase, tick)


def created(rla_id: int, command_id: str | None = None, action: str = "forward") -> RlaCreated:
    condition = (rla_id / 3, 0.1 * rla_id, 80.0 + rla_id, -5.0)
    return RlaCreated(Rla(rla_id, condition, action, None, origin(command_id or f"create-{rla_id}", tick=rla_id)))


def appraisal(rla_id: int, condition: tuple[float, ...] = (0.4, 0.2, 0.0), action: str = "good") -> RlaCreated:
    """Return the creation of an RLA of the critic."""
    taught = origin(f"appraise-{rla_id}", rla_id, Phase.CRITIC)
    return RlaCreated(Rla(rla_id, condition, action, None, taught, level=CRITIC))


def replaced(rla_id: int, action: str, instead_of: str) -> ActionReplaced:
    return ActionReplaced(rla_id, action, instead_of, origin(f"replace-{rla_id}-{action}", 200, Phase.CORRECTIONS))


def deleted(rla_id: int) -> RlaDeleted:
    return RlaDeleted(rla_id, origin(f"delete-{rla_id}", 300, Phase.CORRECTIONS))


def rewarded(rla_id: int, value: int = 1, command_id: str | None = None) -> RlaRewarded:
    return RlaRewarded(rla_id, value, 390, origin(command_id or f"reward-{rla_id}", 400, Phase.REINFORCEMENT))


def withdrawn(rla_id: int, instead_of: str = "forward") -> ActionWithdrawn:
    return ActionWithdrawn(rla_id, instead_of, origin(f"withdraw-{rla_id}", 450, Phase.REINFORCEMENT))


def undone(lesson: str, teacher: str = "Joachim") -> LessonUndone:
    return LessonUndone(lesson, Origin(f"undo-{lesson}", teacher, Phase.CORRECTIONS, 500))


def session(lasted_ticks: int, name: str = "morning") -> tuple[SessionBegun, SessionEnded]:
    return SessionBegun(name, origin(f"begin-{name}", 0)), SessionEnded(lasted_ticks, origin(f"end-{name}", 600))


def entry(rla_id: int) -> JournalEntry:
    return JournalEntry(created(rla_id), STAMP)


def begun(path: Path, lessons: int = 3) -> Path:
    """Make a knowledge file with some lessons, closed; return its path."""
    append(path, *(created(number) for number in range(1, lessons + 1)))
    return path


def append(path: Path, *events: TeachingEvent, binding: KnowledgeBinding = BINDING, stamp: str = STAMP) -> None:
    """Append events to the knowledge file at `path`, which is made if it is missing."""
    with Journal.open(path, binding) as journal:
        journal.append([JournalEntry(event, stamp) for event in events])


def teach(path: Path, *events: TeachingEvent) -> None:
    """Append events to a knowledge file that is there, whatever its task."""
    with Journal.read_only(path) as journal:
        binding = journal.binding
    append(path, *events, binding=binding)


def tamper(path: Path, *statements: str) -> None:
    """Execute SQL statements on a knowledge file, as no kurt2rt does."""
    with closing(sqlite3.connect(path)) as connection, connection:
        for statement in statements:
            connection.execute(statement)
