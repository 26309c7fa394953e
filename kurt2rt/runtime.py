"""The runtime, assembled: everything between the robot and the scheduler, built in one place."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from hal.robot import Robot
from hal.robot_settings import RobotSettings
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.appraisal_features import CircumstancesPerception
from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.critic.settings import CriticSettings, load_critic
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.level import Level
from kurt2rt.core.expectations.tracker import ExpectationTracker
from kurt2rt.core.layer_stack import LayerStack
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.settings import MidSettings, load_mid
from kurt2rt.core.perception.definition import SituationDefinition, load_situation
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.perception.weights import weights_of
from kurt2rt.core.planning.navigator import Navigator
from kurt2rt.core.progress_meter import ProgressMeter
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.rla.rla import CRITIC, MID, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.goal_commands import GoalCommands
from kurt2rt.core.teaching.inbox import TeacherInbox
from kurt2rt.core.teaching.mid_lessons import MidLessons
from kurt2rt.core.teaching.system_events import RobotRepositioned
from kurt2rt.core.tick import EventStore, Tick, TickRecord
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.ledger import TickTimer
from kurt2rt.platform.scheduler import Scheduler


@dataclass(frozen=True, slots=True)
class Runtime:
    """The parts that others talk to."""

    robot: RobotSettings
    task: TaskSettings
    definition: SituationDefinition
    level: BasicLevel
    mid: MidLevel | None
    """Over the basic level; None where the task has none."""
    navigator: Navigator | None
    """Has the mid level go to goals; None where there is no mid level."""
    active_behaviour: ActiveBehaviour
    handler: CommandHandler
    reinforcement: Reinforcement
    self_teaching: SelfTeaching
    inbox: TeacherInbox
    statistics: StatisticsCounter
    expectations: ExpectationTracker
    timer: TickTimer
    progress: ProgressMeter
    """Counts what its owner hands it after each tick."""
    tick: Tick
    scheduler: Scheduler[TickRecord]

    def reposition(self) -> None:
        """Somebody has set the robot down elsewhere, between two ticks: the next one begins anew there."""
        self.inbox.put(RobotRepositioned())

    def snapshot(self) -> Statistics:
        """What was counted of the RLAs that live, and what they are worth, as it is now."""
        counted, system = self.statistics, self.level.system
        counted.drop_dead(lambda rla_id: system.get(rla_id) is not None)
        return replace(
            self.self_teaching.with_best(self.reinforcement.to_save()),
            uses=dict(counted.uses),
            transitions=dict(counted.transitions),
            expectations=self.expectations.to_save(),
        )


def empty_system(
    task: TaskSettings, definition: SituationDefinition, critic: CriticSettings, mid: MidSettings | None
) -> RlaSystem:
    """The RLA system of all levels of a task, in which nothing was taught yet. Raises hal.settings.SettingsError."""
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = weights_of(definition, changed, task.learning.past_weight, task.name)
    others = {CRITIC: Space(len(critic.names), critic.learning.radius, critic.weight_vector)}
    if mid is not None:
        others[MID] = mid.space
    return RlaSystem(definition.dimensions, task.learning.radius, weights, others=others)


def build_runtime(
    robot: Robot,
    settings: RobotSettings,
    task: TaskSettings,
    events: Iterable[TeachingEvent],
    event_store: EventStore,
    clock: Clock,
    *,
    statistics: StatisticsCounter | None = None,
    level_override: Level | None = None,
    attended: bool = False,
    active_behaviour: ActiveBehaviour | None = None,
    checkpoint: Statistics | None = None,
    teacher_available: bool = True,
    tolerates_stalls: bool = False,
    asks_at_bumper: bool = True,
) -> Runtime:
    """Build the runtime for a robot and a task, with what `events` have taught.

    `statistics` goes on from what was counted before, `saved` from what the RLAs were worth and what was expected.
    `level_override` puts another layer at the wheels, with knowledge and teaching unchanged behind it: the teacher's
    own policy, for instance, to see what it would reach. A mid level commands that one, too.
    `attended`: in phases 1 to 4 the robot drives by its RLAs only while a teacher is there.
    `wanted`: shared with a `level_override` that looks at it, too; made from the task unless given.
    `asked`: False where nobody is there who could be asked: RLAs whose action was withdrawn are passed over.
    `tolerates_stalls`: whether the robot stalls with this program, as one does that is simulated in it.
    `asks_when_held`: whether the robot asks that touches something; False for runs of before it did.
    Raises hal.settings.SettingsError; UnknownActionError or UnknownBehaviourError for knowledge that cannot act here.
    """
    sensors = settings.infrared.names
    definition = load_situation(task.situation, sensors)
    critic = load_critic(task.critic)
    mid_settings = None if task.mid is None else load_mid(task.mid)
    system = empty_system(task, definition, critic, mid_settings)
    events = tuple(events)
    period_s = settings.can.cycle_s
    recent = DecisionHistory(definition.dimensions)
    reinforcement = Reinforcement(system, recent, task.reinforcement, period_s)
    # The rest of what was saved is kept by those who count on from it, and would be kept twice.
    reinforcement.recall(events, checkpoint and replace(checkpoint, uses={}, transitions={}, expectations={}))
    repertoire = load_task_repertoire(task, settings)
    active_behaviour = active_behaviour or ActiveBehaviour(task.behaviours)
    level = BasicLevel(
        system, repertoire, round(task.learning.minimum_action_s / period_s), active_behaviour, reinforcement.choice
    )
    statistics = statistics or StatisticsCounter()
    counted = statistics.transitions or (checkpoint.transitions if checkpoint is not None else {})
    mid = None
    if mid_settings is not None:
        mid = MidLevel(system, mid_settings.build(settings, counted), mid_settings, active_behaviour)
    at_the_wheels = level_override or level
    expecting = ExpectationTracker(
        system, mid, statistics.transitions, None if checkpoint is None else checkpoint.expectations
    )
    navigator = None if mid is None else Navigator(mid, statistics.follow_ups, expecting.of)
    lessons = None if mid is None else MidLessons(mid)
    # Instances of its own: a behaviour that the hand runs must not disturb the one that an RLA runs later.
    hand = load_task_repertoire(task, settings)
    agreement = Agreement(critic.agreement, critic.values, period_s)
    agreement.hear_all(events)
    self_teaching = SelfTeaching(reinforcement, system, critic, agreement, period_s)
    self_teaching.recall(events, checkpoint)
    school = CommandHandler(
        level,
        ControlAuthority(hand, attended=attended),
        insert_beyond_share=task.learning.insert_beyond_share,
        handled_command_ids=(event.origin.command_id for event in events),
        reinforcement=reinforcement,
        critic=Critic(system, critic),
        agreement=agreement,
        self_teaching=self_teaching,
        mid=lessons,
        goals=None if navigator is None or lessons is None else GoalCommands(navigator, lessons),
        teacher_available=teacher_available,
    )
    inbox = TeacherInbox()
    ledger = TickTimer()
    tick = Tick(
        robot,
        Perception(definition, sensors),
        at_the_wheels if mid is None else LayerStack(at_the_wheels, mid, navigator),
        school,
        inbox,
        event_store,
        statistics,
        ledger,
        now=clock.now_s,
        stale_infrared_s=settings.guard.stale_infrared_s,
        appraisal_perception=CircumstancesPerception(critic, settings),
        expectations=expecting,
        tolerates_stalls=tolerates_stalls,
        asks_at_bumper=asks_at_bumper,
    )
    scheduler = Scheduler(clock, tick.run, period_s, ledger)
    return Runtime(
        settings,
        task,
        definition,
        level,
        mid,
        navigator,
        active_behaviour,
        school,
        reinforcement,
        self_teaching,
        inbox,
        statistics,
        expecting,
        ledger,
        ProgressMeter(period_s),
        tick,
        scheduler,
    )
