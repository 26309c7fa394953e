"""Outcomes of a league, written by hand."""

from kurt2rt.experiments.rivals.outcome import PolicyOutcome, RivalCheckpoint, RivalOutcome
from kurt2rt.experiments.rivals.plan import League, LeaguePlan, Row, make_plan
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from tests.experiments.helpers import ROBOT, STAGE, short_task
from tests.experiments.transfer.outcomes import MADE_OF, drive

AFTER = (2, 5)


def robot(seed: int, *there: str, failure: str = "", collisions: int = 0) -> RivalOutcome:
    """Return a robot whose exams after AFTER presses and at the end went like `there`, or the end alone."""
    presses = (*AFTER, 8)[-len(there) :]
    return RivalOutcome(
        made_of=MADE_OF,
        seed=seed,
        presses=8,
        labels=30,
        driven_s=6.0,
        waited_s=9.0,
        asks=5,
        corrections=3,
        collisions=collisions,
        alarms=0,
        rescues=0,
        teaching_s=100.0,
        failure=failure,
        checkpoints=tuple(
            RivalCheckpoint(presses=after, teaching_s=after, drives=(drive(what),))
            for after, what in zip(presses, there, strict=True)
        ),
        knowledge_bytes=5000,
        retraining_s=0.5,
        longest_decision_ms=3.0,
        tick_p99_us=800.0,
        undo_s=0.002,
        undo_restores=True,
        change_ticks=(1, 1, 4),
        followed_share=0.97,
    )


def plan_for(results: Results, seeds: tuple[int, ...], *rivals: Rival) -> LeaguePlan:
    """Return a plan of short lessons and exams in world A."""
    parts = JobParts(factory=STAGE, robot=ROBOT, results=results)
    return make_plan([short_task(exam_s=6.0)], rivals, seeds, AFTER, parts, source_of=lambda _: "tested")


def league_of(results: Results, *outcomes: tuple[RivalOutcome, ...]) -> League:
    """Return the league of the RLA system as shipped and of 1-NN, with the outcomes of each."""
    seeds = tuple(each.seed for each in outcomes[0])
    plan = plan_for(results, seeds, Rival("1-nn"))
    policies = tuple(PolicyOutcome(made_of=MADE_OF, seed=seed, drives=(drive(),)) for seed in seeds)
    return League(plan, policies, tuple(Row(entry, own) for entry, own in zip(plan.entries, outcomes, strict=True)))
