"""Repertoire of a task, with the actions in it that were taught."""

from pathlib import Path

from behaviors.behaviour import Behaviour
from behaviors.repertoire import load_repertoire
from behaviors.repertoire_settings import TaskAction, TaughtAction
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.settings_files import find_beside
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.mid.place import PlaceSettings
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.outcome import CommandRefusedError
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.knowledge.taught_actions import build_taught_system


def load_task_repertoire(task: TaskSettings, robot: RobotSettings) -> dict[str, Behaviour]:
    """Return the actions that RLAs of a task may have, by name, each a new instance.

    Raises:
        SettingsError: the repertoire, or settings or knowledge that it names, cannot be loaded.
    """
    return _RepertoireLoader(robot, ()).load(task.repertoire)


class _RepertoireLoader:
    """Builder of taught actions, whose repertoires may contain taught actions again."""

    def __init__(self, robot: RobotSettings, inside: tuple[Path, ...]) -> None:
        """Prepare; `inside` are the files of the repertoires that this one is a part of, the outermost first."""
        self._robot = robot
        self._inside = inside

    def load(self, name_or_path: str) -> dict[str, Behaviour]:
        return load_repertoire(name_or_path, self._robot, self._build)

    def _build(self, action: TaughtAction | TaskAction, repertoire: Path) -> Behaviour:
        here = repertoire.resolve()
        if here in self._inside:
            chain = " -> ".join(path.name for path in (*self._inside, here))
            raise SettingsError(
                f"a repertoire cannot be a part of itself: {chain}", do="give that task another repertoire"
            )
        task = load_task(action.task)
        active, mid = ActiveBehaviour(task.behaviours), None
        if isinstance(action, TaughtAction):
            try:
                active.select(action.behaviour)
            except CommandRefusedError as error:
                raise ValueError(text_of(error.outcome)) from error
        elif task.mid is not None:
            mid = load_mid_level(task.mid)
            if isinstance(mid.situation, PlaceSettings):
                raise SettingsError(
                    f"the mid level of the task {task.name} goes by places, and an action does not know its place "
                    "at the start",
                    do="give a task whose mid level goes by a history",
                )
        elif len(task.behaviours) > 1:
            raise SettingsError(
                f"the task {task.name} has no mid level that selects one of {', '.join(task.behaviours)}",
                do="give one of them as an action of kind taught",
            )
        inner = _RepertoireLoader(self._robot, (*self._inside, here)).load(task.repertoire)
        lessons = _lessons(action, repertoire, self._robot, task)
        return build_taught_system(task, self._robot, lessons, inner, active, mid)


def _lessons(
    action: TaughtAction | TaskAction, repertoire: Path, robot: RobotSettings, task: TaskSettings
) -> list[TeachingEvent]:
    path = find_beside(repertoire.resolve(), action.knowledge)
    if not path.exists():
        raise SettingsError(
            "there is no such file",
            where=path,
            do=f"teach the task {task.name} first, or give the path of what was taught",
        )
    try:
        return read_lessons(path, robot, task, in_writer_process=True)
    except KnowledgeError as error:
        raise SettingsError(str(error)) from error
