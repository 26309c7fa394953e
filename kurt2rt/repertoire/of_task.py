"""Builds the repertoire of a task, with the actions in it that were taught themselves."""

from pathlib import Path

from behaviors.behaviour import Behaviour
from behaviors.repertoire import load_repertoire
from behaviors.repertoire_settings import TaughtAction
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from kurt2rt.knowledge.error import KnowledgeError
from kurt2rt.knowledge.opening import read_lessons
from kurt2rt.layers.basic_level import BasicLevel
from kurt2rt.layers.wanted import Wanted
from kurt2rt.perception.definition import load_situation
from kurt2rt.perception.perception import Perception
from kurt2rt.perception.weights import weights_of
from kurt2rt.reinforcement.choice import Choice
from kurt2rt.repertoire.taught_system import TaughtSystem
from kurt2rt.rla.rla import TeachingEvent
from kurt2rt.rla.rla_system import RlaSystem
from kurt2rt.tasks.settings import TaskSettings, load_task


def repertoire_of(task: TaskSettings, robot: RobotSettings) -> dict[str, Behaviour]:
    """The actions that RLAs of a task may have, each an instance of its own. Raises SettingsError."""
    return _Building(robot, ()).load(task.repertoire)


class _Building:
    """Builds taught actions; those have repertoires of their own, with taught actions again."""

    def __init__(self, robot: RobotSettings, inside: tuple[Path, ...]) -> None:
        """`inside`: files of the repertoires that this one is a part of, the outermost first."""
        self._robot = robot
        self._inside = inside

    def load(self, name_or_path: str) -> dict[str, Behaviour]:
        return load_repertoire(name_or_path, self._robot, self._build)

    def _build(self, action: TaughtAction, repertoire: Path) -> Behaviour:
        here = repertoire.resolve()
        if here in self._inside:
            way = " -> ".join(path.name for path in (*self._inside, here))
            raise SettingsError(f"a repertoire cannot be a part of itself: {way}; give that task another repertoire")
        task = load_task(action.task)
        wanted = Wanted(task.behaviours)
        wanted.pursue(action.behaviour)
        inner = _Building(self._robot, (*self._inside, here)).load(task.repertoire)
        return _taught_system(task, self._robot, _lessons(action, here.parent, self._robot, task), inner, wanted)


def _lessons(action: TaughtAction, folder: Path, robot: RobotSettings, task: TaskSettings) -> list[TeachingEvent]:
    path = folder / Path(action.knowledge).expanduser()
    if not path.exists():
        raise SettingsError(
            f"{path}: there is no such file; teach the task {task.name} first, or give the path of what was taught"
        )
    try:
        return read_lessons(path, robot, task, beside_its_writer=True)
    except KnowledgeError as error:
        raise SettingsError(str(error)) from error


def _taught_system(
    task: TaskSettings,
    robot: RobotSettings,
    lessons: list[TeachingEvent],
    repertoire: dict[str, Behaviour],
    wanted: Wanted,
) -> TaughtSystem:
    sensors, period_s = robot.infrared.names, robot.can.cycle_s
    definition = load_situation(task.situation, sensors)
    learning = task.learning
    changed = ((each.features, each.weight) for each in learning.weights)
    weights = weights_of(definition, changed, learning.past_weight, task.name)
    system = RlaSystem(definition.dimensions, learning.radius, weights)
    system.apply_all(lessons)
    # Nothing is learnt here: among equals the newest answers, which was tried because those before it had sunk.
    settings = task.reinforcement
    choice = Choice(lambda _: 0.0, epsilon=0.0, hold_ticks=round(settings.hold_s / period_s), seed=settings.seed)
    level = BasicLevel(system, repertoire, round(learning.minimum_action_s / period_s), wanted, choice)
    perception = Perception(definition, sensors)
    return TaughtSystem(perception, level, (perception, level))
