"""Construction of the scripted teacher that a task names."""

from collections.abc import Sequence

from hal.robot_settings import RobotSettings
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.teacher.scripted.action_groups import action_groups
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher
from kurt2rt.teacher.scripted.person import ScriptedPerson, TaskSense
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher


def build_teacher(
    task: TaskSettings, robot: RobotSettings, actions: Sequence[str], *, seed: int, session: str
) -> BasicTeacher:
    """Build the scripted teacher of a task, for a robot with these actions; `session` as in ScriptedTeacher."""
    profile, period_s = task.teaching.profile, robot.can.cycle_s
    policy = task.policy.build(robot.infrared)
    if profile.person is not None:
        sense = TaskSense(policy, tuple(actions), action_groups(task.repertoire))
        return ScriptedPerson(profile, profile.person, sense, period_s=period_s, seed=seed, session=session)
    return ScriptedTeacher(
        policy,
        actions,
        task.teaching.teacher,
        replace_radius_fraction=task.learning.insert_beyond_share,
        period_s=period_s,
        seed=seed,
        session=session,
        corrects=profile.corrects_by != "nothing",
    )
