"""The programme, done: results of all jobs, put together."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kurt2rt.experiments.paper.outcome import GrowthOutcome, Reading, TaughtOutcome
from kurt2rt.experiments.paper.plan import PaperPlan
from kurt2rt.experiments.paper.summary import PaperSummary, summarize
from kurt2rt.experiments.study.pool import Standing
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.run_jobs import do_jobs


@dataclass(frozen=True, slots=True)
class GrowthStudy:
    """Fig. 2 in one reading."""

    reading: Reading
    task: str
    outcomes: tuple[GrowthOutcome, ...]

    @property
    def radii(self) -> list[float]:
        """Each R once, in rising order."""
        return sorted({each.radius for each in self.outcomes})

    def curves(self, radius: float) -> list[tuple[int, ...]]:
        """Number of RLAs after each second, one curve per robot."""
        return [each.growth for each in self.outcomes if each.radius == radius]


@dataclass(frozen=True, slots=True)
class PaperStudy:
    """All numbers."""

    programme: PaperPlan
    summaries: tuple[PaperSummary, ...]
    growth: tuple[GrowthStudy, ...]

    @property
    def readings(self) -> tuple[Reading, ...]:
        """In the order in which they are shown."""
        return tuple(dict.fromkeys(each.reading for each in self.summaries))

    def of(self, reading: Reading) -> tuple[PaperSummary, ...]:
        """The experiments in one reading."""
        return tuple(each for each in self.summaries if each.reading == reading)


def conduct(
    programme: PaperPlan, missing: Sequence[int], processes: int, on_standing: Callable[[Standing], None]
) -> None:
    """Do the jobs at these places, as `Results.missing` tells them; each leaves its result as soon as it is done.

    Raises StudyError and what a job raises.
    """
    jobs = programme.jobs
    do_jobs([jobs[place] for place in missing], processes, on_standing)


def read_study(programme: PaperPlan, results: Results) -> PaperStudy:
    """Put together what all jobs have left. Raises StudyError."""
    return PaperStudy(
        programme,
        tuple(
            summarize(each, [results.read(job, TaughtOutcome) for job in each.jobs]) for each in programme.experiments
        ),
        tuple(
            GrowthStudy(each.reading, each.task.name, tuple(results.read(job, GrowthOutcome) for job in each.jobs))
            for each in programme.growth
        ),
    )
