"""Outcomes of robots, written by hand."""

from collections.abc import Sequence

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.teacher_workload import WorkloadMinute
from kurt2rt.experiments.phases.outcome import ExamOutcome, StageOutcome, TeachingOutcome
from kurt2rt.experiments.phases.plan import PhasesPlan
from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    CORRUPTED,
    CRITIC_ALONE,
    INTACT,
    JUDGED,
    LONG_RUN,
    PHASE_1,
    PHASE_2,
    PHASE_3,
    PHASE_4,
    PHASE_5,
    REWARDS,
    SHUFFLED,
    UNKNOWN_BAD,
    UNTAUGHT,
)
from kurt2rt.experiments.phases.summary import PhasesStudy
from kurt2rt.experiments.study.table import Table

TASK = load_task("wall_following")
ALL = (
    *(UNTAUGHT, PHASE_1, PHASE_2, PHASE_3, PHASE_4, PHASE_5, LONG_RUN),
    *(CORRUPTED, ASKS, UNKNOWN_BAD, BLAME_BY_CHANCE, REWARDS, JUDGED, CRITIC_ALONE, SHUFFLED, INTACT),
)


def exam(
    world: str = "a", *, succeeded: bool = True, collisions: int = 0, rescues: int = 0, progress: float = 8.0
) -> ExamOutcome:
    return ExamOutcome(
        world=world,
        unit="laps",
        progress=progress,
        duration_s=300.0,
        way_m=70.0,
        collisions=collisions,
        rescues=rescues,
        alarm="",
        share_unknown=0.03,
        action_changes_per_s=1.5,
        findings={"distance error, m": 0.05},
        succeeded=succeeded,
    )


def teaching(
    duration_s: float = 120.0,
    *,
    blame: int = 0,
    collisions: int = 0,
    rescues: int = 0,
    unknown_rescues: int = 0,
    agreement: tuple[float | None, ...] = (None, 0.7, 0.9),
) -> TeachingOutcome:
    return TeachingOutcome(
        duration_s=duration_s,
        load=(WorkloadMinute(lessons=4, corrections=6), WorkloadMinute(rewards=blame, appraisals=2)),
        asks=4,
        praise=0,
        blame=blame,
        refused_signals=0,
        collisions=collisions,
        rescues=rescues,
        unknown_rescues=unknown_rescues,
        alarms=0,
        share_unknown=0.02,
        agreement=agreement,
        share_trusted=0.5,
        withdrawn=3,
        critics_changes=5,
        rolled_back=1,
    )


def stage(name: str, *exams: ExamOutcome, taught: TeachingOutcome | None = None) -> StageOutcome:
    return StageOutcome(
        name=name, rlas=60, appraisals=170, knowledge_hash="0" * 64, teaching=taught, exams=exams or (exam(),)
    )


def study(robots: int = 2, task: TaskSettings = TASK, **changed: Sequence[StageOutcome]) -> PhasesStudy:
    """All stages of some robots, alike but for those that are given (with _ for - in their names)."""
    stages = {
        name: tuple(
            stage(name, taught=None if name in (UNTAUGHT, PHASE_1, CORRUPTED, JUDGED) else teaching())
            for _ in range(robots)
        )
        for name in ALL
    }
    stages |= {name.replace("_", "-"): tuple(each) for name, each in changed.items()}
    plan = PhasesPlan(task, tuple(range(100, 100 + robots)), False, ())
    return PhasesStudy(plan, stages, ((exam(),),) * robots)


def cells(table: Table, place: int) -> dict[str, str]:
    """Return a row of a table by the names of its columns."""
    row = dict(zip(table.columns, table.rows[place], strict=True))
    assert len(table.rows[place]) == len(table.columns)
    return row
