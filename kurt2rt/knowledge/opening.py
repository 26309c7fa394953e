"""Opens the knowledge of a task on a robot."""

import math
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.knowledge.binding import KnowledgeBinding, require_same
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.fold import fold_journal
from kurt2rt.knowledge.journal import Journal
from kurt2rt.perception.definition import load_situation
from kurt2rt.rla.rla import TeachingEvent
from kurt2rt.rla.statistics import StatisticsCounter
from kurt2rt.tasks.settings import TaskSettings


def open_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> Journal:
    """The journal at `path`, made when there is none, with its folder.

    Raises KnowledgeError for one that does not belong here, or where none can be made.
    """
    binding = _binding(settings, task)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise KnowledgeError(f"{path.parent}: cannot be made ({error}); give a file in another folder") from error
    return Journal.open(path, binding)


def go_on_teaching(
    path: Path, settings: RobotSettings, task: TaskSettings
) -> tuple[Journal, list[TeachingEvent], StatisticsCounter]:
    """The journal at `path`, what it holds already, and its counts to count on from. Raises as `open_knowledge`."""
    journal = open_knowledge(path, settings, task)
    try:
        fold_journal(journal, radius=math.inf)  # one that does not fold is refused, with file and row
        events, saved = journal.events(), journal.statistics()
    except BaseException:
        journal.close()
        raise
    return journal, events, StatisticsCounter(dict(saved.uses), dict(saved.transitions))


def read_lessons(path: Path, settings: RobotSettings, task: TaskSettings) -> list[TeachingEvent]:
    """All teaching events of the file at `path`, also while a robot writes it. Raises KnowledgeError."""
    with Journal.read_only(path) as journal:
        require_same(journal.binding, _binding(settings, task), path)
        fold_journal(journal, radius=math.inf)
        return journal.events()


def _binding(settings: RobotSettings, task: TaskSettings) -> KnowledgeBinding:
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    return KnowledgeBinding(definition.hash(sensors), definition.names, task.name, settings.name)
