"""Outcomes of robots, written by hand."""

from collections.abc import Sequence
from typing import Any

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.phases.results import PhasesStudy, Stage
from kurt2rt.experiments.phases.steps import Step
from kurt2rt.experiments.phases.study import PhasesTask, StageOutcome, TeachingOutcome
from kurt2rt.experiments.study.study_plan import StudyPlan
from tests.experiments.rows import FAILED, PASSED, lesson, row

TASK = load_task("wall_following")


def exam(world: str = "a", *, passed: bool = True, **more: Any) -> DriveRow:
    return row(world, PASSED if passed else FAILED, **more)


def teaching(teaching_s: float = 120.0, *, blame: int = 0, **more: Any) -> TeachingOutcome:
    fields: dict[str, Any] = {
        "teaching_s": teaching_s,
        "asks": 4,
        "positive_rewards": 0,
        "negative_rewards": blame,
        "refused_signals": 0,
        "workload": (WorkloadMinute(lessons=4, corrections=6), WorkloadMinute(rewards=blame, appraisals=2)),
        "collisions": 0,
        "rescues": 0,
        "unknown_rescues": 0,
        "alarms": 0,
        "share_unknown": 0.02,
        "agreement": (None, 0.7, 0.9),
        "share_trusted": 0.5,
        "withdrawn": 3,
        "critics_changes": 5,
        "rolled_back": 1,
    }
    return TeachingOutcome.model_validate({**dict(lesson(100)), **fields, **more})


def stage(name: Step, *exams: DriveRow, taught: TeachingOutcome | None = None) -> StageOutcome:
    return StageOutcome(
        name=name, rlas=60, appraisals=170, knowledge_hash="0" * 64, teaching=taught, exams=exams or (exam(),)
    )


def study(robots: int = 2, task: TaskSettings = TASK, **changed: Sequence[StageOutcome]) -> PhasesStudy:
    """All stages of some robots, alike but for those that are given (with _ for - in their names)."""
    stages = {
        name: Stage(
            name,
            tuple(
                stage(
                    name,
                    taught=None if name in (Step.UNTAUGHT, Step.PHASE_1, Step.CORRUPTED, Step.JUDGED) else teaching(),
                )
                for _ in range(robots)
            ),
        )
        for name in Step
    }
    stages |= {step: Stage(step, tuple(each)) for name, each in changed.items() for step in [Step[name.upper()]]}
    plan = StudyPlan(PhasesTask(task, quick=False), tuple(range(100, 100 + robots)), ())
    return PhasesStudy(plan, stages, tuple(exam(seed=seed) for seed in plan.seeds))
