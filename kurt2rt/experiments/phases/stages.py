"""Outcome of one stage: the knowledge, the training run before it, and the exams."""

from collections.abc import Iterable

from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.events import ActionWithdrawn, LessonUndone, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.space import Space
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.phases.outcome import ExamOutcome, Judgement, StageOutcome, TeachingOutcome


def replay_events(task: TaskSettings, robot: RobotSettings, events: Iterable[TeachingEvent]) -> RlaSystem:
    """Return the RLA system with all its levels, for counting: it does not match by the task's weights.

    Raises hal.settings.SettingsError if the task's situation cannot be loaded, InvalidEventError if an event does not
    fit.
    """
    dimensions = load_situation(task.situation, robot.infrared.names).dimensions
    system = RlaSystem(
        dimensions, task.learning.radius, others={CRITIC: Space(len(load_critic(task.critic).names), 1.0, None)}
    )
    system.apply_all(events)
    return system


def teaching_outcome(lesson: TrainingResult, events: Iterable[TeachingEvent]) -> TeachingOutcome:
    """Return the stored counters of a training run; `events`: those of this run."""
    events = tuple(events)
    own = [event for event in events if event.origin.teacher == CRITIC]
    undone = sum(isinstance(event, LessonUndone) for event in own)
    return TeachingOutcome(
        duration_s=lesson.teaching_s,
        load=lesson.workload,
        asks=lesson.asks,
        praise=lesson.positive_rewards,
        blame=lesson.negative_rewards,
        refused_signals=lesson.refused_signals,
        collisions=lesson.collisions,
        rescues=lesson.rescues,
        unknown_rescues=lesson.unknown_rescues,
        alarms=lesson.alarms,
        share_unknown=lesson.share_unknown,
        agreement=lesson.agreement,
        share_trusted=lesson.share_trusted,
        withdrawn=sum(isinstance(event, ActionWithdrawn) for event in events),
        critics_changes=len(own) - undone,
        rolled_back=undone,
    )


def stage_outcome(
    name: str,
    system: RlaSystem,
    teaching: TeachingOutcome | None,
    exams: tuple[ExamOutcome, ...],
    judgements: tuple[Judgement, ...] = (),
) -> StageOutcome:
    """Return the outcome of the stage `name`, with the counts of `system`; `teaching`: None without a training run.

    `judgements`: opinions of critic and judge, if they were compared.
    """
    return StageOutcome(
        name=name,
        rlas=len(system),
        appraisals=len(system.rlas_at(CRITIC)),
        knowledge_hash=system.knowledge_hash(),
        teaching=teaching,
        exams=exams,
        still_withdrawn=sum(rla.is_withdrawn for rla in system.rlas),
        judgements=judgements,
    )
