"""Repertoire of a task, with the actions in it that were taught."""

from collections.abc import Iterable
from pathlib import Path

from behaviors.behaviour import Behaviour
from behaviors.repertoire import Repertoire, load_repertoire
from behaviors.repertoire_settings import TaskAction, TaughtAction
from config.settings import SettingsError
from config.settings_files import find_beside
from hal.robot_settings import RobotSettings
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.basic.taught_action import TaughtSystem
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.layer_stack import LayerStack
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.place import PlaceSettings
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.outcome import CommandRefusedError
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.perception.definition import feature_weights, load_situation
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.knowledge_error import KnowledgeError


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


def build_taught_system(
    task: TaskSettings,
    robot: RobotSettings,
    lessons: Iterable[TeachingEvent],
    repertoire: Repertoire,
    wanted: ActiveBehaviour,
    mid: MidSettings | None,
) -> TaughtSystem:
    """Return the system that `lessons` of a task make, as one action.

    Args:
        task: of the lessons.
        robot: that it acts on.
        lessons: all teaching events, in order.
        repertoire: of the task, used by this system only.
        wanted: selects one of the task's behaviours.
        mid: the level that changes `wanted`; None: it stays.

    Raises:
        SettingsError: settings of the task cannot be loaded.
        UnknownActionError: an RLA has an action that the repertoire lacks.
        UnknownBehaviourError: an RLA has a behaviour that the task lacks.
    """
    sensors, period_s = robot.infrared.names, robot.cycle_s
    definition = load_situation(task.situation, sensors)
    learning = task.learning
    changed = ((each.features, each.weight) for each in learning.weights)
    weights = feature_weights(definition, changed, learning.history_weight, task.name)
    others = {} if mid is None else {MID: mid.space}
    system = RlaSystem(definition.dimensions, learning.radius, weights, others=others)
    system.apply_all(lessons)
    # Nothing is learnt here: of several RLAs on one condition the newest answers.
    settings = task.reinforcement
    choice = EpsilonGreedy(lambda _: 0.0, epsilon=0.0, hold_ticks=round(settings.hold_s / period_s), seed=settings.seed)
    perception = Perception(definition, sensors)
    basic = BasicLevel(system, repertoire, round(learning.minimum_action_s / period_s), wanted, choice)
    if mid is None:
        return TaughtSystem(perception, basic, (perception, basic))
    over_it = MidLevel(system, mid.build(robot), mid, wanted)
    return TaughtSystem(perception, LayerStack(basic, over_it), (perception, basic, over_it))
