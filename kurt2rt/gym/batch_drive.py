"""Drive of an agent in the compiled batch, with the numbers of the drive over the CAN bus."""

from collections.abc import Iterable

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import SensorReadings
from kurt2rt.core.critic.appraisal_features import AppraisalPerception
from kurt2rt.core.critic.settings import critic_of
from kurt2rt.core.perception.definition import SituationDefinition, load_situation
from kurt2rt.core.perception.perception import Perception
from kurt2rt.experiments.lockstep.batch_mind import build_drive_settings
from kurt2rt.experiments.lockstep.episode import Episode, StuckDetector
from kurt2rt.gym.bus_drive import BusDrive
from kurt2rt.gym.endings import Ending
from kurt2rt.gym.episode_setup import PURPOSE, EpisodeSetup
from kurt2rt.gym.moment import Moment
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from simbridge.contracts.batch import BatchFactory, BatchRefusedError, CommandedMind, DriveSettings, Trace
from simbridge.contracts.simulation import Pose

_ON_THE_BUS = 'drive on the CAN bus: engine="can"'


class BatchDrive:
    """Drive of one robot in a batch of its own (kurt2rt.gym.moment.AgentDrive).

    If a watch of the batch finds a sensor suspicious, the whole drive is repeated over the CAN bus, and goes on there.
    """

    def __init__(self, factory: BatchFactory, setup: EpisodeSetup) -> None:
        """Set a robot down, and tick once, so that there is an observation.

        Raises:
            BatchRefusedError: the batch does not know an action of the task, or a feature of its situation.
            config.settings.SettingsError: task and world do not fit.
        """
        task, settings = setup.task, setup.settings
        self.world = setup.world
        self.trail: list[Pose] = []
        self._factory, self._setup = factory, setup
        drive_settings = build_drive_settings(settings, task, minimum_ticks=0)
        definition = load_situation(task.situation, settings.infrared.names)
        require_known(definition, load_task_repertoire(task, settings), drive_settings)
        self._simulation = simulation = factory.open(setup.world, setup.seed, PURPOSE)
        chance = setup.chance()
        self._metric = task.metric.build(simulation, task.behaviours, chance)
        if setup.start is not None:
            simulation.put(setup.start)
        elif task.exam.start == "in_sight":
            simulation.reposition(chance, in_sight=True)
        self._metric.reset(simulation.pose)
        self._stuck = StuckDetector(task.exam.stuck_after_s, settings.cycle_s, least_m=task.exam.stuck_within_m)
        self._perception = Perception(definition, settings.infrared.names)
        self._appraisal = AppraisalPerception(critic_of(task.critic, settings), settings)
        self._batch = factory.open_batch([simulation], [CommandedMind()], drive_settings)
        simulation.close()  # from here on it follows the batch, which has no bus
        self._commands: list[tuple[str, int]] = []
        self._bus: BusDrive | None = None
        """Drive over the CAN bus, once the robot has left the batch."""
        self._collisions = 0
        self._ticks = -1
        self._action = ""
        self._batch.drive([0], 1)
        self._moment = self._follow()

    @property
    def moment(self) -> Moment:
        """State after the newest tick."""
        return self._moment

    def drive(self, action: str, ticks: int) -> Moment:
        """Drive by an action for `ticks` ticks, or until the episode is over; return the state then.

        Raises KeyError for an action outside the repertoire.
        """
        self._commands.append((action, ticks))
        if self._bus is None:
            self._batch.command(0, self._batch.actions.index(action))
            self._batch.drive([0], ticks)
            if not self._batch.reason_to_leave(0):
                self._moment = self._follow(action)
                return self._moment
            self._bus = self._repeated()
        else:
            self._bus.drive(action, ticks)
        self._moment = self._bus.moment
        return self._moment

    def close(self) -> None:
        """Close the bus of a robot that has left the batch."""
        if self._bus is not None:
            self._bus.close()

    def _repeated(self) -> BusDrive:
        """Return a drive over the CAN bus with all commands so far."""
        bus = BusDrive(self._factory.open(self._setup.world, self._setup.seed, PURPOSE), self._setup)
        for action, ticks in self._commands:
            bus.drive(action, ticks)
        self.trail = bus.trail
        return bus

    def _follow(self, action: str = "") -> Moment:
        """Measure the newest stretch tick by tick until the episode is over; return the state then."""
        stretch, trace = self._batch.stretch(0), self._batch.trace(0)
        features: AppraisalFeatures | None = None
        for place, (pose, collisions) in enumerate(zip(stretch.poses, stretch.collisions, strict=True)):
            self._ticks += 1
            ending = self._ending(pose, collisions)
            is_last = ending is not None or place + 1 == len(stretch.poses)
            readings = _readings(trace, place)
            driven = bool(self._action)  # in the tick before
            self._action = action
            if self._setup.averages or is_last:
                situation = self._perception.perceive(readings, history_frozen=not driven)
            if self._setup.judged:
                features = self._appraisal.perceive(readings, driving=driven)
            if is_last:
                break
        return Moment(
            situation=situation.vector,
            counts=readings.infrared_counts,
            features=features,
            action=action,
            guard=trace.limits[place],
            pose=pose,
            collisions=collisions,
            progress=self._metric.progress,
            ticks=self._ticks,
            ending=ending,
        )

    def _ending(self, pose: Pose, collisions: int) -> Ending | None:
        """Measure one tick; return the weightiest ending that it reaches, None if the episode goes on."""
        self._simulation.follow([pose])
        self._metric.update(pose)
        if (self._ticks + 1) % Episode.trail_stride == 0:
            self.trail.append(pose)
        before, self._collisions = self._collisions, collisions
        reached = (
            (Ending.OFF_COURSE, self._metric.needs_reset),
            (Ending.COLLISION, collisions > before),
            (Ending.STUCK, self._stuck.none_since_window(pose)),
            (Ending.TIME, self._ticks >= self._setup.ticks),
        )
        return next((ending for ending, is_so in reached if is_so and ending in self._setup.ends_at), None)


def require_known(definition: SituationDefinition, names: Iterable[str], known: DriveSettings) -> None:
    """Check that a batch knows the features of a situation, and the actions of these names.

    Raises BatchRefusedError.
    """
    scale = definition.wheel_speed_counts_per_m_s
    if strange := [each.name for each in definition.features if each.batch_kind(scale) is None]:
        raise BatchRefusedError(f"situation {definition.name}: the batch has no {', '.join(strange)}", do=_ON_THE_BUS)
    unknown = [name for name in names if name not in known.actions]
    if unknown:
        raise BatchRefusedError(f"action {', '.join(unknown)}: the batch knows no taught actions", do=_ON_THE_BUS)


def _readings(trace: Trace, place: int) -> SensorReadings:
    """Return the readings of one tick; all of them are fresh."""
    return SensorReadings(
        time_s=0.0,
        infrared_counts=trace.counts[place],
        infrared_age_s=0.0,
        encoder_left_ticks=trace.left_ticks[place],
        encoder_right_ticks=trace.right_ticks[place],
        encoder_age_s=0.0,
        bumpers=trace.bumpers[place],
        bumper_age_s=0.0,
    )
