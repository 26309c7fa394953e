"""Summary, tables, pictures and report of a certificate: probabilities and rates with their 95 % intervals."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from kurt2rt.experiments.certify.study import BlockJob, Certificate
from kurt2rt.experiments.lockstep.drive_row import DriveRow, label_of
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.trails import legend_below
from kurt2rt.experiments.study.figures import SavedFigure, draw_drive, panels_of, save
from kurt2rt.experiments.study.intervals import Rate, poisson_interval, rate_of, wilson_interval
from kurt2rt.experiments.study.report import Section, write_report
from kurt2rt.experiments.study.table import Table, collisions_text, table_of, to_text
from simbridge.contracts.simulation import SimulationFactory

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
    extent, runs = certificate.plan.about.extent, certificate.plan.about.runs
    pairs = list(zip(runs, certificate.drives, strict=True))
    working = [(run.place, drive) for run, drive in pairs if not run.broken]
    broken = [drive for run, drive in pairs if run.broken]
    for place in extent.places:
        if drives := [drive for where, drive in working if where == place]:
            yield summarise_runs(place, drives)
    if len(extent.places) > 1 and working:
        yield summarise_runs(ALL, [drive for _, drive in working])
    if broken:
        yield summarise_runs(BROKEN, broken)


def summarise_runs(place: str, runs: Sequence[DriveRow]) -> PlaceSummary:
    """Return the summary of runs in one place."""

    def share(happened: Callable[[DriveRow], bool]) -> Share:
        count = sum(map(happened, runs))
        return Share(count, count / len(runs), *wilson_interval(count, len(runs)))

    hours, seconds = [each.duration_s / 3600 for each in runs], math.fsum(each.duration_s for each in runs)
    asked = share(lambda run: run.questions > 0)
    until_asked = math.fsum((each.first_question_s or each.duration_s) / 3600 for each in runs)
    fewest, most = poisson_interval(asked.events)
    return PlaceSummary(
        place=place,
        runs=len(runs),
        hours=sum(hours),
        collided=share(lambda run: run.collisions > 0),
        stuck=share(lambda run: run.stuck),
        asked=asked,
        stopped=share(lambda run: bool(run.alarm)),
        clean=share(is_clean),
        collisions_per_hour=_clustered([each.collisions for each in runs], hours),
        first_questions_per_hour=Rate(asked.events / until_asked, fewest / until_asked, most / until_asked),
        questions_per_hour=_clustered([each.questions for each in runs], hours),
        unknown_share=math.fsum(each.share_unknown * each.duration_s for each in runs) / seconds,
        m_per_minute=math.fsum(each.way_m for each in runs) / (seconds / 60),
    )


def is_clean(run: DriveRow) -> bool:
    """Return whether a run had no collision, no question and no early end."""
    return not (run.failed or run.questions)


def worst_runs(drives: Sequence[DriveRow], count: int) -> list[DriveRow]:
    """Return so many runs at most: those with most collisions, then those stopped, stuck or asking soonest.

    Runs without any of these are left out.
    """

    def badness(run: DriveRow) -> tuple[float, ...]:
        return -run.collisions, not run.ended_early, run.duration_s, run.first_question_s or math.inf, run.seed

    return sorted((each for each in drives if not is_clean(each)), key=badness)[:count]


def _clustered(counts: Sequence[int], hours: Sequence[float]) -> Rate:
    """Return events in an hour; runs are independent, and so are groups of them."""
    size = math.ceil(len(counts) / _MOST_GROUPS)
    starts = range(0, len(counts), size)
    return rate_of([sum(counts[i : i + size]) for i in starts], [sum(hours[i : i + size]) for i in starts])


def all_tables(certificate: Certificate, worst: Sequence[DriveRow]) -> Iterator[Table]:
    """Yield all tables: probabilities, rates and, if there are any, the worst runs."""
    summaries = list(summarise(certificate))
    yield probability_table(certificate, summaries)
    yield rate_table(summaries)
    if worst:
        yield worst_table(certificate, worst)


def probability_table(certificate: Certificate, summaries: Sequence[PlaceSummary]) -> Table:
    """Return the probability of each event within one run, by place."""
    task = certificate.plan.about.task
    return table_of(
        f"Probability within {task.exam.duration_s:g} s of {task.name}",
        summaries,
        ("world", lambda each: label_of(each.place)),
        ("runs", lambda each: each.runs),
        ("a collision", lambda each: _format_share(each.collided)),
        ("stuck", lambda each: _format_share(each.stuck)),
        ("a question", lambda each: _format_share(each.asked)),
        ("stopped by a watch", lambda each: _format_share(each.stopped)),
        ("none of these", lambda each: _format_share(each.clean)),
        note="With 95 % intervals (Wilson). Each run is another robot: gains and turns of its sensors, their noise, "
        "the slip of its wheels, start and world follow from the run's number. A run ends where the robot is stuck or "
        f"stopped. {_format_witnesses(certificate)}",
    )


def rate_table(summaries: Sequence[PlaceSummary]) -> Table:
    """Return events in an hour, the share of time in unknown situations, and the speed, by place."""
    return table_of(
        "In an hour of driving",
        summaries,
        ("world", lambda each: label_of(each.place)),
        ("hours", lambda each: f"{each.hours:.1f}"),
        ("collisions", lambda each: _format_rate(each.collisions_per_hour)),
        ("first question", lambda each: _format_rate(each.first_questions_per_hour)),
        ("all questions", lambda each: _format_rate(each.questions_per_hour)),
        ("time in the unknown", lambda each: f"{each.unknown_share:.3%}"),
        ("m in a minute", lambda each: f"{each.m_per_minute:.1f}"),
        note="With 95 % intervals: Poisson's exact one, and for events that come in clusters the wider of it and a "
        "bootstrap. No teacher answers: a robot that asks stands until its noise lets it drive on. First question: "
        "questions in an hour of a robot that has not asked yet.",
    )


def worst_table(certificate: Certificate, worst: Sequence[DriveRow]) -> Table:
    """Return one row for each of the worst runs."""
    broken = {run.number: run.broken for run in certificate.plan.about.runs}

    def format_time(time_s: float) -> str:
        return f"{time_s:.1f}" if time_s else ""

    return table_of(
        "Worst runs",
        worst,
        ("run", lambda each: each.seed),
        ("world", lambda each: label_of(each.world)),
        ("broken sensor", lambda each: broken[each.seed]),
        ("collisions", lambda each: each.collisions),
        ("first after s", lambda each: format_time(each.first_collision_s)),
        ("first question after s", lambda each: format_time(each.first_question_s)),
        ("stuck after s", lambda each: format_time(each.duration_s if each.stuck else 0.0)),
        ("stopped", lambda each: each.alarm),
        words=3,
        note="Most collisions first. The number of a run is its seed.",
    )


def _format_witnesses(certificate: Certificate) -> str:
    """Return how many runs the batch and the CAN bus drove with equal outcomes, and how many the bus alone."""
    alone = sum(job.engines.exams is Engine.CAN for job in certificate.plan.of(BlockJob))
    if alone == len(certificate.drives):
        return "All runs were driven on the CAN bus."
    left = f"; {alone} with a broken sensor were driven there alone" if alone else ""
    return f"{certificate.compared} runs were driven on the CAN bus too, with equal results{left}."


def _format_rate(rate: Rate) -> str:
    if math.isinf(rate.high):
        return f"{rate.value:.2f}"
    return f"{rate.value:.2f} ({to_text(rate[1:], '.2f')})"


def _format_share(share: Share) -> str:
    return f"{share.value:.2%} ({to_text(share[2:], '.2%')})"


def draw_worst(
    drives: Sequence[DriveRow], commands: Sequence[str], factory: SimulationFactory, folder: Path
) -> Iterator[SavedFigure]:
    """Draw each run into the folder and yield it: run-NUMBER.png.

    `commands`: by which a user drives each run again. Raises OSError.
    """
    for drive, command in zip(drives, commands, strict=True):
        path = folder / f"run-{drive.seed}.png"
        figure, (axes,) = panels_of(1, 1, (5.6, 6.0))
        draw_drive(axes, factory, drive)
        axes.set_title(f"Run {drive.seed} in world {label_of(drive.world)}")
        legend_below(axes, columns=4)
        save(figure, path)
        asked = f"{drive.questions} times in the unknown" if drive.questions else ""
        parts = (f"world {label_of(drive.world)}", collisions_text(drive.collisions), asked, drive.early_end)
        yield SavedFigure(path, f"Run {drive.seed}: {', '.join(filter(None, parts))}", command)


def write_certificate(
    certificate: Certificate, tables: Sequence[Table], pictures: Sequence[SavedFigure], command: str, path: Path
) -> None:
    """Write the report of a certificate as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    task, _, runs = certificate.plan.about
    told = (
        f"A taught robot drove {task.exam.duration_s:g} s in simulation, without a teacher, once for each number from "
        f"{runs[0].number} to {runs[-1].number}. A number makes the robot with the spread of its sensors, its noise "
        "and slip, its start and its world. The simulated robot stands in for a real one: slopes, carpets, people and "
        "sunlight are not in it."
    )
    again = (
        "Each was driven again on the CAN bus, with the same outcome. The line below a picture is the command that "
        "shows it again."
    )
    write_report(
        path,
        f"KURT2: certificate of a robot that was taught {task.name}",
        (
            Section("", (told,), tables),
            *([Section("Worst runs", (again,), pictures=pictures)] if pictures else ()),
            Section("How this was made"),
        ),
        command=command,
        footer="{versions}. Source of what drives and simulates: {source}. The same command with the same versions "
        "gives the same numbers on the same kind of machine.",
    )
