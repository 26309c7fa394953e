"""Tables of the paper study with its verdicts, and its report."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.core.task_settings import FeatureWeight, TaskSettings
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict, label_of
from kurt2rt.experiments.paper.settings import AskedSettings, ExperimentSettings
from kurt2rt.experiments.paper.study import (
    GrowthJob,
    GrowthOutcome,
    PaperExtent,
    Reading,
    TaughtJob,
)
from kurt2rt.experiments.study.exam_tables import success_text
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.intervals import collisions_in_10_min, quartiles, right_rate
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from kurt2rt.experiments.study.report import Section, spans, write_report
from kurt2rt.experiments.study.study_plan import Group, StudyPlan, read_groups
from kurt2rt.experiments.study.table import Table, median, of_text, share_text, table_of, to_text
from kurt2rt.experiments.study.targets import ROBOTS, Verdict, needed_of, reasons_against_judging, targets_table

CHOSEN_ON_ROOMS = range(60)
"""Seeds of generated rooms that settings were searched on."""
SUCCESS = (
    "Success is an exam that ends neither stuck nor stopped by the guard, with no more collisions than allowed, more "
    "than no progress, at least the share that is asked of what the teacher's own policy reaches from the same start, "
    "and at least the share that is asked of the junctions. Where that policy itself gets nowhere, the exam is not "
    "judged and counts neither way."
)
_SUCCESS_WORDS = {ExamVerdict.PASSED: "yes", ExamVerdict.FAILED: "NO"}
_GROWTH_AT_S = (60, 120, 200, 345, 600)
_OF_RATES = (
    "Its interval is the wider at each end of Poisson's exact one and a bootstrap over robots; in generated worlds "
    "over drives, of which one robot has several."
)


class Experiment(NamedTuple):
    """One task in one reading."""

    settings: ExperimentSettings
    reading: Reading
    task: TaskSettings

    @property
    def label(self) -> str:
        """Label of the task in tables."""
        return self.task.name.replace("_", " ")


Examined = Group[Experiment, ExaminedOutcome]
"""Robots of one experiment."""


class GrowthStudy(NamedTuple):
    """Fig. 2 in one reading."""

    reading: Reading
    task: str
    curves: dict[float, list[tuple[int, ...]]]
    """Number of RLAs after each second, a curve for each robot, by R in counts, in rising order."""


@dataclass(frozen=True, slots=True)
class PaperStudy:
    """Plan and outcomes of the study."""

    plan: StudyPlan[PaperExtent]
    experiments: tuple[Examined, ...]
    growth: tuple[GrowthStudy, ...]
    """Empty when its task is not among those to be done."""

    @property
    def readings(self) -> tuple[Reading, ...]:
        """Readings in the order of the report."""
        return tuple(dict.fromkeys(each.of.reading for each in self.experiments))

    def of(self, reading: Reading) -> tuple[Examined, ...]:
        """Return the experiments in one reading."""
        return tuple(each for each in self.experiments if each.of.reading == reading)


def read_study(plan: StudyPlan[PaperExtent]) -> PaperStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    jobs = plan.of(TaughtJob)
    experiments = read_groups(jobs, lambda job: Experiment(job.settings, job.reading, job.task), ExaminedOutcome)
    grown = read_groups(plan.of(GrowthJob), lambda job: (job.reading, job.task.name, job.radius), GrowthOutcome)
    growth = tuple(
        GrowthStudy(
            reading,
            task,
            {
                each.of[2]: [robot.growth for robot in each.outcomes]
                for each in sorted(grown, key=lambda one: one.of[2])
                if each.of[:2] == (reading, task)
            },
        )
        for reading, task in dict.fromkeys(each.of[:2] for each in grown)
    )
    return PaperStudy(plan, experiments, growth)


def reasons_not_to_judge(plan: StudyPlan[PaperExtent]) -> Iterator[str]:
    """Yield the reasons against judging; none for a whole study with enough new robots and worlds."""
    if not plan.about.extent.is_whole:
        yield "A part only: it says that everything works, and nothing about the paper."
    yield from reasons_against_judging(plan.seeds)
    shipped = {job.task.name: job.settings.unseen for job in plan.of(TaughtJob) if job.reading == "shipped"}
    for name, unseen in shipped.items():
        if unseen is None:
            continue
        if unseen.kind == "rooms" and unseen.first in CHOSEN_ON_ROOMS:
            yield (
                f"{name}: some generated worlds are among rooms-{CHOSEN_ON_ROOMS[0]} to "
                f"rooms-{CHOSEN_ON_ROOMS[-1]}, on which settings were chosen; choose others."
            )
        driven = {world for job in plan.of(TaughtJob) if job.task.name == name for world in job.worlds}
        left_out = len(set(unseen.names) - driven)
        if len(plan.seeds) >= ROBOTS and left_out:
            yield (
                f"{name}: {left_out} of the {unseen.count} generated worlds are left out "
                f"by these seeds; give {ROBOTS} that follow each other."
            )


class InWorld(NamedTuple):
    """Drives of one experiment in one world, or in all generated ones."""

    of: Examined
    world: str
    """Name of the world, or empty: the generated ones."""
    label: str
    drives: Sequence[DriveRow]

    @property
    def judged(self) -> int:
        """Number of drives with a verdict; in the others the teacher's own drive got nowhere."""
        return sum(each.judged for each in self.drives)

    @property
    def passed(self) -> int:
        """Number of drives that passed."""
        return sum(each.passed for each in self.drives)


def worlds_of(group: Examined) -> list[InWorld]:
    """Return the drives of an experiment in each world and in all generated ones, where there are any."""
    drives = [drive for robot in group.outcomes for drive in robot.drives]
    worlds = [
        InWorld(group, world, label_of(world), [each for each in drives if each.world == world])
        for world in group.of.task.exam.worlds
    ]
    unseen = group.of.settings.unseen
    if unseen is not None:
        generated = [each for each in drives if each.world in unseen.names]
        driven = len({each.world for each in generated})
        span = f"{unseen.names[0]}..{unseen.first + unseen.count - 1}"
        worlds.append(InWorld(group, "", span if driven == unseen.count else f"{driven} of {span}", generated))
    return [world for world in worlds if world.drives]


def _all_worlds(groups: Iterable[Examined]) -> list[InWorld]:
    return [world for group in groups for world in worlds_of(group)]


def right_text(drives: Sequence[DriveRow]) -> str:
    """Return the share of the junctions that were left as asked, and how many there were; empty without any."""
    right = right_rate(drives)
    return "" if right is None else f"{right.value:.1%} of {sum(each.junctions for each in drives)}"


def verdicts(group: Examined) -> Iterator[Verdict]:
    """Yield the verdict on each target of the experiment."""
    asked, unseen = group.of.settings.asked, group.of.settings.unseen
    if asked.rlas_at_most:
        rlas = median(each.lesson.rlas for each in group.outcomes)
        yield Verdict("RLAs, median", f"at most {asked.rlas_at_most}", f"{rlas:g}", rlas <= asked.rlas_at_most)
    paper_s = group.of.task.paper.teaching_s
    if asked != AskedSettings() and paper_s:
        taught_s = max(each.lesson.teaching_s for each in group.outcomes)
        yield Verdict("teaching", f"at most {paper_s:g} s", f"{taught_s:g} s", taught_s <= paper_s)
    for world in worlds_of(group):
        of_unseen = unseen.success_at_least if unseen is not None else None
        share = asked.success_at_least.get(world.world) if world.world else of_unseen
        if share is not None:
            needed, judged = needed_of(share, world.judged), world.judged > 0
            at_least, met = f"at least {of_text(needed, world.judged)}", judged and world.passed >= needed
            yield Verdict(f"success in {world.label}", at_least, success_text(world.drives), met, judged)
        if asked.right_at_least:
            right = right_rate(world.drives)
            yield Verdict(
                f"junctions right in {world.label}",
                f"at least {asked.right_at_least:.0%}",
                right_text(world.drives) or "no junction",
                right is not None and right.value >= asked.right_at_least,
            )
        if asked.collisions_below_per_10_min:
            limit, rate = asked.collisions_below_per_10_min, collisions_in_10_min(world.drives).value
            yield Verdict(f"collisions in 10 min in {world.label}", f"below {limit:g}", f"{rate:.2f}", rate < limit)


def all_tables(study: PaperStudy) -> Iterator[Table]:
    """Yield all tables, reading by reading."""
    reasons = list(reasons_not_to_judge(study.plan))
    for reading in study.readings:
        groups = study.of(reading)
        how = "" if reading == "shipped" else "plain reading: "
        yield paper_targets_table(groups, f"{how}what was asked", reasons)
        yield knowledge_table(groups, f"{how}what was taught")
        yield exam_table(groups, f"{how}exams without teacher")
        yield drive_table(groups, f"{how}drives of these exams")
        if any(robot.rlas_of for each in groups for robot in each.outcomes):
            yield behaviour_table(groups, f"{how}taught in common")
    for growth in study.growth:
        yield growth_table(growth)


def paper_targets_table(groups: Sequence[Examined], title: str, not_judged_because: Sequence[str] = ()) -> Table:
    """Return the table of all targets with their results, a row for each.

    `not_judged_because`: reasons against judging; with any, all results are `not judged`.
    """
    return targets_table(
        [((each.of.label,), verdict) for each in groups for verdict in verdicts(each)],
        not_judged_because,
        title=_sentence(title),
        headings=("task",),
        note_without_targets="Of these tasks nothing is asked.",
    )


def knowledge_table(groups: Sequence[Examined], title: str) -> Table:
    """Return the table of RLAs and teaching time, with the paper's numbers."""

    def middle(name: str) -> Callable[[Examined], str]:
        return lambda each: f"{median(getattr(robot.lesson, name) for robot in each.outcomes):g}"

    robots = max(len(each.outcomes) for each in groups)
    teachers = sorted({each.of.task.teaching.profile.name for each in groups})
    return table_of(
        _sentence(title),
        groups,
        ("task", lambda each: each.of.label),
        ("RLAs", middle("rlas")),
        ("quartiles", lambda each: _quartiles_text([robot.lesson.rlas for robot in each.outcomes])),
        ("paper", lambda each: each.of.task.paper.rlas),
        ("teaching, s", lambda each: f"{max(robot.lesson.teaching_s for robot in each.outcomes):g}"),
        ("paper", lambda each: each.of.task.paper.teaching_time_text),
        ("asks", middle("asks")),
        ("corrections", middle("corrections")),
        ("rescues", middle("rescues")),
        note=f"{f'{robots} robots' if robots > 1 else 'One robot'} for each task. RLAs, asks, corrections and rescues "
        f"by hand are medians. Teaching in robot time. Taught by the scripted teacher {' or '.join(teachers)}.",
    )


def exam_table(groups: Sequence[Examined], title: str) -> Table:
    """Return the table of success and collisions by world."""

    times = sorted({each.of.task.exam.duration_s for each in groups})
    return table_of(
        _sentence(title),
        _all_worlds(groups),
        ("task", lambda world: world.of.of.label),
        ("world", lambda world: world.label),
        ("success", lambda world: success_text(world.drives)),
        ("95 %", lambda world: share_text(world.passed, world.judged)),
        ("stuck", lambda world: sum(each.ended_early for each in world.drives)),
        ("collided", lambda world: sum(each.collisions > 0 for each in world.drives)),
        ("in 10 min", lambda world: f"{collisions_in_10_min(world.drives).value:.2f}"),
        ("95 %", lambda world: to_text(collisions_in_10_min(world.drives)[1:], ".2f")),
        words=2,
        note=f"Exams of {' or '.join(f'{time_s:g}' for time_s in times)} s. {SUCCESS} Wilson's interval. Stuck: or "
        "stopped by the guard for good. Collided: drives with any collision. In 10 min: collisions of all drives. "
        f"{_OF_RATES}",
    )


def drive_table(groups: Sequence[Examined], title: str) -> Table:
    """Return the table of progress and measures by world."""
    worlds = _all_worlds(groups)
    found = (name for world in worlds for each in world.drives for name in each.findings)
    names = [name for name in dict.fromkeys(found) if not name.startswith(JUNCTIONS)]

    def measure(name: str) -> Callable[[InWorld], str]:
        def cell(world: InWorld) -> str:
            values = [each.findings[name] for each in world.drives if name in each.findings]
            return f"{median(values):.3f}" if values else ""

        return cell

    def right_interval(world: InWorld) -> str:
        right = right_rate(world.drives)
        return "" if right is None else to_text(right[1:], ".1%")

    def teachers(world: InWorld) -> list[DriveRow]:
        return [each.teacher for each in world.drives if each.teacher is not None]

    def failed(world: InWorld) -> str:
        drives = teachers(world)
        return f"{sum(each.failed for each in drives)}, {sum(each.got_nowhere for each in drives)}"

    return table_of(
        _sentence(title),
        worlds,
        ("task", lambda world: world.of.of.label),
        ("world", lambda world: world.label),
        ("progress", lambda world: f"{median(each.progress for each in world.drives):.1f} {world.drives[0].unit}"),
        ("teacher's own", lambda world: f"{median(each.progress for each in teachers(world)):.1f}"),
        ("failed, nowhere", failed),
        ("unknown", lambda world: f"{median(each.share_unknown for each in world.drives):.1%}"),
        *((name, measure(name)) for name in names),
        ("junctions right", lambda world: right_text(world.drives)),
        ("95 %", right_interval),
        words=2,
        note="Medians, but for the junctions, which are those of all drives. A junction that the robot was asked for "
        "and did not get through, because it got stuck, was stopped for good or turned back, was not left as asked. "
        f"{_OF_RATES} Failed: so many of the teacher's own drives collided, got stuck or were stopped by the guard for "
        "good. Nowhere: so many made too little progress to measure another drive by. "
        "Unknown: share of the time in which the robot did not know the situation.",
    )


def behaviour_table(groups: Sequence[Examined], title: str) -> Table:
    """Return the table of RLAs and junctions by behaviour."""

    def junctions(each: Examined, name: str) -> str:
        drives = [drive.findings for robot in each.outcomes for drive in robot.drives]
        return of_text(*(round(sum(of.get(f"{what}, {name}", 0.0) for of in drives)) for what in (RIGHT, JUNCTIONS)))

    def rlas(row: tuple[Examined, str]) -> list[int]:
        return [robot.rlas_of[row[1]] for robot in row[0].outcomes]

    return table_of(
        _sentence(title),
        [(each, name) for each in groups for name in each.outcomes[0].rlas_of],
        ("task", lambda row: row[0].of.label),
        ("behaviour", lambda row: row[1]),
        ("RLAs, median", lambda row: f"{median(rlas(row)):g}"),
        ("quartiles", lambda row: _quartiles_text(rlas(row))),
        ("paper's RLAs", lambda row: row[0].of.settings.paper_rlas_of.get(row[1], "not told")),
        ("junctions right", lambda row: junctions(*row)),
        words=2,
    )


def growth_table(growth: GrowthStudy) -> Table:
    """Return the table of the median number of RLAs after some times, a row for each R (Fig. 2 of the paper)."""
    last_s = min(len(curve) for curves in growth.curves.values() for curve in curves)
    at_s = [time_s for time_s in _GROWTH_AT_S if time_s <= last_s] or [last_s]
    rows = []
    for radius, curves in growth.curves.items():
        cells = [f"{median(curve[time_s - 1] for curve in curves):g}" for time_s in at_s]
        rows.append((f"{radius:g}", str(len(curves)), *cells))
    how = ", plain reading" if growth.reading == "plain" else ""
    headings = ("R", "robots", *(f"{time_s} s" for time_s in at_s))
    return Table(f"RLAs against time in phase 1 ({growth.task}{how})", headings, tuple(rows), words=0, note="Medians.")


def unseen_table(group: Examined) -> Table:
    """Return the table of exams in generated worlds; without rows if there were none."""
    names = group.of.settings.unseen.names if group.of.settings.unseen is not None else ()
    drives = ((robot.seed, drive) for robot in group.outcomes for drive in robot.drives if drive.world in names)
    return table_of(
        f"{_sentence(group.of.label)}: unseen worlds",
        sorted(drives, key=lambda each: (names.index(each[1].world), each[0])),
        ("world", lambda each: each[1].world),
        ("robot", lambda each: each[0]),
        ("success", lambda each: _SUCCESS_WORDS.get(each[1].verdict, each[1].verdict.text)),
        ("collisions", lambda each: each[1].collisions),
        ("progress (teacher's own)", lambda each: f"{each[1].progress:.1f} ({_of_teacher(each[1])}) {each[1].unit}"),
        ("ended early", lambda each: each[1].early_end),
    )


def _of_teacher(drive: DriveRow) -> str:
    """His progress, and whether it is a measure."""
    teacher = drive.teacher
    assert teacher is not None
    return ", ".join(filter(None, (f"{teacher.progress:.1f}", teacher.why_no_measure)))


def _quartiles_text(values: Sequence[float]) -> str:
    return to_text(quartiles(values)[::2], "g")


def _sentence(title: str) -> str:
    return title[0].upper() + title[1:]


def learning_table(study: PaperStudy) -> Table:
    """Return the table of the learning settings of each task and reading."""

    def repositions(task: TaskSettings) -> str:
        return f"every {task.teaching.reposition_every_s:g} s" if task.teaching.reposition_every_s else "never"

    def rescues(task: TaskSettings) -> str:
        return f"after {task.teaching.rescue_after_s:g} s within {task.exam.stuck_within_m:g} m"

    def phases(task: TaskSettings) -> str:
        return f"{task.teaching.supervised_s:g} + {task.teaching.corrections_s:g}"

    def of_task(text: Callable[[TaskSettings], str]) -> Callable[[Examined], str]:
        return lambda each: text(each.of.task)

    return table_of(
        "Settings of learning and of the scripted teacher",
        study.experiments,
        ("task", lambda each: each.of.label),
        ("reading", lambda each: each.of.reading),
        ("R", of_task(lambda task: f"{task.learning.radius:g}")),
        ("weight of the averages", of_task(lambda task: f"{task.learning.history_weight:g}")),
        ("weights that are not 1", of_task(lambda task: _weights(task.learning.weights))),
        ("insert beyond, share of R", of_task(lambda task: f"{task.learning.insert_radius_fraction:g}")),
        ("an action lasts at least, s", of_task(lambda task: f"{task.learning.minimum_action_s:g}")),
        ("taught in", of_task(lambda task: task.teaching.world)),
        ("phases 1 + 2, s", of_task(phases)),
        ("teacher", of_task(lambda task: task.teaching.profile.name)),
        ("reaction, s", of_task(lambda task: f"{task.teaching.teacher.reaction_s:g}")),
        ("patience, s", of_task(lambda task: f"{task.teaching.teacher.patience_s:g}")),
        ("wrong answers", of_task(lambda task: f"{task.teaching.teacher.error_rate:.0%}")),
        ("rescues", of_task(rescues)),
        ("re-positions", of_task(repositions)),
        ("sets it down at", of_task(lambda task: _PLACES[task.teaching.reposition_to])),
        words=2,
    )


_PLACES = {"starts": "a start pose", "in_sight": "any place in sight"}


def exams_table(study: PaperStudy) -> Table:
    """Return the table of the exam settings of each task."""
    return table_of(
        "Settings of the exams",
        {each.of.task.name: each.of.task for each in study.experiments}.values(),
        ("task", lambda task: task.name.replace("_", " ")),
        ("starts at", lambda task: _PLACES[task.exam.start]),
        ("lasts, s", lambda task: f"{task.exam.duration_s:g}"),
        ("stuck after, s", lambda task: f"{task.exam.stuck_after_s:g}"),
        ("within, m", lambda task: f"{task.exam.stuck_within_m:g}"),
        ("collisions at most", lambda task: task.exam.success.collisions_at_most),
        ("of the teacher's progress at least", lambda task: f"{task.exam.success.progress_share:.0%}"),
        (
            "junctions right at least",
            lambda task: f"{task.exam.success.right_at_least:.0%}" if task.exam.success.right_at_least else "",
        ),
        note=SUCCESS,
    )


def _weights(weights: tuple[FeatureWeight, ...]) -> str:
    return "; ".join(f"{each.weight:g}: {', '.join(each.features)}" for each in weights) or "none"


def write_paper(study: PaperStudy, pictures: Sequence[SavedFigure], command: str, path: Path) -> None:
    """Write the report of a study with its pictures as an HTML page to `path`. Raises OSError.

    `command`: typed words, without those that belong to the machine alone.
    """
    extent, seeds = study.plan.about.extent, spans(study.plan.seeds)
    told = (
        "A simulated robot is taught each task by a scripted teacher, over the commands that a person uses, and then "
        f"examined without it, once per seed ({seeds}). A seed makes the robot with the spread of its sensors, its "
        "noise and its start. Next to our numbers stand those of section VII.1 of the paper, and those that were asked "
        "of this project. What is missed stands here as it came."
    )
    plain = (
        "The shipped settings first. In the plain reading of the paper all 72 values weigh 1, corrections only replace "
        "actions, and no action is held."
    )
    shared = (
        f"Shared among {ROBOTS} robots whose seeds follow each other: what a robot drives in follows from its own seed."
    )
    limits = (
        f"Lessons last at most {extent.most_teaching_s:g} s, " if extent.most_teaching_s else "",
        f"exams at most {extent.most_exam_s:g} s; " if extent.most_exam_s else "",
        "tasks, robots, worlds and radii are fewer.",
    )
    unseen = [table for each in study.experiments if (table := unseen_table(each)).rows]
    write_report(
        path,
        "KURT2: the paper's basic-level tasks, taught and examined",
        (
            Section("", (told,)),
            Section("Tables", (SUCCESS, *([plain] if len(study.readings) > 1 else ())), list(all_tables(study))),
            Section("Figures", pictures=pictures),
            *([Section("Generated worlds", (shared,), unseen)] if unseen else ()),
            Section("How this was made", tables=(learning_table(study), exams_table(study))),
        ),
        reasons=list(reasons_not_to_judge(study.plan)),
        extent="" if extent.is_whole else "".join(limits),
        command=command,
        footer=f"Seeds {seeds}. {{versions}}. Source: {{source}}. The same command with the same versions gives the "
        "same numbers on the same kind of machine. One robot's lessons: `kurt2rt knowledge show` with a file of the "
        "folder `knowledge` next to this report.",
    )
