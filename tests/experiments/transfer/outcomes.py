"""Outcomes of the transfer study, written by hand."""

from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.study.drive import Drive
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.transfer.outcome import Checkpoint, HomeOutcome, TransferOutcome
from kurt2rt.experiments.transfer.plan import (
    NewWorlds,
    TransferPlan,
    TransferStudy,
    TransferSummary,
    make_plan,
)
from kurt2rt.experiments.transfer.variants import TAUGHT_ON, Variant
from tests.experiments.helpers import ROBOT, STAGE, short_task

AFTER = (0, 2, 5)
MADE_OF = Provenance(task="t", robot="r", worlds="w", source="s", versions="v")
NOT_JUDGED = "not judged"


def drive(what: str = "right") -> Drive:
    """Return a drive that is right, collided, is stuck, or is not judged."""
    verdicts = {"right": ExamVerdict.PASSED, NOT_JUDGED: ExamVerdict.NOT_JUDGED}
    return Drive(
        verdict=verdicts.get(what, ExamVerdict.FAILED),
        duration_s=60.0,
        progress=2.0,
        collisions=2 if what == "collided" else 0,
        stuck=what == "stuck",
        alarm="",
        share_unknown=0.0,
    )


def robot(seed: int, *there: str, presses: int = 5, home: str = "right") -> TransferOutcome:
    """Return a robot whose exams after AFTER presses in the new world went like `there`."""
    points = zip(AFTER, there, strict=True)
    return TransferOutcome(
        made_of=MADE_OF,
        seed=seed,
        world=f"rooms-{seed}",
        presses=presses,
        asks=1,
        corrections=presses - 1,
        collisions=3,
        rescues=0,
        teaching_s=100.0,
        rlas=60,
        knowledge_hash="",
        checkpoints=tuple(
            Checkpoint(presses=after, teaching_s=10.0 * (after + 1), lessons=after, drive=drive(what))
            for after, what in points
        ),
        policy=drive(),
        home_when_right=drive(home),
        home=drive("right"),
    )


def at_home(seed: int, what: str = "right") -> HomeOutcome:
    """Return a robot that was taught at home."""
    return HomeOutcome(
        made_of=MADE_OF,
        seed=seed,
        presses=40,
        lessons=120,
        rlas=50,
        knowledge_hash="",
        drive=drive(what),
        policy=drive(),
    )


def plan_for(
    results: Results, seeds: tuple[int, ...], variants: tuple[Variant, ...] = (TAUGHT_ON,), seconds: float = 15.0
) -> TransferPlan:
    """Return a plan of short lessons in a generated room for each robot."""
    return make_plan(
        short_task(exam_s=4.0),
        NewWorlds(("rooms-SEED",), AFTER, seconds),
        seeds,
        variants,
        JobParts(factory=STAGE, robot=ROBOT, results=results),
    )


def study_of(results: Results, *outcomes: TransferOutcome) -> TransferStudy:
    """Return the study of these robots, all of which were right at home before."""
    plan = plan_for(results, tuple(each.seed for each in outcomes))
    (experiment,) = plan.experiments
    return TransferStudy(plan, tuple(at_home(each.seed) for each in outcomes), (TransferSummary(experiment, outcomes),))
