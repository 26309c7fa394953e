"""Opens the knowledge of a task on a robot."""

import math
from dataclasses import dataclass
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.rla import CRITIC, MID, TeachingEvent
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.journal.binding import KnowledgeBinding, require_compatible
from kurt2rt.knowledge.journal.entry import StoredEntry
from kurt2rt.knowledge.journal.fold import fold_entries
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_folder


@dataclass(frozen=True, slots=True)
class OpenedKnowledge:
    """A journal to teach on with, and what it holds already."""

    journal: Journal
    entries: tuple[StoredEntry, ...]
    """In the order of writing."""
    counter: StatisticsCounter
    """Goes on from the counts of the last checkpoint."""
    saved: Statistics
    """All of the last checkpoint."""

    @property
    def events(self) -> list[TeachingEvent]:
        """What the RLA system is the fold of."""
        return [entry.event for entry in self.entries]

    @property
    def stamps(self) -> dict[str, str]:
        """When each command was written, UTC, ISO 8601, by command id."""
        return {entry.event.origin.command_id: entry.stamped_at for entry in self.entries}


def open_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> Journal:
    """The journal at `path`, made when there is none, with its folder.

    Raises KnowledgeError for one that does not belong here, or where none can be made.
    """
    binding = binding_for(settings, task)
    try:
        make_folder(path.parent)
    except OSError as error:
        raise KnowledgeError(
            f"cannot be made ({error})", where=path.parent, do="give a file in another folder"
        ) from error
    return Journal.open(path, binding)


def open_for_teaching(path: Path, settings: RobotSettings, task: TaskSettings) -> OpenedKnowledge:
    """The journal at `path`, what it holds already, and its counts to count on from. Raises as `open_knowledge`."""
    journal = open_knowledge(path, settings, task)
    try:
        _require_sound(journal)
        entries, saved = tuple(journal.entries()), journal.statistics()
        fold_entries(journal, entries, radius=math.inf)  # one that does not fold is refused, with file and row
    except BaseException:
        journal.close()
        raise
    counter = StatisticsCounter(dict(saved.uses), dict(saved.transitions))
    return OpenedKnowledge(journal, entries, counter, saved)


def _require_sound(journal: Journal) -> None:
    integrity_errors = journal.integrity_errors()
    if integrity_errors:  # a page that stands in another's place hides lessons, and nothing else would tell
        first = integrity_errors[0].removeprefix(f"{journal.path}: ")
        raise KnowledgeError(
            f"the file is damaged ({first})", where=journal.path, do="keep it, and go on with a backup copy"
        )


def read_lessons(
    path: Path, settings: RobotSettings, task: TaskSettings, *, in_writer_process: bool = False
) -> list[TeachingEvent]:
    """All teaching events of the file at `path`, also while a robot writes it. Raises KnowledgeError.

    `in_writer_process`: it may be this very process that writes it.
    """
    with Journal.in_writer_process(path) if in_writer_process else Journal.read_only(path) as journal:
        return _read_fitting(journal, path, settings, task)[0]


def read_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> tuple[list[TeachingEvent], Statistics]:
    """The same with the statistics of the same moment. Raises KnowledgeError."""
    with Journal.read_only(path) as journal:
        return _read_fitting(journal, path, settings, task)


def _read_fitting(
    journal: Journal, path: Path, settings: RobotSettings, task: TaskSettings
) -> tuple[list[TeachingEvent], Statistics]:
    require_compatible(journal.binding, binding_for(settings, task), path, journal.has_lessons_at)
    entries, statistics = journal.read_all()
    fold_entries(journal, entries, radius=math.inf)
    return [entry.event for entry in entries], statistics


def binding_for(settings: RobotSettings, task: TaskSettings) -> KnowledgeBinding:
    """What knowledge of a task on a robot is bound to. Raises hal.settings.SettingsError."""
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    levels = {CRITIC: load_critic(task.critic).level_features}
    if task.mid is not None:
        levels[MID] = load_mid_level(task.mid).level_features
    return KnowledgeBinding(definition.hash(sensors), definition.names, task.system_name, settings.name, levels)
