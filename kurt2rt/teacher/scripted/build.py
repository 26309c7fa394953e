"""Construction of the scripted teacher that a task names."""

from collections.abc import Sequence

from behaviors.action_groups import action_groups
from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings, TeacherSettings
from kurt2rt.core.teacher_settings import (
    LONGEST_S,
    ErrorSettings,
    LapseSettings,
    LinkSettings,
    LogNormalDelay,
    LookBackSettings,
    NoticeSettings,
    PersonSettings,
)
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher
from kurt2rt.teacher.scripted.person import ScriptedPerson, TaskSense
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher


def build_teacher(
    task: TaskSettings, robot: RobotSettings, actions: Sequence[str], *, seed: int, session: str
) -> BasicTeacher:
    """Build the scripted teacher of a task, for a robot with these actions.

    Args:
        task: settings of the task and its teacher.
        robot: settings of the robot.
        actions: names of the robot's actions.
        seed: random choices of the teacher.
        session: prefix of its command ids.

    Raises:
        config.settings.SettingsError: the repertoire of the task is missing or invalid.
    """
    profile, period_s = task.teaching.profile, robot.cycle_s
    person = profile.person
    if person is None and {profile.corrects_by, profile.answers_by} & {"hold", "rewind"}:
        person = _without_limits(task.teaching.teacher, period_s)
    if person is not None:
        sense = _task_sense(task, robot, actions)
        return ScriptedPerson(profile, person, sense, period_s=period_s, seed=seed, session=session)
    return ScriptedTeacher(
        task.policy.build(robot.infrared),
        actions,
        task.teaching.teacher,
        period_s=period_s,
        seed=seed,
        session=session,
        corrects=profile.corrects_by != "nothing",
    )


def _task_sense(task: TaskSettings, robot: RobotSettings, actions: Sequence[str]) -> TaskSense:
    policy = task.policy.build(robot.infrared)
    return TaskSense(policy, tuple(actions), action_groups(task.repertoire))


def _without_limits(teacher: TeacherSettings, period_s: float) -> PersonSettings:
    """Return a person with the times of a task's teacher, who sees every tick at once."""

    def always(delay_s: float) -> LogNormalDelay:
        return LogNormalDelay(kind="log_normal", median_s=min(delay_s, LONGEST_S), spread=0.0, longest_s=LONGEST_S)

    patience_s = min(teacher.patience_s, LONGEST_S)
    return PersonSettings(
        question_delay=always(teacher.reaction_s),
        mistake_delay=always(0.0),
        reward_delay=always(teacher.reaction_s),
        hand_delay_s=0.0,
        notices=NoticeSettings(different_after_s=patience_s, similar_after_s=patience_s),
        link=LinkSettings(pictures_per_s=1.0 / period_s, one_way_s=0.0),
        presses_per_minute=0,
        look_back=LookBackSettings(takes=always(teacher.reaction_s), moment_spread_s=0.0),
        lapses=LapseSettings(per_minute=0.0, duration=always(0.0)),
        errors=ErrorSettings(answers=teacher.error_rate, corrections=teacher.error_rate),
        slower_per_minute=0.0,
    )
