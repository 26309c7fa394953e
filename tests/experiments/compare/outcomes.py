"""Outcomes of a comparison, written by hand."""

from kurt2rt.experiments.compare.jobs import Checkpoint, PupilOutcome
from kurt2rt.experiments.compare.plan import Comparison, ComparisonPlan, Row, make_plan
from kurt2rt.experiments.compare.pupil import Pupil
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.transfer.outcomes import MADE_OF, drive

AFTER = (2, 5)


def robot(seed: int, *there: str, failure: str = "", collisions: int = 0, presses: int = 8) -> PupilOutcome:
    """Return a robot whose exams after AFTER presses and at the end went like `there`, or the end alone."""
    return PupilOutcome(
        made_of=MADE_OF,
        seed=seed,
        presses=presses,
        asks=5,
        corrections=3,
        collisions=collisions,
        alarms=0,
        rescues=0,
        failure=failure,
        checkpoints=tuple(
            Checkpoint(presses=after, teaching_s=after, drives=(drive(what),))
            for after, what in zip((*AFTER, presses)[-len(there) :], there, strict=True)
        ),
    )


def plan_for(results: Results, seeds: tuple[int, ...], *pupils: Pupil) -> ComparisonPlan:
    """Return a plan of short lessons and exams in world A."""
    parts = JobParts(factory=STAGE, robot=ROBOT, results=results)
    return make_plan([short_task(exam_s=6.0)], pupils, seeds, AFTER, parts)


def comparison_of(results: Results, *outcomes: tuple[PupilOutcome, ...]) -> Comparison:
    """Return the comparison of the RLA system as shipped and of 1-NN, with the outcomes of each."""
    plan = plan_for(results, tuple(each.seed for each in outcomes[0]), Pupil("1-nn"))
    return Comparison(plan, tuple(Row(entry, own) for entry, own in zip(plan.entries, outcomes, strict=True)))
