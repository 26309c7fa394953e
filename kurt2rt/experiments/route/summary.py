"""The plan, done: results of all jobs, put together."""

from collections.abc import Sequence
from dataclasses import dataclass

from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.route.outcome import LAYERS, Layer, RouteOutcome
from kurt2rt.experiments.route.plan import RouteExperiment, RoutePlan
from kurt2rt.experiments.study.intervals import Rate, rate_of
from kurt2rt.experiments.study.results import Results


@dataclass(frozen=True, slots=True)
class RouteSummary:
    """Summary of routes of one length and variant."""

    experiment: RouteExperiment
    outcomes: tuple[RouteOutcome, ...]
    """One per robot, in the order of the seeds."""

    @property
    def robots(self) -> int:
        """Number of robots."""
        return len(self.outcomes)

    @property
    def without_error(self) -> int:
        """Number of robots without an error."""
        return sum(each.drive.without_error for each in self.outcomes)

    @property
    def junctions(self) -> int:
        """Number of junctions passed or not got through, of all robots."""
        return sum(each.drive.junctions for each in self.outcomes)

    @property
    def right(self) -> Rate:
        """Share of the junctions that were right, with its interval; 0 without junctions."""
        wrong = [each.drive.junctions - each.drive.right for each in self.outcomes]
        junctions = [each.drive.junctions for each in self.outcomes]
        if not sum(junctions):
            return Rate(0.0, 0.0, 1.0)
        # Of the wrong ones, so that the interval of robots that never err does not shrink to a point.
        errs = rate_of(wrong, junctions)
        return Rate(1 - errs.value, max(0.0, 1 - errs.high), 1 - errs.low)

    def failed(self, layer: Layer) -> int:
        """Return the number of wrong decisions caused by a layer."""
        return sum(wrong.layer == layer for each in self.outcomes for wrong in each.drive.wrong)

    @property
    def failures(self) -> dict[Layer, int]:
        """Wrong decisions by layer."""
        return {layer: self.failed(layer) for layer in LAYERS}

    def quartiles(self, of: str) -> tuple[float, float, float]:
        """Return lower quartile, median and upper quartile of a numeric attribute of the outcomes, by name."""
        return quartiles([float(getattr(each, of)) for each in self.outcomes])


@dataclass(frozen=True, slots=True)
class RouteStudy:
    """Plan and summaries of the study."""

    plan: RoutePlan
    summaries: tuple[RouteSummary, ...]


def read_study(plan: RoutePlan, results: Results) -> RouteStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    return RouteStudy(plan, tuple(_summary(each, results) for each in plan.experiments))


def _summary(experiment: RouteExperiment, results: Results) -> RouteSummary:
    outcomes: Sequence[RouteOutcome] = [results.read(job, RouteOutcome) for job in experiment.jobs]
    return RouteSummary(experiment, tuple(outcomes))
