"""Results of all jobs of the phases study, summarized by stage."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from behaviors.metrics.task_metric import DISTANCE_ERROR
from kurt2rt.experiments.lockstep.report import label_of, quartiles, wilson_interval
from kurt2rt.experiments.phases.outcome import ExamOutcome, JobOutcome, Judgement, StageOutcome
from kurt2rt.experiments.phases.plan import PhasesPlan
from kurt2rt.experiments.study.intervals import Rate, RateDifference, difference_of, rate_of
from kurt2rt.experiments.study.results import Results

TEN_MIN_S = 600.0


@dataclass(frozen=True, slots=True)
class StageExams:
    """All exams of one stage in one world."""

    world: str
    label: str
    robots: int
    succeeded: int
    interval: tuple[float, float]
    """95 % interval of the success ratio."""
    collisions: Rate
    """Return the collisions in 10 min."""
    stuck: int
    """Robots that were stuck at least once, or stopped by the guard for good."""
    unit: str
    progress: tuple[float, float, float]
    """Lower quartile, median, upper quartile."""
    share_unknown: float
    """Median."""
    changes_per_s: float
    """Median of the action changes."""
    distance_error_m: float | None
    """Median; None where the course measures none."""

    @property
    def share(self) -> float:
        """Share of the exams that succeeded, 0 to 1."""
        return self.succeeded / self.robots


def worlds_of(stages: Sequence[StageOutcome]) -> tuple[StageExams, ...]:
    """Return the summaries of one stage of all robots, world by world."""
    return tuple(
        summarize([exam for stage in stages for exam in stage.exams if exam.world == world])
        for world in dict.fromkeys(exam.world for stage in stages for exam in stage.exams)
    )


def summarize(exams: Sequence[ExamOutcome]) -> StageExams:
    """Return the summary of exams in one world, one for each robot."""
    succeeded = sum(each.succeeded for each in exams)
    errors = [each.findings[DISTANCE_ERROR] for each in exams if DISTANCE_ERROR in each.findings]
    return StageExams(
        world=exams[0].world,
        label=label_of(exams[0].world),
        robots=len(exams),
        succeeded=succeeded,
        interval=wilson_interval(succeeded, len(exams)),
        collisions=collisions_of(exams),
        stuck=sum(each.rescues > 0 or bool(each.alarm) for each in exams),
        unit=exams[0].unit,
        progress=quartiles([each.progress for each in exams]),
        share_unknown=quartiles([each.share_unknown for each in exams])[1],
        changes_per_s=quartiles([each.action_changes_per_s for each in exams])[1],
        distance_error_m=quartiles(errors)[1] if errors else None,
    )


@dataclass(frozen=True, slots=True)
class CriticScore:
    """Agreement of critic and judge, as ratios; None without ticks."""

    precision: float | None
    """Ratio of ticks called bad that are bad."""
    recall: float | None
    """Ratio of bad ticks that are called bad."""
    agreement: float | None
    """Mean over bad and good ones of the share that it calls so."""
    silent: float | None
    """Share of ticks of which it does not know anything."""


def score_of(judgements: Sequence[Judgement]) -> CriticScore:
    """Return the agreement of critic and judge, pooled over all ticks of all judgements."""

    def share(part: Callable[[Judgement], bool], whole: Callable[[Judgement], bool]) -> float | None:
        ticks = sum(each.ticks for each in judgements if whole(each))
        return sum(each.ticks for each in judgements if part(each) and whole(each)) / ticks if ticks else None

    rights = [share(lambda each: each.said == value, lambda each: each.judged == value) for value in (-1, 1)]  # noqa: B023
    known = [right for right in rights if right is not None]
    return CriticScore(
        precision=share(lambda each: each.judged == -1, lambda each: each.said == -1),
        recall=rights[0],
        agreement=sum(known) / len(known) if known else None,
        silent=share(lambda each: each.said is None, lambda _: True),
    )


def alike(one: Sequence[StageOutcome], other: Sequence[StageOutcome]) -> int:
    """Return the number of robots whose exams have equal outcomes at two stages.

    Both sequences hold one stage per robot, in the same order. Raises ValueError if their lengths differ.
    """
    return sum(a.exams == b.exams for a, b in zip(one, other, strict=True))


def collisions_of(exams: Sequence[ExamOutcome]) -> Rate:
    """Return the collisions per 10 min of driving over all these exams together, with the 95 % interval."""
    return rate_of([each.collisions for each in exams], [each.duration_s / TEN_MIN_S for each in exams])


@dataclass(frozen=True, slots=True)
class Measure:
    """Something of an exam that may become better or worse."""

    name: str
    of: Callable[[ExamOutcome], float | None]
    better: int
    """+1: more is better, -1: less is."""
    clean: float | None = None
    """The value of an exam without fault, where such are counted; None where they are measured."""


MEASURES = (
    Measure("success", lambda exam: float(exam.succeeded), +1, clean=1.0),
    Measure("collisions in 10 min", lambda exam: exam.collisions * TEN_MIN_S / exam.duration_s, -1, clean=0.0),
    Measure("progress", lambda exam: exam.progress, +1),
    Measure(DISTANCE_ERROR, lambda exam: exam.findings.get(DISTANCE_ERROR), -1),
    Measure("action changes per s", lambda exam: exam.action_changes_per_s, -1),
)


@dataclass(frozen=True, slots=True)
class Paired:
    """The same robots at two stages, in one world, by one measure."""

    world: str
    measure: Measure
    before: float
    """Mean."""
    after: float
    difference: RateDifference
    better: int
    """Robots."""
    worse: int
    no_longer_clean: int
    """Robots that were clean before and are not after; 0 of what is measured."""

    @property
    def worst_change(self) -> float:
        """Bad end of the interval, as a share of the mean before; above 0: worse."""
        worst = -self.difference.low if self.measure.better > 0 else self.difference.high
        return worst / abs(self.before) if self.before else math.copysign(math.inf, worst) if worst else 0.0

    def not_worse(self, margin: float) -> bool:
        """Return whether no robot stopped being clean, or the measure is not worse by this ratio."""
        return not self.no_longer_clean if self.measure.clean is not None else self.worst_change <= margin

    @property
    def surely_worse(self) -> bool:
        """True if the whole interval is worse."""
        return self.difference.high < 0 if self.measure.better > 0 else self.difference.low > 0

    @property
    def surely_better(self) -> bool:
        """True if the whole interval is better."""
        return self.difference.low > 0 if self.measure.better > 0 else self.difference.high < 0


def paired(before: Sequence[StageOutcome], after: Sequence[StageOutcome]) -> tuple[Paired, ...]:
    """Return the change of each measure from one stage to another of the same robots, world by world.

    Both sequences hold one stage per robot, in the same order, and each stage an exam in each world. A measure that
    no robot has at both stages is left out. Raises ValueError if the lengths differ.
    """
    found = []
    for world in dict.fromkeys(exam.world for stage in after for exam in stage.exams):
        pairs = [(_exam_in(world, one), _exam_in(world, other)) for one, other in zip(before, after, strict=True)]
        for measure in MEASURES:
            values = [(measure.of(one), measure.of(other)) for one, other in pairs]
            known = [(one, other) for one, other in values if one is not None and other is not None]
            if known:
                found.append(_paired(world, measure, known))
    return tuple(found)


def _paired(world: str, measure: Measure, values: Sequence[tuple[float, float]]) -> Paired:
    changes = [other - one for one, other in values]
    return Paired(
        world=world,
        measure=measure,
        before=sum(one for one, _ in values) / len(values),
        after=sum(other for _, other in values) / len(values),
        difference=difference_of(changes),
        better=sum(change * measure.better > 0 for change in changes),
        worse=sum(change * measure.better < 0 for change in changes),
        no_longer_clean=sum(one == measure.clean != other for one, other in values),
    )


def _exam_in(world: str, stage: StageOutcome) -> ExamOutcome:
    return next(exam for exam in stage.exams if exam.world == world)


@dataclass(frozen=True, slots=True)
class PhasesStudy:
    """Plan and summaries of the study."""

    plan: PhasesPlan
    stages: dict[str, tuple[StageOutcome, ...]]
    """Outcomes by the name of the step, in the order of the seeds."""
    teachers: tuple[tuple[ExamOutcome, ...], ...]
    """Drives of the teacher's own policy, per seed one in each world."""


def read_study(plan: PhasesPlan, results: Results) -> PhasesStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    stages: dict[str, list[StageOutcome]] = {}
    teachers = []
    for job in plan.jobs:
        outcome = results.read(job, JobOutcome)
        for stage in outcome.stages:
            stages.setdefault(stage.name, []).append(stage)
        if outcome.teachers:
            teachers.append(outcome.teachers)
    return PhasesStudy(plan, {name: tuple(each) for name, each in stages.items()}, tuple(teachers))
