"""Results of the phases study by step and robot: changes of the same robots, and verdicts on the targets."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from behaviors.metrics.task_metric import DISTANCE_ERROR
from kurt2rt.core.phase_settings import AskedShare
from kurt2rt.experiments.lockstep.drive_row import DriveRow, label_of
from kurt2rt.experiments.phases.steps import Judgement, Step, phases_of
from kurt2rt.experiments.phases.study import JobOutcome, PhasesTask, StageOutcome, TeachingOutcome
from kurt2rt.experiments.study.exam_tables import Drives, by_world
from kurt2rt.experiments.study.intervals import TEN_MIN_S, Rate, collisions_in_10_min, difference_of, fall_of, rate_of
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, group_by
from kurt2rt.experiments.study.table import Verdict, needed_of, of_text, reasons_against_judging, to_text

HOUR_S = 3600.0
Stage = Group[Step, StageOutcome]
"""Robots at one stage, in the order of the seeds."""


@dataclass(frozen=True, slots=True)
class PhasesStudy:
    """Results of `kurt2rt study phases` by step and robot, from which tables and figures are made."""

    plan: StudyPlan[PhasesTask]
    stages: dict[Step, Stage]
    """Stages by the name of the step."""
    teachers: tuple[DriveRow, ...]
    """Drives of the teacher's own policy, of each robot one in each world."""

    def taught(self, name: Step) -> list[TeachingOutcome]:
        """Return the training runs of a step, of the robots that had one."""
        return [stage.teaching for stage in self.stages[name].rows if stage.teaching is not None]


def read_study(plan: StudyPlan[PhasesTask]) -> PhasesStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    outcomes = [job.results.read(job, JobOutcome) for job in plan.jobs]
    stages = group_by((stage for outcome in outcomes for stage in outcome.stages), lambda stage: stage.name)
    teachers = tuple(drive for outcome in outcomes for drive in outcome.teachers)
    return PhasesStudy(plan, {stage.of: stage for stage in stages}, teachers)


def reasons_not_to_judge(plan: StudyPlan[PhasesTask]) -> Iterator[str]:
    """Yield why the report compares no result with its target; none for a whole study with enough new robots."""
    if plan.about.quick:
        yield "A part only: it says that everything works, and nothing about the phases."
    yield from reasons_against_judging(plan.seeds)


def exams_of(*stages: Stage) -> list[Drives[Step]]:
    """Return the exams of all robots at these stages, stage by stage and world by world."""
    return [
        each for stage in stages for each in by_world(stage.of, (exam for robot in stage.rows for exam in robot.exams))
    ]


def score_of(judgements: Sequence[Judgement]) -> dict[str, float | None]:
    """Return shares of the agreement of critic and judge, over all ticks of all judgements, by name.

    Each is 0 to 1, or None without ticks.
    """

    def share(part: Callable[[Judgement], bool], whole: Callable[[Judgement], bool]) -> float | None:
        ticks = sum(each.ticks for each in judgements if whole(each))
        return sum(each.ticks for each in judgements if part(each) and whole(each)) / ticks if ticks else None

    bad = share(lambda each: each.said == -1, lambda each: each.judged == -1)
    good = share(lambda each: each.said == 1, lambda each: each.judged == 1)
    known = [right for right in (bad, good) if right is not None]
    return {
        "of what it calls bad is bad": share(lambda each: each.judged == -1, lambda each: each.said == -1),
        "of what is bad it calls so": bad,
        "agreement, mean of bad and good": sum(known) / len(known) if known else None,
        "does not know": share(lambda each: each.said is None, lambda _: True),
    }


class Measure(NamedTuple):
    """Number of an exam by which robots are compared before and after a step, and its better direction."""

    name: str
    of: Callable[[DriveRow], float | None]
    better: int
    """+1: more is better, -1: less is."""
    clean: float | None = None
    """The value of an exam without fault, where such are counted; None where they are measured."""


MEASURES = (
    Measure("success", lambda exam: float(exam.passed), +1, clean=1.0),
    Measure("collisions in 10 min", lambda exam: exam.collisions * TEN_MIN_S / exam.duration_s, -1, clean=0.0),
    Measure("progress", lambda exam: exam.progress, +1),
    Measure(DISTANCE_ERROR, lambda exam: exam.findings.get(DISTANCE_ERROR), -1),
    Measure("action changes per s", lambda exam: exam.action_changes_per_s, -1),
)


@dataclass(frozen=True, slots=True)
class Paired:
    """Comparison of the same robots before and after a step, in one world, by one measure."""

    world: str
    measure: Measure
    values: tuple[tuple[float, float], ...]
    """Values of each robot, before and after."""
    difference: Rate

    @property
    def before(self) -> float:
        """Mean before; measures are in m, laps, or events."""
        return sum(one for one, _ in self.values) / len(self.values)

    @property
    def after(self) -> float:
        """Mean after; measures are in m, laps, or events."""
        return sum(other for _, other in self.values) / len(self.values)

    def robots(self, sign: int) -> int:
        """Return how many robots are better (+1), or worse (-1)."""
        return sum((other - one) * self.measure.better * sign > 0 for one, other in self.values)

    @property
    def no_longer_clean(self) -> int:
        """Number of robots that were clean before and are not after; 0 of what is measured."""
        return sum(one == self.measure.clean != other for one, other in self.values)

    @property
    def worst_change(self) -> float:
        """Bad end of the interval, as a share of the mean before; above 0: worse."""
        worst = -self.difference.low if self.measure.better > 0 else self.difference.high
        return worst / abs(self.before) if self.before else math.copysign(math.inf, worst) if worst else 0.0

    def not_worse(self, margin: float) -> bool:
        """Return whether no robot stopped being clean, or the measure is not worse by this ratio."""
        return not self.no_longer_clean if self.measure.clean is not None else self.worst_change <= margin

    @property
    def surely(self) -> str:
        """Verdict `better` or `worse` if the whole 95 % interval of the difference is; else empty."""
        low, high = (self.difference.low, self.difference.high)[:: self.measure.better]
        return "better" if low * self.measure.better > 0 else "worse" if high * self.measure.better < 0 else ""


def paired(before: Stage, after: Stage) -> tuple[Paired, ...]:
    """Return the change of each measure from one stage to another of the same robots, world by world.

    Each stage has an exam in each world. A measure that no robot has at both stages is left out. Raises ValueError if
    the numbers of robots differ.
    """
    found, then = [], {each.world: each.rows for each in exams_of(before)}
    for each in exams_of(after):
        for measure in MEASURES:
            pairs = [
                (measure.of(one), measure.of(other)) for one, other in zip(then[each.world], each.rows, strict=True)
            ]
            known = tuple((one, other) for one, other in pairs if one is not None and other is not None)
            if known:
                found.append(Paired(each.world, measure, known, difference_of([other - one for one, other in known])))
    return tuple(found)


def verdicts(study: PhasesStudy) -> Iterator[Verdict]:
    """Yield the verdict on each target of the task.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    phases = phases_of(study.plan.about.task)
    asked = phases.asked
    corrupted, alone = study.stages[Step.CORRUPTED], study.stages[Step.CRITIC_ALONE]
    yield from _repaired("repaired by phase 3", study.stages[Step.REWARDS], asked.repaired_by_rewards)
    if asked.repaired_by_rewards and phases.signals.most_blame:
        most, limit = max(each.negative_rewards for each in study.taught(Step.REWARDS)), phases.signals.most_blame
        yield Verdict("most blame in phase 3", f"at most {limit}", str(most), most <= limit)
    yield from _repaired("repaired by the critic alone", alone, asked.repaired_by_critic)
    if asked.collisions_fall_by:
        both = [[robot.exams for robot in stage.rows] for stage in (corrupted, alone)]
        before, after = (collisions_in_10_min([exam for exams in robots for exam in exams]).value for robots in both)
        fall = fall_of(*([collisions_in_10_min(exams).value for exams in robots] for robots in both))
        yield Verdict(
            "collisions, critic alone",
            f"fall by {asked.collisions_fall_by:.0%}",
            f"by {fall.value:.0%} ({to_text(fall[1:], '.0%')}), {before:.2f} to {after:.2f} in 10 min",
            fall.value >= asked.collisions_fall_by,
        )
    if asked.intact_not_worse:
        for each in paired(study.stages[Step.PHASE_2], study.stages[Step.INTACT]):
            yield _not_worse(each, asked.not_worse_margin)
    if asked.interventions_below_per_hour:
        rate, most_h = interventions(study), asked.interventions_below_per_hour
        came = f"{rate.value:.2f} ({to_text(rate[1:], '.2f')}); {robots_of_the_long_run(study)}"
        yield Verdict("interventions an hour, phase 5", f"below {most_h:g}", came, rate.value < most_h)


def interventions(study: PhasesStudy) -> Rate:
    """Return the interventions in an hour, of all robots in the long run."""
    taught = study.taught(Step.LONG_RUN)
    return rate_of([each.interventions for each in taught], [each.teaching_s / HOUR_S for each in taught])


def robots_of_the_long_run(study: PhasesStudy) -> str:
    """Return the number of robots, their hours, and the most interventions of one robot."""
    taught = study.taught(Step.LONG_RUN)
    minutes = " or ".join(f"{each:g}" for each in sorted({each.teaching_s / 60.0 for each in taught}))
    return f"{len(taught)} robots of {minutes} min each, of which the worst had {max(t.interventions for t in taught)}"


def _repaired(what: str, stage: Stage, asked: tuple[AskedShare, ...]) -> Iterator[Verdict]:
    share_in = {each.world: each.share for each in asked}
    for each in exams_of(stage):
        if each.world in share_in:
            robots, needed = len(each.rows), needed_of(share_in[each.world], len(each.rows))
            at_least, came = f"at least {of_text(needed, robots)}", of_text(each.passed, robots)
            yield Verdict(f"{what}, {label_of(each.world)}", at_least, came, each.passed >= needed)


def _not_worse(pair: Paired, margin: float) -> Verdict:
    what = f"intact, {label_of(pair.world)}: {pair.measure.name}"
    means = f"{pair.before:.3f} -> {pair.after:.3f}"
    if pair.measure.clean is not None:
        asked, came = "clean stay clean", f"robots no longer clean: {pair.no_longer_clean}"
        return Verdict(what, asked, f"{means}; {came}", pair.not_worse(margin))
    direction = "worse" if pair.worst_change > 0 else "better"
    asked, came = f"at most {margin:.0%} worse, at the bad end of 95 %", f"{abs(pair.worst_change):.1%} {direction}"
    return Verdict(what, asked, f"{means}, at worst {came}", pair.not_worse(margin))
