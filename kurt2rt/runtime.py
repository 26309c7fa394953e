"""Assembly of one robot mind: all parts between the robot and the scheduler."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from behaviors.action_groups import action_groups
from behaviors.repertoire import Repertoire
from hal.robot import Robot
from hal.robot_settings import RobotSettings
from hal.sensor_ring import SubstituteReadings
from hal.sensor_watch import SensorWatch
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.doubt import DoubtMeter, actions_ahead, features_ahead, set_points
from kurt2rt.core.basic.obstacle_memory import ObstacleMemory
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.critic.settings import CriticSettings, critic_of
from kurt2rt.core.decision.decision import ActiveBehaviour, Level
from kurt2rt.core.event_store import EventStore
from kurt2rt.core.expectations.tracker import ExpectationTracker
from kurt2rt.core.layer_stack import LayerStack
from kurt2rt.core.learner.learner_level import LearnerLevel
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.mid.settings import MidSettings, load_mid_level
from kurt2rt.core.perception.definition import SituationDefinition, feature_weights, load_situation
from kurt2rt.core.perception.images import build_images
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.planning.navigator import Navigator
from kurt2rt.core.progress_meter import ProgressMeter
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.contradiction import GuessedLessons
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics, StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.inbox import RobotRepositioned, TeacherInbox
from kurt2rt.core.teaching.knowledge_updater import HandlerParts
from kurt2rt.core.teaching.late_press import TeacherDelay
from kurt2rt.core.teaching.mid_commands import MidCommands
from kurt2rt.core.tick import Tick
from kurt2rt.core.tick_parts import TickOptions, TickParts
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import Clock
from kurt2rt.platform.scheduler import Scheduler
from kurt2rt.platform.tick_timer import TickTimer


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeOptions:
    """Choices of the caller of `build_runtime` beyond robot, task and knowledge; all have defaults."""

    statistics: StatisticsCounter | None = None
    """Counts to go on from; new ones by default."""
    checkpoint: Statistics | None = None
    """Saved values and expectations of the RLAs, and delays of the teachers."""
    level_override: Level | None = None
    """Level that drives instead of the basic level, such as the teacher's own policy. Knowledge and teaching stay
    connected to the basic level; a mid level commands the override as well."""
    learners: LearnerTeam | None = None
    """Learners that decide instead of the RLAs and get each lesson; the RLAs are taught, too, as the journal's record.
    None: RLAs decide. Not with a `level_override`."""
    active_behaviour: ActiveBehaviour | None = None
    """Shared with a `level_override` that reads it; made from the task by default."""
    attended: bool = False
    """Drive by RLAs in phases 1 to 4 only while a teacher is present."""
    teacher_available: bool = True
    """False if there is no teacher to ask: RLAs whose action was withdrawn are skipped."""
    tolerates_stalls: bool = False
    """True if the robot stalls with this program, because it is simulated in it."""
    asks_at_bumper: bool = True
    """Ask if an RLA pushes on toward what a bumper touches; False for a teacher who cannot see a bumper."""
    appraises: bool = True
    """Compute the critic's features in each tick. False: only if the knowledge has RLAs of the critic, for a drive in
    which nothing else reads them."""
    recent: DecisionHistory | None = None
    """History of recent decisions; an empty one by default, which the tick writes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Runtime:
    """One robot mind, built by `build_runtime`: all parts between the robot and the scheduler."""

    robot: RobotSettings
    task: TaskSettings
    definition: SituationDefinition
    level: BasicLevel
    learner: LearnerLevel | None
    """Level that decides in place of the RLAs; None: RLAs decide."""
    mid: MidLevel | None
    """None if the task has no mid level."""
    navigator: Navigator | None
    """Leads the mid level to goals; None without a mid level."""
    active_behaviour: ActiveBehaviour
    handler: CommandHandler
    reinforcement: Reinforcement
    self_teaching: SelfTeaching
    inbox: TeacherInbox
    statistics: StatisticsCounter
    expectations: ExpectationTracker
    timer: TickTimer
    progress: ProgressMeter
    """Updated by the runtime's owner after each tick."""
    tick: Tick
    scheduler: Scheduler[TickRecord]

    def reposition(self) -> None:
        """Tell the next tick that the robot was set down elsewhere, so that it counts no transition."""
        self.inbox.put(RobotRepositioned())

    def action_groups(self) -> Mapping[str, str]:
        """Return the group of each action of the repertoire: those that look alike to a person who watches.

        Raises config.settings.SettingsError.
        """
        return action_groups(self.task.repertoire)

    def snapshot(self) -> Statistics:
        """Return counts, values and expectations of the active RLAs and the delays of the teachers, to be saved.

        Counts of deleted RLAs are dropped.
        """
        counted, system = self.statistics, self.level.system
        counted.drop_deleted(lambda rla_id: system.get(rla_id) is not None)
        return replace(
            self.self_teaching.with_best(self.reinforcement.snapshot()),
            uses=dict(counted.uses),
            transitions=dict(counted.transitions),
            expectations=self.expectations.snapshot(),
            answer_delays=self.handler.delay.snapshot(),
        )


def empty_system(
    settings: RobotSettings,
    task: TaskSettings,
    definition: SituationDefinition,
    critic: CriticSettings,
    mid: MidSettings | None,
) -> RlaSystem:
    """Return the RLA system of all levels of a task for a robot, without any RLA.

    Raises config.settings.SettingsError.
    """
    changed = ((each.features, each.weight) for each in task.learning.weights)
    weights = feature_weights(definition, changed, task.learning.history_weight, task.name)
    others = {CRITIC: Space(len(critic.names), critic.learning.radius, critic.weight_vector)}
    if mid is not None:
        others[MID] = mid.space
    repertoire = load_task_repertoire(task, settings)
    images = build_images(
        definition,
        settings.infrared,
        repertoire,
        task.behaviours,
        mirrored=task.learning.mirrored,
        widths=task.learning.widths,
    )
    system = RlaSystem(definition.dimensions, task.learning.radius, weights, others=others, images=images)
    if task.learning.skip_uncertain_lessons:
        system.is_guess = GuessedLessons(system, action_groups(task.repertoire)).includes
    return system


class _Assembly:
    """Parts of one robot mind during its assembly."""

    def __init__(
        self, settings: RobotSettings, task: TaskSettings, events: tuple[TeachingEvent, ...], options: RuntimeOptions
    ) -> None:
        """Load the settings that the task names and build the levels with the knowledge of `events`."""
        self._settings, self._task, self._events, self._options = settings, task, events, options
        self._period_s = settings.cycle_s
        self.definition = load_situation(task.situation, settings.infrared.names)
        self.critic = critic_of(task.critic, settings)
        mid_settings = None if task.mid is None else load_mid_level(task.mid)
        minimum_action_ticks = round(task.learning.minimum_action_s / self._period_s)
        self._system = empty_system(settings, task, self.definition, self.critic, mid_settings)
        self.reinforcement = self._restored_reinforcement()
        self.active_behaviour = options.active_behaviour or ActiveBehaviour(task.behaviours)
        self.statistics = options.statistics or StatisticsCounter()
        repertoire = load_task_repertoire(task, settings)
        self.basic = BasicLevel(
            self._system,
            repertoire,
            minimum_action_ticks,
            self.active_behaviour,
            self.reinforcement.choice,
            self._doubt(repertoire),
        )
        self.learner: LearnerLevel | None = None
        if options.learners is not None:
            # A repertoire of its own, because BasicLevel may hold the same action.
            own = load_task_repertoire(task, settings)
            self.learner = LearnerLevel(options.learners, own, minimum_action_ticks, self.active_behaviour)
        saved = options.checkpoint or Statistics()
        self.mid: MidLevel | None = None
        if mid_settings is not None:
            situation = mid_settings.build(settings)
            self.mid = MidLevel(self._system, situation, mid_settings, self.active_behaviour)
        self.expectations = ExpectationTracker(self._system, self.mid, self.statistics.transitions, saved.expectations)
        self.navigator: Navigator | None = None
        self.top: Level = options.level_override or self.learner or self.basic
        if self.mid is not None:
            self.navigator = Navigator(self.mid, self.statistics.follow_ups, self.expectations.get)
            self.top = LayerStack(self.top, self.mid, self.navigator)
        agreement = Agreement(self.critic.agreement, self.critic.values, self._period_s)
        agreement.replay(events)
        self.self_teaching = SelfTeaching(self.reinforcement, self._system, self.critic, agreement, self._period_s)
        self.self_teaching.restore(events, options.checkpoint)
        self.handler = self._build_handler(agreement)

    def _doubt(self, repertoire: Repertoire) -> DoubtMeter | None:
        settings = self._task.learning.doubt
        if settings is None:
            return None
        ahead = features_ahead(self.definition, self._settings.infrared)
        memory = None
        if settings.contact is not None:
            memory = ObstacleMemory(settings.contact, self._settings, set_points(repertoire))
        return DoubtMeter(self._system, settings, ahead, actions_ahead(repertoire), memory)

    def _restored_reinforcement(self) -> Reinforcement:
        recent, checkpoint = self._options.recent, self._options.checkpoint
        recent = DecisionHistory(self.definition.dimensions) if recent is None else recent
        reinforcement = Reinforcement(self._system, recent, self._task.reinforcement, self._period_s)
        # Counters, expectations and delays are restored by their owners; pass only values here.
        values = checkpoint and replace(checkpoint, uses={}, transitions={}, expectations={}, answer_delays={})
        reinforcement.restore(self._events, values)
        return reinforcement

    def _build_handler(self, agreement: Agreement) -> CommandHandler:
        commands = None if self.mid is None or self.navigator is None else MidCommands(self.mid, self.navigator)
        # A repertoire of its own: an action run by the teacher must not disturb the same action run by an RLA.
        repertoire = load_task_repertoire(self._task, self._settings)
        answered = None if self._options.checkpoint is None else self._options.checkpoint.answer_delays
        return CommandHandler(
            self.basic,
            ControlAuthority(repertoire, attended=self._options.attended),
            insert_radius_fraction=self._task.learning.insert_radius_fraction,
            handled_command_ids=(event.origin.command_id for event in self._events),
            parts=HandlerParts(
                reinforcement=self.reinforcement,
                critic=Critic(self._system, self.critic),
                agreement=agreement,
                self_teaching=self.self_teaching,
                mid=commands,
                delay=TeacherDelay(round(self._task.learning.teacher_delay_s / self._period_s), answered),
                answers_override_holds=self._task.learning.answers_override_holds,
                learner=self.learner,
                lesson_speed=self._task.teaching.lesson_speed,
            ),
            teacher_available=self._options.teacher_available,
            ask_radius_fraction=self._task.learning.ask_radius_fraction,
        )

    def tick_parts(self, robot: Robot, event_store: EventStore) -> TickParts:
        """Return the parts of the tick."""
        appraises = self._options.appraises or self._system.rlas_at(CRITIC)
        return TickParts(
            robot=robot,
            perception=Perception(self.definition, self._settings.infrared.names),
            level=self.top,
            handler=self.handler,
            inbox=TeacherInbox(),
            event_store=event_store,
            statistics=self.statistics,
            timer=TickTimer(),
            appraisal_perception=AppraisalPerception(self.critic, self._settings) if appraises else None,
            expectations=self.expectations,
            sensor_watch=SensorWatch(self._settings),
            substitute=SubstituteReadings(self._settings.infrared),
        )


def build_runtime(
    robot: Robot,
    settings: RobotSettings,
    task: TaskSettings,
    events: Iterable[TeachingEvent],
    event_store: EventStore,
    clock: Clock,
    options: RuntimeOptions | None = None,
) -> Runtime:
    """Build the runtime for a robot and a task, with the knowledge that `events` have taught.

    Raises:
        config.settings.SettingsError: for settings that do not fit each other.
        UnknownActionError, UnknownBehaviourError: for knowledge that cannot act here.
        InvalidEventError: for an event that does not fit those before it.
        ValueError: for a saved expectation with another number of features.
    """
    options = options or RuntimeOptions()
    mind = _Assembly(settings, task, tuple(events), options)
    parts = mind.tick_parts(robot, event_store)
    tick_options = TickOptions(
        stale_infrared_s=settings.guard.stale_infrared_s,
        tolerates_stalls=options.tolerates_stalls,
        asks_at_bumper=options.asks_at_bumper,
    )
    tick = Tick(parts, tick_options, now=clock.now_s)
    return Runtime(
        robot=settings,
        task=task,
        definition=mind.definition,
        level=mind.basic,
        learner=mind.learner,
        mid=mind.mid,
        navigator=mind.navigator,
        active_behaviour=mind.active_behaviour,
        handler=mind.handler,
        reinforcement=mind.reinforcement,
        self_teaching=mind.self_teaching,
        inbox=parts.inbox,
        statistics=mind.statistics,
        expectations=mind.expectations,
        timer=parts.timer,
        progress=ProgressMeter(settings.cycle_s),
        tick=tick,
        scheduler=Scheduler(clock, tick.run, settings.cycle_s, parts.timer),
    )
