"""Opens the knowledge of a task on a robot."""

from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.knowledge.binding import KnowledgeBinding
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.journal import Journal
from kurt2rt.perception.definition import load_situation
from kurt2rt.tasks.settings import TaskSettings


def open_knowledge(path: Path, settings: RobotSettings, task: TaskSettings) -> Journal:
    """The journal at `path`, made when there is none, with its folder.

    Raises KnowledgeError for one that does not belong here, or where none can be made.
    """
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    binding = KnowledgeBinding(definition.hash(sensors), definition.names, task.name, settings.name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise KnowledgeError(f"{path.parent}: cannot be made ({error}); give a file in another folder") from error
    return Journal.open(path, binding)
