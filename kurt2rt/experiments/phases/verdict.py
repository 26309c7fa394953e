"""What was asked, and what came."""

import math
from collections.abc import Iterator

from kurt2rt.experiments.phases.outcome import ExamOutcome, StageOutcome
from kurt2rt.experiments.phases.settings import AskedShare
from kurt2rt.experiments.phases.steps import CORRUPTED, CRITIC_ALONE, INTACT, LONG_RUN, PHASE_2, REWARDS, phases_of
from kurt2rt.experiments.phases.study import Study
from kurt2rt.experiments.phases.summary import collisions_of, paired, worlds_of
from kurt2rt.experiments.report import label_of
from kurt2rt.experiments.shown.intervals import Rate, rate_of
from kurt2rt.experiments.shown.verdict import Verdict

_HOUR_S = 3600.0


def verdicts(study: Study) -> Iterator[Verdict]:
    """All that is asked of the task."""
    phases = phases_of(study.programme.task)
    asked = phases.asked
    rewards, alone = study.stages[REWARDS], study.stages[CRITIC_ALONE]
    yield from _repaired("repaired by phase 3", rewards, asked.repaired_by_rewards)
    if asked.repaired_by_rewards and phases.signals.most_blame:
        most = max(stage.teaching.blame for stage in rewards if stage.teaching is not None)
        limit = phases.signals.most_blame
        yield Verdict("blame in phase 3, most of all robots", f"at most {limit}", f"{most}", most <= limit)
    yield from _repaired("repaired by the critic alone", alone, asked.repaired_by_critic)
    if asked.collisions_fall_by:
        before, after = (collisions_of(_exams(stages)).value for stages in (study.stages[CORRUPTED], alone))
        fall = 1 - after / before if before else 0.0
        yield Verdict(
            "collisions fall by the critic alone",
            f"by {asked.collisions_fall_by:.0%}",
            f"by {fall:.0%}, {before:.2f} to {after:.2f} in 10 min",
            fall >= asked.collisions_fall_by,
        )
    if asked.intact_not_worse:
        worse = [each for each in paired(study.stages[PHASE_2], study.stages[INTACT]) if each.surely_worse]
        came = "; ".join(f"{each.measure.name} in {label_of(each.world)}" for each in worse) or "nothing surely worse"
        yield Verdict("an intact set in phase 5", "not worse", came, not worse)
    if asked.interventions_below_per_hour:
        rate, limit_h = interventions(study), asked.interventions_below_per_hour
        yield Verdict(
            "interventions an hour after phase 5",
            f"below {limit_h:g}",
            f"{rate.value:.2f} ({rate.low:.2f} to {rate.high:.2f})",
            rate.value < limit_h,
        )


def interventions(study: Study, stage: str = LONG_RUN) -> Rate:
    """An hour, of all robots together in a step without a teacher."""
    taught = [each.teaching for each in study.stages[stage] if each.teaching is not None]
    return rate_of([each.interventions for each in taught], [each.duration_s / _HOUR_S for each in taught])


def _repaired(what: str, stages: tuple[StageOutcome, ...], asked: tuple[AskedShare, ...]) -> Iterator[Verdict]:
    share_in = {each.world: each.share for each in asked}
    for world in worlds_of(stages):
        if world.world in share_in:
            # 0.9 of 20 is 18, also where the product is a trifle more.
            needed = math.ceil(share_in[world.world] * world.robots - 1e-9)
            yield Verdict(
                f"{what}, {world.label}",
                f"at least {needed} of {world.robots}",
                f"{world.succeeded} of {world.robots}",
                world.succeeded >= needed,
            )


def _exams(stages: tuple[StageOutcome, ...]) -> list[ExamOutcome]:
    return [exam for stage in stages for exam in stage.exams]
