"""The tables of a path of all phases, in their order."""

from collections.abc import Iterator, Sequence

from kurt2rt.experiments.phases.steps import (
    ASKS,
    BLAME_BY_CHANCE,
    BRANCHES,
    CRITIC_ALONE,
    INTACT,
    PATH,
    PHASE_2,
    PHASE_3,
    PHASE_4,
    PHASE_5,
    REWARDS,
    SHUFFLED,
    UNKNOWN_BAD,
    phases_of,
)
from kurt2rt.experiments.phases.study import PhasesStudy
from kurt2rt.experiments.phases.summary import paired
from kurt2rt.experiments.phases.tables.autonomous import alone_sheet, long_run_sheet
from kurt2rt.experiments.phases.tables.controls import words_of_controls
from kurt2rt.experiments.phases.tables.critic import critic_sheet, judged_sheet
from kurt2rt.experiments.phases.tables.exams import exam_sheet
from kurt2rt.experiments.phases.tables.paired import paired_sheet
from kurt2rt.experiments.phases.tables.targets import asked_sheet
from kurt2rt.experiments.phases.tables.teacher_workload import load_sheet
from kurt2rt.experiments.phases.tables.teachers import teachers_sheet
from kurt2rt.experiments.study.table import Table

SUCCESS = (
    "Success is an exam without collision in which the robot is never stuck nor stopped by the guard, and makes at "
    "least the share of the teacher's own progress that the task asks. A robot that is stuck is set down elsewhere and "
    "drives on, so that collisions are those of the whole time. Exams pass over RLAs that are still withdrawn: their "
    "neighbours answer."
)
_PHASE_4 = "Phase 4 teaches the critic alone: what the robot drives by, and so its exams, are those of phase 3."
_PAIRED = (
    "The same robots from the same starts. Means, and the mean change with its 95 % interval, bootstrapped over the "
    "robots; where hardly anything happens it is too narrow. Better, worse, no longer clean: robots; what "
    "is not surely worse may be worse all the same."
)


def sheets(study: PhasesStudy, reasons: Sequence[str]) -> Iterator[Table]:
    """All of them. `reasons` not to judge, if any."""
    yield asked_sheet(study, reasons)
    yield exam_sheet("Phase by phase", PATH, study, f"{SUCCESS} {_PHASE_4}")
    yield teachers_sheet(study)
    yield load_sheet("What the teacher had to do", (PHASE_2, PHASE_3, PHASE_4), study)
    yield critic_sheet(study)
    yield judged_sheet(study)
    yield exam_sheet(
        f"A set of phase 2 with {phases_of(study.programme.task).corrupted_share:.0%} wrong actions, and its repair",
        BRANCHES,
        study,
        "All branches begin with the same set of each robot. Asks only: the teacher answers, no more. Unknown is -1: "
        "he also blames what led into a situation that the robot does not know. By chance: he blames whatever drives "
        "now and then, and answers where the robot asks again. Critic alone: nobody is asked. "
        "Shuffled: the same appraisals with their opinions dealt out anew, trusted all the same. "
        + " ".join(words_of_controls(study)),
    )
    yield load_sheet("What that took", (ASKS, UNKNOWN_BAD, BLAME_BY_CHANCE, REWARDS), study)
    yield alone_sheet(study)
    yield paired_sheet(
        "What rewards add to answers alone", paired(study.stages[ASKS], study.stages[REWARDS]), f"{_PAIRED}"
    )
    yield paired_sheet(
        "What judging adds to blame by chance",
        paired(study.stages[BLAME_BY_CHANCE], study.stages[REWARDS]),
        _PAIRED,
    )
    yield paired_sheet(
        "What its opinions add to the shuffled critic",
        paired(study.stages[SHUFFLED], study.stages[CRITIC_ALONE]),
        _PAIRED,
    )
    yield paired_sheet(
        "An intact set, before and after phase 5", paired(study.stages[PHASE_2], study.stages[INTACT]), _PAIRED
    )
    yield paired_sheet(
        "The set of phase 2, and after all phases", paired(study.stages[PHASE_2], study.stages[PHASE_5]), _PAIRED
    )
    yield long_run_sheet(study)
