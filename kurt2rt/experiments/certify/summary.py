"""Probabilities and rates of a certificate, by place, with their 95 % intervals."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from kurt2rt.experiments.certify.outcome import RunOutcome
from kurt2rt.experiments.certify.plan import Certificate
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.intervals import Rate, poisson_interval, rate_of

ALL = "all"
"""Name of the summary of all places, with working sensors."""
BROKEN = "a sensor breaks"
"""Name of the summary of all runs with a broken sensor."""
_MOST_GROUPS = 200
"""Groups of runs that an interval of clustered events is bootstrapped over; each run by itself needs 1 GB."""


class Share(NamedTuple):
    """Share of the runs with an event, 0 to 1, and its 95 % interval (Wilson)."""

    events: int
    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class PlaceSummary:
    """Runs in the worlds of one place."""

    place: str
    runs: int
    hours: float
    """Robot time until the runs ended."""
    collided: Share
    stuck: Share
    asked: Share
    stopped: Share
    """Stopped by a watch, such as that of a sensor that looks broken."""
    clean: Share
    """None of these."""
    collisions_per_hour: Rate
    first_questions_per_hour: Rate
    """Rate of a robot that has not asked yet."""
    questions_per_hour: Rate
    unknown_share: float
    """Ratio of the time in unknown situations, 0 to 1."""
    m_per_minute: float


def summarise(certificate: Certificate) -> Iterator[PlaceSummary]:
    """Yield the summary of each place that was drawn and, if there are several places, of all runs.

    Runs with a broken sensor have a summary of their own.
    """
    plan = certificate.plan
    period_s = plan.blocks[0].robot.cycle_s
    pairs = list(zip(plan.runs, certificate.outcomes, strict=True))
    working = [(run.place, outcome) for run, outcome in pairs if not run.broken]
    broken = [outcome for run, outcome in pairs if run.broken]
    for place in plan.extent.places:
        if runs := [outcome for where, outcome in working if where == place]:
            yield summarise_runs(place, runs, period_s)
    if len(plan.extent.places) > 1 and working:
        yield summarise_runs(ALL, [outcome for _, outcome in working], period_s)
    if broken:
        yield summarise_runs(BROKEN, broken, period_s)


def summarise_runs(place: str, runs: Sequence[RunOutcome], period_s: float) -> PlaceSummary:
    """Return the summary of runs in one place; `period_s`: of a tick, in s."""

    def share(happened: Callable[[RunOutcome], bool]) -> Share:
        count = sum(map(happened, runs))
        return Share(count, count / len(runs), *wilson_interval(count, len(runs)))

    hours = [each.ticks * period_s / 3600 for each in runs]
    ticks = sum(each.ticks for each in runs)
    asked = share(lambda run: run.questions > 0)
    until_asked = sum((each.first_question or each.ticks) * period_s / 3600 for each in runs)
    fewest, most = poisson_interval(asked.events)
    return PlaceSummary(
        place=place,
        runs=len(runs),
        hours=sum(hours),
        collided=share(lambda run: run.collisions > 0),
        stuck=share(lambda run: run.stuck),
        asked=asked,
        stopped=share(lambda run: bool(run.stopped)),
        clean=share(lambda run: run.clean),
        collisions_per_hour=_clustered([each.collisions for each in runs], hours),
        first_questions_per_hour=Rate(asked.events / until_asked, fewest / until_asked, most / until_asked),
        questions_per_hour=_clustered([each.questions for each in runs], hours),
        unknown_share=sum(each.unknown_ticks for each in runs) / ticks,
        m_per_minute=sum(each.travelled_m for each in runs) / (ticks * period_s / 60),
    )


def worst_runs(outcomes: Sequence[RunOutcome], count: int) -> list[RunOutcome]:
    """Return so many runs at most: those with most collisions, then those stopped, stuck or asking soonest.

    Runs without any of these are left out.
    """

    def badness(run: RunOutcome) -> tuple[float, ...]:
        ended = bool(run.stopped) or run.stuck
        return -run.collisions, not ended, run.ticks, run.first_question or math.inf, run.number

    return sorted((each for each in outcomes if not each.clean), key=badness)[:count]


def _clustered(counts: Sequence[int], hours: Sequence[float]) -> Rate:
    """Return events in an hour; runs are independent, and so are groups of them."""
    size = math.ceil(len(counts) / _MOST_GROUPS)
    starts = range(0, len(counts), size)
    return rate_of([sum(counts[i : i + size]) for i in starts], [sum(hours[i : i + size]) for i in starts])
