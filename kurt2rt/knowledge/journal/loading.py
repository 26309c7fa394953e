"""Loading of the knowledge of a task on a robot."""

import math
from dataclasses import dataclass
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import critic_of
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, MID, PROGRAMS
from kurt2rt.core.rla.statistics import Statistics, StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import fold_entries, read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_folder


@dataclass(frozen=True, slots=True)
class OpenedKnowledge:
    """Journal that is open for teaching, with the lessons and statistics that it holds already."""

    journal: Journal
    entries: tuple[JournalEntry, ...]
    """All rows, in the order of writing."""
    counter: StatisticsCounter
    """Goes on from the counts of the last checkpoint."""
    saved: Statistics
    """All of the last checkpoint."""

    @property
    def events(self) -> list[TeachingEvent]:
        """Teaching events of all rows, in the order of writing."""
        return [entry.event for entry in self.entries]

    @property
    def stamps(self) -> dict[str, str]:
        """Stamp of each row (UTC, ISO 8601) by command id."""
        return {entry.event.origin.command_id: entry.stamped_at for entry in self.entries}


def open_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> Journal:
    """Open the journal at `path`, or make one there, with its folder.

    Raises:
        KnowledgeError: the journal belongs to other features or another task, or none can be made.
        SettingsError: a file that the task uses cannot be read.
    """
    binding = binding_for(settings, task)
    try:
        make_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(KnowledgeCode.FOLDER_NOT_MADE, where=path.parent, error=error) from error
    return Journal.open(path, binding)


def open_for_teaching(path: Path, settings: RobotSettings, task: TaskSettings) -> OpenedKnowledge:
    """Open the journal at `path`, or make one there, with its lessons and counts.

    Raises:
        KnowledgeError: the journal is damaged, in use, or of other features or another task, or none can be made.
        SettingsError: a file that the task uses cannot be read.
    """
    journal = open_knowledge(path, settings, task)
    try:
        _require_integrity(journal)
        entries, saved = tuple(journal.entries()), journal.statistics()
        fold_entries(journal, entries, radius=math.inf)  # refuses lessons that do not fold, with file and row
    except BaseException:
        journal.close()
        raise
    counter = StatisticsCounter(dict(saved.uses), dict(saved.transitions))
    return OpenedKnowledge(journal, entries, counter, saved)


def _require_integrity(journal: Journal) -> None:
    errors = journal.integrity_errors()
    if errors:  # a page in another's place hides lessons, which no later check notices
        raise errors[0]


def copy_knowledge(source: Path, path: Path) -> None:
    """Copy a knowledge file to `path`, where no file may be, also while another process writes it.

    Raises KnowledgeError.
    """
    with Journal.read_only(source) as journal:
        path.write_bytes(journal.image())


def read_lessons(
    path: Path, settings: RobotSettings, task: TaskSettings, *, in_writer_process: bool = False
) -> list[TeachingEvent]:
    """Return all teaching events of the file at `path`, also while a robot writes it.

    Args:
        path: of the knowledge file.
        settings: of the robot.
        task: of the robot.
        in_writer_process: this very process may be the one that writes it.

    Raises:
        KnowledgeError: the file cannot be read, or belongs to other features or another task.
        SettingsError: a file that the task uses cannot be read.
    """
    with Journal.in_writer_process(path) if in_writer_process else Journal.read_only(path) as journal:
        return _read_fitting(journal, path, settings, task)[0]


def read_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> tuple[list[TeachingEvent], Statistics]:
    """Return teaching events and statistics of the file at `path`, both of one moment.

    Raises:
        KnowledgeError: the file cannot be read, or belongs to other features or another task.
        SettingsError: a file that the task uses cannot be read.
    """
    with Journal.read_only(path) as journal:
        return _read_fitting(journal, path, settings, task)


def read_teachers(path: Path) -> tuple[str, ...]:
    """Return the names of the people who taught in the file at `path`, the first one first. Raises KnowledgeError."""
    with Journal.read_only(path) as journal:
        names = dict.fromkeys(event.origin.teacher for event in journal.events())
    return tuple(name for name in names if name not in PROGRAMS)


def _read_fitting(
    journal: Journal, path: Path, settings: RobotSettings, task: TaskSettings
) -> tuple[list[TeachingEvent], Statistics]:
    require_compatible(journal.binding, binding_for(settings, task), path, journal.has_lessons_at)
    entries, _, statistics = read_content(journal)
    return [entry.event for entry in entries], statistics


def binding_for(settings: RobotSettings, task: TaskSettings) -> KnowledgeBinding:
    """Return the features and the task that knowledge of a task on a robot is bound to.

    Raises config.settings.SettingsError if a file that the task uses cannot be read.
    """
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    levels = {CRITIC: critic_of(task.critic, settings).level_features}
    if task.mid is not None:
        levels[MID] = load_mid_level(task.mid).level_features
    fingerprint = definition.hash(sensors, settings.kind)
    return KnowledgeBinding(fingerprint, definition.names, task.system_name, settings.name, levels)
