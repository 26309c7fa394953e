"""Knowledge files of a few lessons, and repertoires of a few actions."""

from pathlib import Path

from behaviors.behaviour import Behaviour
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.loading import open_knowledge
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from tests.behaviors.helpers import ROBOT, SENSORS, sensed

STAMP = "2004-04-26T10:00:00.000+00:00"


def keep(path: Path, task: TaskSettings, *events: TeachingEvent) -> None:
    """Write a knowledge file with these lessons."""
    with open_knowledge(path, ROBOT, task) as journal:
        journal.append([JournalEntry(event, STAMP) for event in events])


def repertoire(folder: Path, *actions: str) -> dict[str, Behaviour]:
    """Return the behaviours of a repertoire with these actions, whose file is in `folder`."""
    return load_task_repertoire(with_repertoire(load_task("wall_following"), folder, *actions), ROBOT)


def with_repertoire(task: TaskSettings, folder: Path, *actions: str) -> TaskSettings:
    """Return the task with a repertoire of these actions, each a YAML mapping, in a file in `folder`."""
    path = folder / "repertoire.yaml"
    path.write_text("\n".join(["name: complete", "actions:", *(f"  - {{{action}}}" for action in actions)]))
    return task.model_copy(update={"repertoire": str(path)})


def condition_at(infrared_counts: tuple[int, ...]) -> Condition:
    """Return the basic situation of a robot switched on at these infra-red readings (counts)."""
    perception = Perception(load_situation("basic", SENSORS), SENSORS)
    return tuple(perception.perceive(sensed(infrared_counts), history_frozen=True).vector.tolist())
