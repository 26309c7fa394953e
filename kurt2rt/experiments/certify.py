"""Certificate of a taught robot: runs in blocks with witnesses on the CAN bus; probabilities, rates and report."""

import math
import random
import shlex
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, NamedTuple

from config.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_row import PLACES, DriveRow, label_of
from kurt2rt.experiments.lockstep.engine import ON_BUS, BatchDiffersError, Engine, Engines, choose_witnesses
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind, parse_break
from kurt2rt.experiments.lockstep.trails import draw_drive, legend_below, panels_of
from kurt2rt.experiments.study.exam_tables import WORLD
from kurt2rt.experiments.study.figures import SavedFigure, saved
from kurt2rt.experiments.study.intervals import Rate, poisson_interval, rate_of, wilson_interval
from kurt2rt.experiments.study.jobs import SEED, JobParts, Outcome, StudyJob, require_places, world_of
from kurt2rt.experiments.study.provenance import Fingerprints, settings_hash
from kurt2rt.experiments.study.report import tell_with_report
from kurt2rt.experiments.study.study_plan import BusWitnessJob, StudyPlan, group_by
from kurt2rt.experiments.study.table import (
    Column,
    Table,
    Told,
    collisions_text,
    of_text,
    rate_text,
    table_of,
    to_text,
)
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.platform.drive_picture import ASKED, START, TRAIL, draw_marks, draw_robot, draw_trail
from simbridge.contracts.batch import BatchRefusedError

BATCH_GAIN = 100.0
"""A run in the batch counts as so many times less robot time in the progress than one on the CAN bus."""
_MOST_RUNS = 200
_MOST_ROBOT_S = 60_000.0
"""Limits of a job in the batch, which keeps the set points of all its runs: 24 MB."""


class Run(NamedTuple):
    """Drive of a certificate: its number is its seed, and its world is drawn from the places.

    It is repeated by `kurt2rt exam --seed NUMBER --world WORLD`.
    """

    number: int
    """Seed of the robot, its noise, its start and the choice of the world."""
    place: str
    """Kind of world, with SEED where each run has a world of its own."""
    broken: str = ""
    """Sensor that breaks and the way in which, such as s15=low; empty: all work."""

    @property
    def world(self) -> str:
        """Name of the world of this run, its number put in."""
        return world_of(self.place, self.number)


class Extent(NamedTuple):
    """Runs of a certificate: numbers, worlds to draw from, engine, and share of broken sensors."""

    first: int
    """Number of the first run."""
    runs: int
    places: tuple[str, ...]
    """Worlds; SEED in a name stands for the number of the run."""
    engine: Engine = Engine.COMPILED
    broken_share: float = 0.0
    """Share of the runs with a broken sensor, 0 to 1."""


def draw_runs(extent: Extent, sensors: Sequence[str] = ()) -> tuple[Run, ...]:
    """Return the runs of an extent; each place is equally likely for each. `sensors`: names of those that may break."""
    runs = []
    for number in range(extent.first, extent.first + extent.runs):
        place = random.Random(f"world of run {number}").choice(extent.places)
        chance = random.Random(f"broken sensor of run {number}")
        breaks = chance.random() < extent.broken_share
        runs.append(Run(number, place, f"{chance.choice(sensors)}={chance.choice(list(FaultKind))}" if breaks else ""))
    return tuple(runs)


class BlockOutcome(Outcome):
    """Stored outcome of a `BlockJob`: the drives of its runs, in their order."""

    drives: tuple[DriveRow, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockJob(StudyJob):
    """Runs that one process drives, at once in a batch; the job's seed is the first of their numbers."""

    outcome = BlockOutcome
    keeps_knowledge: ClassVar[bool] = False
    taught: Path
    """File with the lessons of the robot."""
    runs: tuple[Run, ...]
    before: DriveRow | None = None
    """The same run as it was driven before; the drive is then stored with the places of its picture."""

    async def measure(self, knowledge: Path, report: Report) -> BlockOutcome:  # noqa: ARG002 - nothing is taught
        """Drive all runs and return the outcome. Raises BatchDiffersError if a run differs from the drive before."""
        events, infrared = read_lessons(self.taught, self.robot, self.task), self.robot.infrared
        setups = []
        for run in self.runs:
            broken = parse_break(run.broken, infrared) if run.broken else None
            setups.append(ExamSetup(run.world, run.number, events=events, broken=broken))
        engine = self.engines.exams
        drives = await run_drives(self.factory, self.robot, self.task, setups, report, engine, measured=False)
        if self.before is not None and drives[0].stored() != self.before:
            raise BatchDiffersError(
                "the batch and the CAN bus differ; all results of the batch are refused",
                where=f"run {self.before.seed} in world {self.before.world}",
                do="report it, and give --engine can and a new folder with --out",
            )
        stored = tuple(each.stored(places=self.before is not None) for each in drives)
        return BlockOutcome(made_of=self.made_of, seed=self.seed, drives=stored)


class Certified(NamedTuple):
    """Subject of a certificate: a task, the knowledge file of the robot, and the runs to be driven."""

    task: TaskSettings
    knowledge: Path
    extent: Extent
    runs: tuple[Run, ...]


def make_plan(task: TaskSettings, knowledge: Path, extent: Extent, parts: JobParts) -> StudyPlan[Certified]:
    """Check knowledge, task and worlds, and return the jobs; a witness that differs refuses all of them.

    A task that the batch does not know is driven on the CAN bus.

    Raises KnowledgeError, and config.settings.SettingsError if the knowledge holds no lesson, or task and worlds do not
    fit.
    """
    lessons = read_lessons(knowledge, parts["robot"], task)
    if not lessons:
        raise SettingsError("holds no lesson", where=knowledge, do="teach the robot first")
    refusals: tuple[str, ...] = ()
    if extent.engine is Engine.COMPILED:
        try:
            require_known_exams(parts["robot"], task, policy=False)
        except BatchRefusedError as refusal:
            extent = extent._replace(engine=Engine.CAN)
            refusals = (f"{refusal}: all runs are driven there, some 100 times slower",)
    runs = draw_runs(extent, parts["robot"].infrared.names)
    require_places(parts["factory"], task, [world_of(place, extent.first) for place in extent.places])
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    # A generated world follows from its name and the source: all of them need not be built here.
    worlds, taught = [place for place in extent.places if SEED not in place], settings_hash(repr(lessons))

    def block(part: Sequence[Run], engine: Engine, gain: float = 1.0) -> BlockJob:
        first, last = part[0].number, part[-1].number
        return BlockJob(
            **parts,
            task=task,
            seed=first,
            made_of=fingerprints.of(task, worlds, taught, repr(tuple(part))),
            name=f"run {first} in world {part[0].world}" if first == last else f"runs {first} to {last}",
            stem=f"runs-{first}-{last}",
            robot_time_s=task.exam.duration_s * len(part) / gain,
            engines=Engines(exams=engine),
            wave=1,
            taught=knowledge,
            runs=tuple(part),
        )

    in_batch = [run for run in runs if extent.engine is Engine.COMPILED and not run.broken]
    step = min(_MOST_RUNS, max(1, int(_MOST_ROBOT_S / task.exam.duration_s)))
    blocks = [block(in_batch[at : at + step], Engine.COMPILED, BATCH_GAIN) for at in range(0, len(in_batch), step)]
    alone = [block((run,), Engine.CAN) for run in runs if run.broken or extent.engine is Engine.CAN]
    chosen = choose_witnesses(in_batch, f"{len(runs)} runs from {extent.first}")
    witnesses = tuple(BusWitnessJob.witness_of(replace(block((run,), Engine.COMPILED), wave=0)) for run in chosen)
    numbers = tuple(run.number for run in runs)
    return StudyPlan(Certified(task, knowledge, extent, runs), numbers, (*blocks, *alone), witnesses, refusals)


def read_drives(plan: StudyPlan[Certified]) -> tuple[DriveRow, ...]:
    """Return the drive of each run in order. Raises StudyError if a result is missing or damaged."""
    outcomes = (job.results.read(job, BlockOutcome) for job in plan.of(BlockJob))
    drives = {each.seed: each for outcome in outcomes for each in outcome.drives}
    return tuple(drives[number] for number in plan.seeds)


def picture_jobs(plan: StudyPlan[Certified], worst: Iterable[DriveRow]) -> list[BlockJob]:
    """Return a job for each of these runs, which drives it again on the CAN bus, for the places of its picture."""
    by_number = {run.number: (job, run) for job in plan.of(BlockJob) for run in job.runs}
    jobs = []
    for each in worst:
        job, run = by_number[each.seed]
        name, stem = f"picture of run {each.seed}", f"pictures/run-{each.seed}"
        again = replace(job, seed=each.seed, name=name, stem=stem, robot_time_s=job.task.exam.duration_s)
        jobs.append(replace(again, engines=ON_BUS, runs=(run,), before=each))
    return jobs


ALL = "all"
"""Name of the summary of all places, with working sensors."""
BROKEN = "a sensor breaks"
"""Name of the summary of all runs with a broken sensor."""
_MOST_GROUPS = 200
"""Groups of runs that an interval of clustered events is bootstrapped over; each run by itself needs 1 GB."""


_LEFT_OUT = {"verdict", "unit", "progress", "least_progress", "action_changes_per_s", "findings", "teacher", *PLACES}
"""Fields of a run that a certificate does not measure."""


class Share(NamedTuple):
    """Share of the runs with an event, 0 to 1, and its 95 % interval (Wilson)."""

    events: int
    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class PlaceSummary:
    """Estimates of a certificate from all runs in the worlds of one place, with their intervals."""

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


def summarise(plan: StudyPlan[Certified], drives: Sequence[DriveRow]) -> Iterator[PlaceSummary]:
    """Yield the summary of each place that was drawn and, if there are several places, of all runs.

    Runs with a broken sensor have a summary of their own. `drives`: of all runs, in order.
    """
    pairs = list(zip(plan.about.runs, drives, strict=True))
    working = [(run.place, drive) for run, drive in pairs if not run.broken]
    broken = [drive for run, drive in pairs if run.broken]
    by_place = [(place, [drive for where, drive in working if where == place]) for place in plan.about.extent.places]
    of_all = [(ALL, [drive for _, drive in working])] if len(by_place) > 1 else []
    return (summarise_runs(place, runs) for place, runs in (*by_place, *of_all, (BROKEN, broken)) if runs)


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
        clean=share(_is_clean),
        collisions_per_hour=_clustered([each.collisions for each in runs], hours),
        first_questions_per_hour=Rate(asked.events / until_asked, fewest / until_asked, most / until_asked),
        questions_per_hour=_clustered([each.questions for each in runs], hours),
        unknown_share=math.fsum(each.share_unknown * each.duration_s for each in runs) / seconds,
        m_per_minute=math.fsum(each.way_m for each in runs) / (seconds / 60),
    )


def _is_clean(run: DriveRow) -> bool:
    """Return whether a run had no collision, no question and no early end."""
    return not (run.failed or run.questions)


def worst_of(drives: Sequence[DriveRow], count: int) -> list[DriveRow]:
    """Return so many runs: those with most collisions, then those stopped, stuck or asking soonest, then others."""

    def badness(run: DriveRow) -> tuple[float, ...]:
        first = run.first_question_s or math.inf
        return -run.collisions, not run.ended_early, _is_clean(run), run.duration_s, first, run.seed

    return sorted(drives, key=badness)[:count]


def _clustered(counts: Sequence[int], hours: Sequence[float]) -> Rate:
    """Return events in an hour; runs are independent, and so are groups of them."""
    size = math.ceil(len(counts) / _MOST_GROUPS)
    starts = range(0, len(counts), size)
    return rate_of([sum(counts[i : i + size]) for i in starts], [sum(hours[i : i + size]) for i in starts])


_PLACE: Column = ("world", lambda each: label_of(each.place))


def all_tables(
    plan: StudyPlan[Certified], summaries: Sequence[PlaceSummary], worst: Sequence[DriveRow]
) -> Iterator[Table]:
    """Yield all tables: probabilities, rates and, if there are any, the worst runs."""

    def in_an_hour(name: str) -> Callable[[PlaceSummary], str]:
        def cell(each: PlaceSummary) -> str:
            rate: Rate = getattr(each, name)
            return f"{rate.value:.2f}" if math.isinf(rate.high) else rate_text(rate)

        return cell

    def seconds(time_s: float) -> str:
        return f"{time_s:.1f}" if time_s else ""

    yield _shares_table(
        f"Probability within {plan.about.task.exam.duration_s:g} s of {plan.about.task.name}",
        summaries,
        lambda share: f"{share.value:.2%} ({to_text(share[2:], '.2%')})",
        "With 95 % intervals (Wilson). Each run is another robot: gains and turns of its sensors, their noise, "
        "the slip of its wheels, start and world follow from the run's number. A run ends where the robot is stuck or "
        f"stopped by a watch. {_format_witnesses(plan)}",
    )
    yield table_of(
        "In an hour of driving",
        summaries,
        _PLACE,
        ("hours", lambda each: f"{each.hours:.1f}"),
        ("collisions", in_an_hour("collisions_per_hour")),
        ("first question", in_an_hour("first_questions_per_hour")),
        ("all questions", in_an_hour("questions_per_hour")),
        ("time in the unknown", lambda each: f"{each.unknown_share:.3%}"),
        ("m in a minute", lambda each: f"{each.m_per_minute:.1f}"),
        note="With 95 % intervals: Poisson's exact one, and for events that come in clusters the wider of it and a "
        "bootstrap. No teacher answers: a robot that asks stands until its noise lets it drive on. First question: "
        "questions in an hour of a robot that has not asked yet.",
    )
    broken = {run.number: run.broken for run in plan.about.runs}
    if worst:
        yield table_of(
            "Worst runs",
            worst,
            ("run", lambda each: each.seed),
            WORLD,
            ("broken sensor", lambda each: broken[each.seed]),
            ("collisions", lambda each: each.collisions),
            ("first after s", lambda each: seconds(each.first_collision_s)),
            ("first question after s", lambda each: seconds(each.first_question_s)),
            ("stuck after s", lambda each: seconds(each.duration_s if each.stuck else 0.0)),
            ("stopped", lambda each: each.alarm),
            words=3,
            note="Most collisions first. The number of a run is its seed.",
        )


def _shares_table(
    title: str, summaries: Sequence[PlaceSummary], text: Callable[[Share], str] = "{0.value:.2%}".format, note: str = ""
) -> Table:
    """Return the shares of runs by world, each as `text`, by itself without its interval."""

    def chance(heading: str, name: str) -> Column:
        return heading, lambda each: text(getattr(each, name))

    return table_of(
        title,
        summaries,
        _PLACE,
        ("runs", lambda each: each.runs),
        chance("a collision", "collided"),
        chance("stuck", "stuck"),
        chance("a question", "asked"),
        chance("stopped", "stopped"),
        chance("none of these", "clean"),
        note=note,
    )


def _format_witnesses(plan: StudyPlan[Certified]) -> str:
    """Return how many runs the batch and the CAN bus drove with equal outcomes, and how many the bus alone."""
    alone = sum(not job.engines.in_batch for job in plan.jobs)
    if alone == len(plan.about.runs):
        return "All runs were driven on the CAN bus."
    left = f"; {alone} with a broken sensor were driven there alone" if alone else ""
    return f"{len(plan.witnesses)} runs were driven on the CAN bus too, with equal results{left}."


def draw_together(jobs: Sequence[BlockJob], drives: Sequence[DriveRow]) -> SavedFigure:
    """Draw where the runs of the picture jobs drove, by world, stamped with the result of all; return runs.png.

    `drives`: of all runs. Raises StudyError, OSError.
    """
    clean = sum(map(_is_clean, drives))
    worlds = group_by([job.results.read(job, BlockOutcome).drives[0] for job in jobs], lambda drive: drive.world)
    figure, panels = panels_of(len(worlds), 3, (4.6, 5.0))
    for axes, (world, rows) in zip(panels, worlds, strict=True):
        jobs[0].factory.draw(axes, world)
        for drive in rows:
            draw_trail(axes, drive.trail, "", colour=TRAIL if _is_clean(drive) else ASKED)
            draw_marks(axes, drive.asked_at, drive.collided_at)
            draw_robot(axes, drive.trail[0], jobs[0].robot.geometry.outline_m, START)
        numbers = ", ".join(str(each.seed) for each in rows)
        axes.set_title(f"World {label_of(world)}: run{'s' if len(rows) > 1 else ''} {numbers}")
    stamp = f"{of_text(clean, len(drives))}, at least {wilson_interval(clean, len(drives))[0]:.0%}"
    colour = START if clean == len(drives) else ASKED
    box = {"boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": colour, "linewidth": 3.0}
    figure.suptitle(stamp, fontsize=20, fontweight="bold", color=colour, bbox=box)
    caption = f"{len(jobs)} of {len(drives)} runs; those with a fault come first and are red."
    return saved(figure, jobs[0].results.folder / "runs.png", "Where it drove", caption)


def draw_worst(jobs: Iterable[BlockJob], commands: Sequence[str]) -> Iterator[SavedFigure]:
    """Draw the run of each picture job into the folder of the results and yield it: run-NUMBER.png.

    `commands`: by which a user drives each run again. Raises StudyError, OSError.
    """
    for job, command in zip(jobs, commands, strict=True):
        (drive,) = job.results.read(job, BlockOutcome).drives
        path = job.results.folder / f"run-{drive.seed}.png"
        figure, (axes,) = panels_of(1, 1, (5.6, 6.0))
        draw_drive(axes, job.factory, drive)
        axes.set_title(f"Run {drive.seed} in world {label_of(drive.world)}")
        legend_below(axes)
        asked = f"{drive.questions} times in the unknown" if drive.questions else ""
        parts = (f"world {label_of(drive.world)}", collisions_text(drive.collisions), asked, drive.early_end)
        yield saved(figure, path, f"Run {drive.seed}: {', '.join(filter(None, parts))}", command)


def tell(plan: StudyPlan[Certified], again: Sequence[BlockJob], words: Sequence[str], command: str) -> Told:
    """Write pictures and report into the folder of the results; return the tables.

    `again`: jobs that drove the worst runs again for their pictures. `words`: options by which `kurt2rt
    exam` drives a run so. `command`: typed words of the study, without those that belong to the machine alone. Raises
    BatchDiffersError if a run had another outcome when it was driven again, StudyError, OSError.
    """
    task, knowledge, _, runs = plan.about
    broken = {run.number: run.broken for run in runs}
    failing = [job for job in again if job.before is not None and not _is_clean(job.before)]
    worst = [job.before for job in failing if job.before is not None]
    drives = read_drives(plan)
    summaries = list(summarise(plan, drives))
    commands = []
    for run in worst:
        sensor = ["--broken-sensor", broken[run.seed]] if broken[run.seed] else []
        exam = ["kurt2rt", "exam", str(knowledge), "--seed", str(run.seed), "--world", run.world]
        commands.append(shlex.join([*exam, *sensor, *words]))
    sentence = (
        f"{of_text(sum(map(_is_clean, drives)), len(drives), interval=True)} runs of {task.exam.duration_s:g} s had no "
        f"collision and no question, and were not stuck or stopped; {sum(run.collisions > 0 for run in drives)} "
        "collided."
    )
    about = (
        f"A taught robot drove {task.exam.duration_s:g} s in simulation, without a teacher, once for each number from "
        f"{runs[0].number} to {runs[-1].number}. A number makes the robot with the spread of its sensors, its noise "
        "and slip, its start and its world. The simulated robot stands in for a real one: slopes, carpets, people and "
        "sunlight are not in it."
    )
    driven_again = (
        "The runs of the pictures were driven again, on the CAN bus and with the same outcome. The line below the "
        "picture of one run is the command that shows it again."
    )
    found = [
        {**each.model_dump(exclude=_LEFT_OUT), "broken": broken[each.seed], "command": word}
        for each, word in zip(worst, commands, strict=True)
    ]
    data = {"knowledge": knowledge, "task": task.name, "seconds": task.exam.duration_s, "places": summaries}
    data |= {"compared": len(plan.witnesses), "worst": found}
    tables = list(all_tables(plan, summaries, worst))
    short = _shares_table("Share of the runs", summaries, note="The worst run once more:" if commands else "")
    told = Told(tables, sentence, (about, *([driven_again] if again else ())), short, lines=commands, data=data)
    title = f"KURT2: certificate of a robot that was taught {task.name}"
    pictures = [*([draw_together(again, drives)] if again else ()), *draw_worst(failing, commands)]
    return tell_with_report(plan.results.folder, title, told, command, pictures)
