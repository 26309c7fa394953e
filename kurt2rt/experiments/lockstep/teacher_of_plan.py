"""Scripted teacher of a training run, built by the plan of its lesson."""

from behaviors.repertoire import primitive_speeds
from config.settings import SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.teacher.scripted.appraiser import (
    FeedbackTiming,
    JudgeReward,
    RandomPenalty,
    RewardSource,
    ScriptedAppraiser,
    UnknownPenalty,
)
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher


def teacher_of(
    plan: LessonPlan, task: TaskSettings, settings: RobotSettings, answering: BasicTeacher, *, seed: int, session: str
) -> ScriptedAppraiser:
    """Return the teacher of all phases of a plan, who leaves phases 1 and 2 to `answering`.

    `seed`: of the teacher's chance. `session`: prefix of the command ids. Raises SettingsError for a task
    without the judge that the plan rewards by.
    """
    period_s, times = settings.cycle_s, plan.times
    every_s = {-1: times.bad_every_s, 0: times.neutral_every_s, 1: times.good_every_s}
    timing = FeedbackTiming(
        reaction=round(task.teaching.teacher.reaction_s / period_s),
        every={value: round(each_s / period_s) for value, each_s in every_s.items()},
        gap=round(times.gap_s / period_s),
        max_punishments=times.most_blame,
    )
    rewards = _reward_source(plan, task, period_s, seed)
    # The first opinion of each value is used.
    named = {value: name for name, value in reversed(load_critic(task.critic).values.items())} if rewards else {}
    primitives = tuple(primitive_speeds(task.repertoire))
    return ScriptedAppraiser(answering, timing, rewards, named, session=session, seed=seed, demonstrated=primitives)


def _reward_source(plan: LessonPlan, task: TaskSettings, period_s: float, seed: int) -> RewardSource | None:
    times = plan.times
    match plan.signs:
        case "unknown":
            return UnknownPenalty()
        case "chance":
            # A penalty decided in the last reaction time would be sent after the end.
            ticks = round((plan.duration_s - task.teaching.teacher.reaction_s) / period_s)
            return RandomPenalty(plan.blame_by_chance, ticks, round(times.bad_every_s / period_s), seed)
        case "judge":
            if task.judge is None:
                raise SettingsError(
                    "there is no judge, so the teacher cannot reward", where=f"task {task.name}", do="add `judge:`"
                )
            return JudgeReward(task.judge.build(), round(times.patience_s / period_s))
        case "none":
            return None
