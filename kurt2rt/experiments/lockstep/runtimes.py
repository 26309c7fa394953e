"""Runtime of a simulated robot with a scripted teacher, in lockstep with its world."""

from collections.abc import Sequence
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from kurt2rt.core.event_store import EventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.statistics import Statistics, StatisticsCounter
from kurt2rt.core.task_settings import TaskSettings, as_its_teacher_wants
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from simbridge.contracts.simulation import Simulation


class NoTeachingAllowed:
    """Event store of a run without a teacher: `submit` raises RuntimeError."""

    saving_error: str | None = None

    def submit(self, event: TeachingEvent) -> None:
        """Raise RuntimeError, because the run has no teacher."""
        raise RuntimeError(f"a lesson was given in an exam: {event}")


@dataclass(frozen=True, slots=True)
class TrainingStore:
    """Destination of the lessons of a training run, and the knowledge that it continues from."""

    store: EventStore
    events: Sequence[TeachingEvent] = ()
    statistics: StatisticsCounter | None = None
    """Counters to continue; None: new ones."""
    saved: Statistics | None = None
    """Values and expectations of the RLAs; None: initial ones."""
    learners: LearnerTeam | None = None
    """Learners that are taught and decide in place of the RLAs; None: RLAs decide."""


def build_training_runtime(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    training: TrainingStore,
    recent: DecisionHistory | None = None,
    *,
    appraises: bool = True,
) -> Runtime:
    """Build the runtime for a scripted teacher.

    Args:
        simulation: that the robot drives in.
        settings: of the robot.
        task: to teach.
        training: destination of the lessons, and the knowledge to continue from.
        recent: history of decisions; None: an empty one.
        appraises: whether critic or teacher appraise situations.

    Raises:
        config.settings.SettingsError: settings do not fit each other.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
    """
    return build_runtime(
        simulation.robot,
        settings,
        as_its_teacher_wants(task),
        training.events,
        training.store,
        LockstepClock(simulation.step),
        RuntimeOptions(
            statistics=training.statistics,
            checkpoint=training.saved,
            # The scripted teacher has no bumper input: at a wall its answer is the action that led there.
            asks_at_bumper=False,
            appraises=appraises,
            recent=recent,
            learners=training.learners,
        ),
    )
