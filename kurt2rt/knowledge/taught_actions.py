"""Assembly of a taught system that acts as one action, and is not taught further."""

from collections.abc import Iterable

from behaviors.repertoire import Repertoire
from hal.robot_settings import RobotSettings
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.basic.taught_action import TaughtSystem
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.layer_stack import LayerStack
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.settings import MidSettings
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.perception.weights import feature_weights
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import TaskSettings


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
    weights = feature_weights(definition, changed, learning.past_weight, task.name)
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
