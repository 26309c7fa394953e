"""Optional parts of a command handler, and its knowledge updater and lesson builder made of them."""

from collections.abc import Iterable
from dataclasses import dataclass

from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.learner.learner_level import LearnerLevel
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.teaching.feedback_lessons import AppraisalLessons
from kurt2rt.core.teaching.goal_commands import GoalCommands
from kurt2rt.core.teaching.knowledge_updater import KnowledgeUpdater
from kurt2rt.core.teaching.late_press import TeacherDelay
from kurt2rt.core.teaching.lesson_builder import LessonBuilder
from kurt2rt.core.teaching.mid_lessons import MidLessons
from kurt2rt.core.teaching.rewind_history import RewindHistory


@dataclass(frozen=True, slots=True, kw_only=True)
class HandlerParts:
    """Optional parts of a command handler, each None if the task lacks it."""

    reinforcement: Reinforcement | None = None
    """Effect of rewards; None: they have none."""
    critic: Critic | None = None
    agreement: Agreement | None = None
    self_teaching: SelfTeaching | None = None
    """Teacher of phase 5; None: the robot learns nothing then."""
    mid: MidLessons | None = None
    """Lessons of the mid level; None: the teacher alone selects the behaviour."""
    goals: GoalCommands | None = None
    delay: TeacherDelay | None = None
    """Delay of the teachers; None: it begins with the default."""
    answers_override_holds: bool = False
    """Keep what an answer or a press taught where a hold would replace it."""
    learner: LearnerLevel | None = None
    """Level of a learner that decides instead of the RLAs and gets each lesson; None: RLAs decide."""
    lesson_speed: float = 1.0
    """Fraction of their speed at which actions drive in lessons, until a teacher sets another one."""


def knowledge_updater_for(level: BasicLevel, handled_ids: Iterable[str], parts: HandlerParts) -> KnowledgeUpdater:
    """Return the updater of a handler; `handled_ids`: ids of commands of earlier runs."""
    return KnowledgeUpdater(
        level,
        handled_command_ids=handled_ids,
        reinforcement=parts.reinforcement,
        agreement=parts.agreement,
        self_teaching=parts.self_teaching,
        learner=parts.learner,
    )


def lesson_builder_for(
    level: BasicLevel,
    recent: DecisionHistory,
    rewind: RewindHistory,
    insert_radius_fraction: float,
    parts: HandlerParts,
) -> LessonBuilder:
    """Return the lesson builder of a handler; `insert_radius_fraction`: of R, beyond which a correction inserts."""
    appraisal_lessons = None if parts.critic is None else AppraisalLessons(parts.critic, level.system, recent)
    return LessonBuilder(
        level,
        recent,
        rewind,
        insert_radius_fraction=insert_radius_fraction,
        reinforcement=parts.reinforcement,
        appraisal_lessons=appraisal_lessons,
        mid=parts.mid,
        answers_override_holds=parts.answers_override_holds,
        learner=parts.learner,
    )
