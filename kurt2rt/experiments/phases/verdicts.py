"""Verdicts on the phases of a task."""

import math
from collections.abc import Iterator

from kurt2rt.core.phase_settings import AskedShare
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.phases.outcome import ExamOutcome, StageOutcome
from kurt2rt.experiments.phases.steps import CORRUPTED, CRITIC_ALONE, INTACT, LONG_RUN, PHASE_2, REWARDS, phases_of
from kurt2rt.experiments.phases.summary import Paired, PhasesStudy, collisions_of, paired, worlds_of
from kurt2rt.experiments.study.intervals import Rate, fall_of, rate_of
from kurt2rt.experiments.study.verdict import Target, Values, Verdict

_HOUR_S = 3600.0


def verdicts(study: PhasesStudy) -> Iterator[Verdict]:
    """Yield the verdict on each target of the task.

    Raises hal.settings.SettingsError if the task has no section on phases.
    """
    phases = phases_of(study.plan.task)
    asked = phases.asked
    rewards, alone = study.stages[REWARDS], study.stages[CRITIC_ALONE]
    yield from _repaired(Target.REPAIRED_BY_REWARDS, rewards, asked.repaired_by_rewards)
    if asked.repaired_by_rewards and phases.signals.most_blame:
        most = max(stage.teaching.blame for stage in rewards if stage.teaching is not None)
        limit = phases.signals.most_blame
        yield Verdict(Target.NEGATIVE_REWARDS, {"limit": limit, "most": most}, most <= limit)
    yield from _repaired(Target.REPAIRED_BY_CRITIC, alone, asked.repaired_by_critic)
    if asked.collisions_fall_by:
        before, after = (collisions_of(_exams(stages)).value for stages in (study.stages[CORRUPTED], alone))
        pairs = [[collisions_of(robot.exams).value for robot in stages] for stages in (study.stages[CORRUPTED], alone)]
        fall = fall_of(*pairs)
        interval = {"fall": fall.value, "low": fall.low, "high": fall.high}
        yield Verdict(
            Target.FEWER_COLLISIONS,
            {"share": asked.collisions_fall_by, **interval, "before": before, "after": after},
            fall.value >= asked.collisions_fall_by,
        )
    if asked.intact_not_worse:
        for each in paired(study.stages[PHASE_2], study.stages[INTACT]):
            yield _not_worse(each, asked.not_worse_margin)
    if asked.interventions_below_per_hour:
        rate, limit_h = interventions(study), asked.interventions_below_per_hour
        interval = {"rate": rate.value, "low": rate.low, "high": rate.high}
        values: Values = {"limit": limit_h, **interval, "robots": robots_of_the_long_run(study)}
        yield Verdict(Target.INTERVENTIONS, values, rate.value < limit_h)


def interventions(study: PhasesStudy) -> Rate:
    """Return the interventions in an hour, of all robots in the long run."""
    taught = [each.teaching for each in study.stages[LONG_RUN] if each.teaching is not None]
    return rate_of([each.interventions for each in taught], [each.duration_s / _HOUR_S for each in taught])


def robots_of_the_long_run(study: PhasesStudy) -> str:
    """Return the number of robots, their hours, and the most interventions of one robot."""
    taught = [each.teaching for each in study.stages[LONG_RUN] if each.teaching is not None]
    minutes = " or ".join(f"{each:g}" for each in sorted({each.duration_s / 60.0 for each in taught}))
    return f"{len(taught)} robots of {minutes} min each, of which the worst had {max(t.interventions for t in taught)}"


def _repaired(target: Target, stages: tuple[StageOutcome, ...], asked: tuple[AskedShare, ...]) -> Iterator[Verdict]:
    share_in = {each.world: each.share for each in asked}
    for world in worlds_of(stages):
        if world.world in share_in:
            # 0.9 of 20 is 18, also where the product is a trifle more.
            needed = math.ceil(share_in[world.world] * world.robots - 1e-9)
            robots = {"robots": world.robots, "succeeded": world.succeeded}
            values: Values = {"world": world.label, "needed": needed, **robots}
            yield Verdict(target, values, world.succeeded >= needed)


def _not_worse(pair: Paired, margin: float) -> Verdict:
    values: dict[str, float | str] = {"world": label_of(pair.world), "measure": pair.measure.name}
    values |= {"before": pair.before, "after": pair.after}
    if pair.measure.clean is not None:
        values["no_longer_clean"] = pair.no_longer_clean
        return Verdict(Target.INTACT_STAYS_CLEAN, values, pair.not_worse(margin))
    direction = "worse" if pair.worst_change > 0 else "better"
    values |= {"margin": margin, "worst": abs(pair.worst_change), "direction": direction}
    return Verdict(Target.INTACT_NOT_WORSE, values, pair.not_worse(margin))


def _exams(stages: tuple[StageOutcome, ...]) -> list[ExamOutcome]:
    return [exam for stage in stages for exam in stage.exams]
