"""Optional parts of a command handler."""

from dataclasses import dataclass

from kurt2rt.core.critic.agreement import Agreement
from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.learner.learner_level import LearnerLevel
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.reinforcement.self_teaching import SelfTeaching
from kurt2rt.core.teaching.goal_commands import GoalCommands
from kurt2rt.core.teaching.late_press import TeacherDelay
from kurt2rt.core.teaching.mid_lessons import MidLessons


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
