"""Opens the knowledge of a task on a robot."""

from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.knowledge.binding import KnowledgeBinding
from kurt2rt.knowledge.journal import Journal
from kurt2rt.perception.definition import load_situation
from kurt2rt.tasks.settings import TaskSettings


def open_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> Journal:
    """The journal at `path`, made when there is none. Raises KnowledgeError for one that does not belong here."""
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    binding = KnowledgeBinding(definition.hash(sensors), definition.names, task.name, settings.name)
    return Journal.open(path, binding)
