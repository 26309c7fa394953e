"""Lesson by rewards: the task's judge rewards the robot for the time of the task's lesson."""

from collections.abc import Callable, Sequence

from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.phases.steps import reward_plan
from kurt2rt.experiments.rivals.lesson import MarkedRun, RivalLesson
from kurt2rt.runtime import Runtime


async def teach_by_signals(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    team: LearnerTeam | None,
    after: Sequence[int],
    *,
    seed: int,
    on_progress: Callable[[float], None],
) -> tuple[RivalLesson, Runtime]:
    """Reward the robot as in phase 3; return the lesson with the runtime that was taught.

    The teacher answers questions, too, which only RLAs ask. Arguments and errors are those of `teach_rival`; a task
    without a judge and a section on phases raises hal.settings.SettingsError as well.
    """
    store, plan = InMemoryEventStore(), reward_plan(task, task.teaching.duration_s, "lesson")
    training = TrainingStore(store, learners=team)
    runtime = build_training_runtime(simulation, settings, task, training, appraises=plan.appraises)
    run = MarkedRun(simulation, runtime, store, team, after, seed=seed, on_progress=on_progress, plan=plan)
    await run.drive()
    return run.lesson(), runtime
