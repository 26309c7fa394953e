"""Drive of an agent over the simulated CAN bus: the robot's runtime, with the agent instead of the RLAs."""

from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.episode import Episode
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.gym.endings import Ending
from kurt2rt.gym.episode_setup import EpisodeSetup
from kurt2rt.gym.moment import Moment
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.contracts.simulation import Simulation


class CommandedLevel:
    """Level of an agent's robot: it drives the commanded action until the next command.

    Before the first one it asks, and so the robot stands.
    """

    def __init__(self, repertoire: Repertoire) -> None:
        self._repertoire = repertoire
        self._held = HeldAction(repertoire, minimum_ticks=0)
        self._action: str | None = None

    def command(self, action: str) -> None:
        """Let an action drive from the next tick on; a finished one starts again.

        Raises KeyError for an action outside the repertoire.
        """
        if self._repertoire[action].finished:
            self._held.stop()
        self._action = action

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:  # noqa: ARG002 - the agent sees the situation
        """Return the decision to drive by the commanded action, or to stand for `blocking_cause`."""
        if blocking_cause is not None or self._action is None:
            self._held.stop()
            return Decision(STANDSTILL, blocking_cause or DecisionCause.UNKNOWN, None, None, None)
        self._held.select(self._action)
        return Decision(self._held.step(readings), DecisionCause.TEACHER, self._action, None, None)


class BusDrive(Episode):
    """Drive of an agent over the CAN bus (kurt2rt.gym.moment.AgentDrive).

    Its starts, noise and measures are those of an exam.
    """

    def __init__(self, simulation: Simulation, setup: EpisodeSetup) -> None:
        """Set the robot of a fresh simulation down, and tick once, so that there is an observation.

        Raises config.settings.SettingsError if task and world do not fit.
        """
        task = setup.task
        self.world = setup.world
        self._level = CommandedLevel(load_task_repertoire(task, setup.settings))
        self._clock = LockstepClock(simulation.step)
        options = RuntimeOptions(level_override=self._level, teacher_available=False)
        runtime = build_runtime(simulation.robot, setup.settings, task, (), NoTeachingAllowed(), self._clock, options)
        super().__init__(
            simulation, runtime, setup.chance(), stuck_after_s=task.exam.stuck_after_s, on_progress=lambda _: None
        )
        if setup.start is not None:
            self.place(setup.start)
        elif task.exam.start == "in_sight":
            self.reposition(in_sight=True)
        self._ends_at = setup.ends_at
        self._last_tick = 1 + setup.ticks
        self._collisions_before = simulation.collisions
        self._ending: Ending | None = None
        self._record = self._tick()

    @property
    def moment(self) -> Moment:
        """State after the newest tick."""
        record = self._record
        return Moment(
            situation=record.situation.vector,
            counts=record.readings.infrared_counts if record.trusted_counts is None else record.trusted_counts,
            features=record.appraisal_features,
            action=record.decision.action or "",
            guard=record.guard_result.reasons,
            pose=self.simulation.pose,
            collisions=self.simulation.collisions,
            progress=self.metric.progress,
            ticks=self.ticks - 1,
            ending=self._ending,
        )

    def drive(self, action: str, ticks: int) -> Moment:
        """Drive by an action for `ticks` ticks, or until the episode is over; return the state then.

        Raises KeyError for an action outside the repertoire.
        """
        self._level.command(action)
        for _ in range(ticks):
            self._record = self._tick()
            if self._ending is not None:
                break
        return self.moment

    def close(self) -> None:
        """Stop the robot and close its bus."""
        self.simulation.close()

    def on_tick(self, record: TickRecord) -> None:
        """Measure the drive, and note whether it is over."""
        self.measure()
        for ending, reached in self._endings(record):
            if reached and ending in self._ends_at:
                self._ending = ending
                break

    def _endings(self, record: TickRecord) -> tuple[tuple[Ending, bool], ...]:
        """Return whether each ending is reached in this tick, the weightiest one first."""
        collisions, before = self.simulation.collisions, self._collisions_before
        self._collisions_before = collisions
        return (
            (Ending.STOPPED, record.standing.needs_resume),
            (Ending.OFF_COURSE, self.metric.needs_reset),
            (Ending.COLLISION, collisions > before),
            (Ending.STUCK, self.is_stuck()),
            (Ending.TIME, record.tick >= self._last_tick),
        )

    def _tick(self) -> TickRecord:
        number = self.ticks + 1
        self._clock.step_until(number * self.period_s)
        record = self.runtime.tick.run(number, self._clock.now_s())
        self.after_tick(record)
        return record
