"""Results of all jobs of the paper study, summarized by experiment."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.lockstep.report import label_of, quartiles, wilson_interval
from kurt2rt.experiments.paper.outcome import DriveOutcome, GrowthOutcome, Reading, TaughtOutcome
from kurt2rt.experiments.paper.plan import PaperExperiment, PaperPlan
from kurt2rt.experiments.paper.settings import ExperimentSettings
from kurt2rt.experiments.study.intervals import Rate, rate_of
from kurt2rt.experiments.study.results import Results

_TEN_MIN_S = 600.0


class Quartiles(NamedTuple):
    """Median and quartiles."""

    low: float
    median: float
    high: float


@dataclass(frozen=True, slots=True)
class WorldSummary:
    """All exams of one experiment in one world, or in all generated ones."""

    world: str
    """Name of the world, or empty: the generated ones."""
    label: str
    robots: int
    judged: int
    """Exams with a verdict; in the others the teacher's own drive got nowhere."""
    succeeded: int
    interval: tuple[float, float] | None
    """95 % interval of the success ratio of `judged`; None if no exam was judged."""
    collided: int
    """Drives with any collision."""
    collisions: Rate
    """Collisions in 10 min of driving."""
    ended_early: int
    """Stuck, or stopped by the guard for good."""
    unit: str
    progress: float
    """Median."""
    teachers_progress: float
    """Median of the teacher's own drives."""
    teacher_failed: int
    """Number of the teacher's drives that collided, got stuck or were stopped by a latch."""
    teacher_got_nowhere: int
    """Number of the teacher's drives with too little progress to measure another drive by."""
    share_unknown: float
    """Median."""
    junctions: int
    right: Rate | None
    """Share of the junctions that were left as asked; None where there were none."""
    lengths: dict[str, float]
    """Median of every other measure, by name."""


@dataclass(frozen=True, slots=True)
class PaperSummary:
    """One experiment."""

    settings: ExperimentSettings
    reading: Reading
    task: TaskSettings
    robots: int
    rlas: Quartiles
    teaching_s: float
    asks: float
    corrections: float
    rescues: float
    """Medians, these three."""
    rlas_of: dict[str, Quartiles]
    """Number of RLAs by behaviour, if there are several."""
    worlds: tuple[WorldSummary, ...]
    outcomes: tuple[TaughtOutcome, ...]
    """One per robot, in the order of the seeds."""

    @property
    def label(self) -> str:
        """Label of the task in tables."""
        return self.task.name.replace("_", " ")


def summarize(experiment: PaperExperiment, outcomes: Sequence[TaughtOutcome]) -> PaperSummary:
    """Return the summary of one experiment from an outcome for each robot."""
    task, unseen = experiment.task, experiment.settings.unseen
    drives = [drive for outcome in outcomes for drive in outcome.drives]
    groups = [(world, label_of(world), [each for each in drives if each.world == world]) for world in task.exam.worlds]
    if unseen is not None:
        generated = [each for each in drives if each.world in unseen.names]
        driven = len({each.world for each in generated})
        span = f"{unseen.names[0]}..{unseen.first + unseen.count - 1}"
        groups.append(("", span if driven == unseen.count else f"{driven} of {span}", generated))

    def median(of: str) -> float:
        return quartiles([float(getattr(outcome, of)) for outcome in outcomes])[1]

    return PaperSummary(
        settings=experiment.settings,
        reading=experiment.reading,
        task=task,
        robots=len(outcomes),
        rlas=Quartiles(*quartiles([outcome.rlas for outcome in outcomes])),
        teaching_s=max(outcome.teaching_s for outcome in outcomes),
        asks=median("asks"),
        corrections=median("corrections"),
        rescues=median("rescues"),
        rlas_of={
            name: Quartiles(*quartiles([outcome.rlas_of[name] for outcome in outcomes])) for name in outcomes[0].rlas_of
        },
        worlds=tuple(_summarize_world(*group) for group in groups if group[2]),
        outcomes=tuple(outcomes),
    )


def _summarize_world(world: str, label: str, drives: Sequence[DriveOutcome]) -> WorldSummary:
    verdicts = [each.verdict for each in drives]
    succeeded = verdicts.count(ExamVerdict.PASSED)
    judged = len(drives) - verdicts.count(ExamVerdict.NOT_JUDGED)
    at_junctions = [each for each in drives if each.findings.get(JUNCTIONS)]
    junctions = [round(each.findings[JUNCTIONS]) for each in at_junctions]
    wrong = [passed - round(each.findings[RIGHT]) for passed, each in zip(junctions, at_junctions, strict=True)]
    # Of the wrong ones, so that the interval of robots that never err does not shrink to a point.
    errs = rate_of(wrong, junctions) if junctions else None
    names = dict.fromkeys(name for each in drives for name in each.findings if not name.startswith(JUNCTIONS))
    return WorldSummary(
        world=world,
        label=label,
        robots=len(drives),
        judged=judged,
        succeeded=succeeded,
        interval=wilson_interval(succeeded, judged) if judged else None,
        collided=sum(each.collisions > 0 for each in drives),
        collisions=rate_of([each.collisions for each in drives], [each.duration_s / _TEN_MIN_S for each in drives]),
        ended_early=sum(each.stuck or bool(each.alarm) for each in drives),
        unit=drives[0].unit,
        progress=quartiles([each.progress for each in drives])[1],
        teachers_progress=quartiles([each.teachers_progress for each in drives])[1],
        teacher_failed=sum(each.teacher_failed for each in drives),
        teacher_got_nowhere=sum(each.teacher_got_nowhere for each in drives),
        share_unknown=quartiles([each.share_unknown for each in drives])[1],
        junctions=sum(junctions),
        right=None if errs is None else Rate(1 - errs.value, max(0.0, 1 - errs.high), 1 - errs.low),
        lengths={
            name: quartiles([each.findings[name] for each in drives if name in each.findings])[1] for name in names
        },
    )


def success_text(world: WorldSummary) -> str:
    """Return `18 of 20`, or `18 of 19, 1 not judged`."""
    left_out = world.robots - world.judged
    return f"{world.succeeded} of {world.judged}" + (f", {left_out} not judged" if left_out else "")


@dataclass(frozen=True, slots=True)
class GrowthStudy:
    """Fig. 2 in one reading."""

    reading: Reading
    task: str
    outcomes: tuple[GrowthOutcome, ...]

    @property
    def radii(self) -> list[float]:
        """Each R of the robots once, in counts, in rising order."""
        return sorted({each.radius for each in self.outcomes})

    def curves(self, radius: float) -> list[tuple[int, ...]]:
        """Return the number of RLAs after each second, a curve for each robot taught with `radius`, in counts."""
        return [each.growth for each in self.outcomes if each.radius == radius]


@dataclass(frozen=True, slots=True)
class PaperStudy:
    """Plan and summaries of the study."""

    plan: PaperPlan
    summaries: tuple[PaperSummary, ...]
    growth: tuple[GrowthStudy, ...]

    @property
    def readings(self) -> tuple[Reading, ...]:
        """Readings in the order of the report."""
        return tuple(dict.fromkeys(each.reading for each in self.summaries))

    def of(self, reading: Reading) -> tuple[PaperSummary, ...]:
        """Return the summaries of the experiments in one reading."""
        return tuple(each for each in self.summaries if each.reading == reading)


def read_study(plan: PaperPlan, results: Results) -> PaperStudy:
    """Read the results of all jobs and return their summaries.

    Raises StudyError if a result is missing or damaged.
    """
    return PaperStudy(
        plan,
        tuple(summarize(each, [results.read(job, TaughtOutcome) for job in each.jobs]) for each in plan.experiments),
        tuple(
            GrowthStudy(each.reading, each.task.name, tuple(results.read(job, GrowthOutcome) for job in each.jobs))
            for each in plan.growth
        ),
    )
