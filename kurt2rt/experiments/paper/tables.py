"""Tables of the paper study with its verdicts, and its report."""

from collections.abc import Callable, Iterable, Iterator, Sequence

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict, label_of
from kurt2rt.experiments.paper.figures import draw_figures
from kurt2rt.experiments.paper.settings import AskedSettings
from kurt2rt.experiments.paper.study import (
    Examined,
    Experiment,
    GrowthStudy,
    PaperExtent,
    PaperStudy,
    TaughtJob,
    read_study,
)
from kurt2rt.experiments.study.exam_tables import (
    COLLIDED,
    PROGRESS,
    RIGHT_COLUMNS,
    STUCK,
    SUCCESS,
    UNKNOWN,
    Drives,
    collision_columns,
    measure_column,
    measure_text,
    right_text,
    success_text,
)
from kurt2rt.experiments.study.intervals import collisions_in_10_min, quartiles, right_rate
from kurt2rt.experiments.study.report import TO_SEE_LESSONS, Section, spans, tell_with_report
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import (
    ROBOTS,
    Column,
    Table,
    Told,
    Verdict,
    median,
    middle,
    most,
    needed_of,
    of_text,
    quarters,
    reasons_against_judging,
    settings_table,
    table_of,
    targets_table,
    to_text,
)
from simbridge.contracts.simulation import SimulationFactory

CHOSEN_ON_ROOMS = range(60)
"""Seeds of generated rooms that settings were searched on."""
SUCCESS_NOTE = (
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


def reasons_not_to_judge(plan: StudyPlan[PaperExtent]) -> Iterator[str]:
    """Yield the reasons against judging; none for a whole study with enough new robots and worlds."""
    extent = plan.about.extent
    if not extent.is_whole:
        limits = {"Lessons": extent.most_teaching_s, "Exams": extent.most_exam_s}
        told = "".join(f" {what} last at most {most_s:g} s." for what, most_s in limits.items() if most_s)
        yield f"A part only: it says that everything works, and nothing about the paper.{told}"
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


def worlds_of(group: Examined) -> Iterator[Drives[Experiment]]:
    """Yield the drives of an experiment in each world and, under a label, in all generated ones, if there are any."""
    drives = [drive for robot in group.rows for drive in robot.drives]
    for world in group.of.task.exam.worlds:
        if own := tuple(each for each in drives if each.world == world):
            yield Drives(group.of, world, own, is_first=False)
    unseen = group.of.settings.unseen
    generated = tuple(each for each in drives if unseen is not None and each.world in unseen.names)
    if unseen is not None and generated:
        driven = len({each.world for each in generated})
        span = f"{unseen.names[0]}..{unseen.first + unseen.count - 1}"
        yield Drives(group.of, span if driven == unseen.count else f"{driven} of {span}", generated, is_first=False)


def verdicts(group: Examined) -> Iterator[Verdict]:
    """Yield the verdict on each target of the experiment."""
    asked, unseen = group.of.settings.asked, group.of.settings.unseen
    if asked.rlas_at_most:
        rlas = median(each.lesson.rlas for each in group.rows)
        yield Verdict("RLAs, median", f"at most {asked.rlas_at_most}", f"{rlas:g}", rlas <= asked.rlas_at_most)
    paper_s = group.of.task.paper.teaching_s
    if asked != AskedSettings() and paper_s:
        taught_s = max(each.lesson.teaching_s for each in group.rows)
        yield Verdict("teaching", f"at most {paper_s:g} s", f"{taught_s:g} s", taught_s <= paper_s)
    for each in worlds_of(group):
        label = label_of(each.world)
        of_unseen = unseen.success_at_least if unseen is not None else None
        share = asked.success_at_least.get(each.world) if each.world in group.of.task.exam.worlds else of_unseen
        if share is not None:
            needed, judged = needed_of(share, each.judged), each.judged > 0
            at_least, met = f"at least {of_text(needed, each.judged)}", judged and each.passed >= needed
            yield Verdict(f"success in {label}", at_least, success_text(each.rows), met, judged)
        if asked.right_at_least:
            right, came = right_rate(each.rows), right_text(each.rows) or "no junction"
            met = right is not None and right.value >= asked.right_at_least
            yield Verdict(f"junctions right in {label}", f"at least {asked.right_at_least:.0%}", came, met)
        if asked.collisions_below_per_10_min:
            limit, rate = asked.collisions_below_per_10_min, collisions_in_10_min(each.rows).value
            yield Verdict(f"collisions in 10 min in {label}", f"below {limit:g}", f"{rate:.2f}", rate < limit)


def all_tables(study: PaperStudy) -> Iterator[Table]:
    """Yield all tables, reading by reading."""
    reasons = list(reasons_not_to_judge(study.plan))
    for reading in study.readings:
        groups = study.of(reading)
        how = ", plain reading" if reading == "plain" else ""
        yield paper_targets_table(groups, f"What was asked{how}", reasons)
        yield _knowledge_table(groups, f"What was taught{how}")
        worlds = [world for group in groups for world in worlds_of(group)]
        yield _exam_table(worlds, f"Exams without teacher{how}")
        yield _drive_table(worlds, f"Drives of these exams{how}")
        if any(robot.rlas_of for each in groups for robot in each.rows):
            yield _behaviour_table(groups, f"Taught in common{how}")
    yield from map(_growth_table, study.growth)


def paper_targets_table(groups: Sequence[Examined], title: str, not_judged_because: Sequence[str] = ()) -> Table:
    """Return the table of all targets with their results; with reasons against judging, none is judged."""
    return targets_table(
        [((each.of.label,), verdict) for each in groups for verdict in verdicts(each)],
        not_judged_because,
        title=title,
        headings=("task",),
        note_without_targets="Of these tasks nothing is asked.",
    )


_TASK: Column = ("task", lambda each: each.of.label)
_IN_WORLD: tuple[Column, ...] = (_TASK, ("world", lambda each: label_of(each.world)))


def _knowledge_table(groups: Sequence[Examined], title: str) -> Table:
    robots = max(len(each.rows) for each in groups)
    teachers = sorted({each.of.task.teaching.profile.name for each in groups})
    return table_of(
        title,
        groups,
        _TASK,
        middle("RLAs", "lesson.rlas"),
        quarters("lesson.rlas"),
        ("paper", lambda each: each.of.task.paper.rlas),
        most("teaching, s", "lesson.teaching_s"),
        ("paper", lambda each: each.of.task.paper.teaching_time_text),
        *(middle(name, f"lesson.{name}") for name in ("asks", "corrections", "rescues")),
        note=f"{f'{robots} robots' if robots > 1 else 'One robot'} for each task. RLAs, asks, corrections and rescues "
        f"by hand are medians. Teaching in robot time. Taught by the scripted teacher {' or '.join(teachers)}.",
    )


def _exam_table(worlds: Sequence[Drives[Experiment]], title: str) -> Table:
    times = sorted({each.of.task.exam.duration_s for each in worlds})
    return table_of(
        title,
        worlds,
        *_IN_WORLD,
        *SUCCESS,
        STUCK,
        COLLIDED,
        *collision_columns("in 10 min"),
        words=2,
        note=f"Exams of {' or '.join(f'{time_s:g}' for time_s in times)} s. {SUCCESS_NOTE} Wilson's interval. Stuck: "
        "or stopped by the guard for good. Collided: drives with any collision. In 10 min: collisions of all drives. "
        f"{_OF_RATES}",
    )


def _drive_table(worlds: Sequence[Drives[Experiment]], title: str) -> Table:
    found = (name for world in worlds for each in world.rows for name in each.findings)
    names = [name for name in dict.fromkeys(found) if not name.startswith(JUNCTIONS)]

    def teachers(world: Drives[Experiment]) -> list[DriveRow]:
        return [each.teacher for each in world.rows if each.teacher is not None]

    def failed(world: Drives[Experiment]) -> str:
        drives = teachers(world)
        return f"{sum(each.failed for each in drives)}, {sum(each.got_nowhere for each in drives)}"

    return table_of(
        title,
        worlds,
        *_IN_WORLD,
        PROGRESS,
        ("teacher's own", lambda world: f"{median(each.progress for each in teachers(world)):.1f}"),
        ("failed, nowhere", failed),
        UNKNOWN,
        *map(measure_column, names),
        *RIGHT_COLUMNS,
        words=2,
        note="Medians, but for the junctions, which are those of all drives. A junction that the robot was asked for "
        "and did not get through, because it got stuck, was stopped for good or turned back, was not left as asked. "
        f"{_OF_RATES} Failed: so many of the teacher's own drives collided, got stuck or were stopped by the guard for "
        "good. Nowhere: so many made too little progress to measure another drive by. "
        "Unknown: share of the time in which the robot did not know the situation.",
    )


def _behaviour_table(groups: Sequence[Examined], title: str) -> Table:
    def junctions(each: Examined, name: str) -> str:
        drives = [drive.findings for robot in each.rows for drive in robot.drives]
        return of_text(*(round(sum(of.get(f"{what}, {name}", 0.0) for of in drives)) for what in (RIGHT, JUNCTIONS)))

    def rlas(row: tuple[Examined, str]) -> list[int]:
        return [robot.rlas_of[row[1]] for robot in row[0].rows]

    return table_of(
        title,
        [(each, name) for each in groups for name in each.rows[0].rlas_of],
        ("task", lambda row: row[0].of.label),
        ("behaviour", lambda row: row[1]),
        ("RLAs, median", lambda row: f"{median(rlas(row)):g}"),
        ("quartiles", lambda row: to_text(quartiles(rlas(row))[::2], "g")),
        ("paper's RLAs", lambda row: row[0].of.settings.paper_rlas_of.get(row[1], "not told")),
        ("junctions right", lambda row: junctions(*row)),
        words=2,
    )


def _passed_text(groups: Sequence[Examined]) -> str:
    return success_text([drive for group in groups for robot in group.rows for drive in robot.drives])


def _short_table(study: PaperStudy, *, judged: bool) -> Table:
    """Return a row for each task in each reading, for a terminal."""

    def met(group: Examined) -> str:
        found = [each.met for each in verdicts(group) if each.judged]
        return of_text(sum(found), len(found)) if found and judged else "not judged" if found else "nothing"

    return table_of(
        "What was asked, and what came",
        study.experiments,
        _TASK,
        ("settings", lambda each: each.of.reading),
        middle("RLAs", "lesson.rlas"),
        ("paper", lambda each: each.of.task.paper.rlas),
        most("lesson, s", "lesson.teaching_s"),
        ("paper", lambda each: each.of.task.paper.teaching_time_text),
        ("exams passed", lambda each: _passed_text([each])),
        ("asked, met", met),
        words=2,
    )


def _growth_table(growth: GrowthStudy) -> Table:
    last_s = min(len(curve) for curves in growth.curves.values() for curve in curves)
    at_s = [time_s for time_s in _GROWTH_AT_S if time_s <= last_s] or [last_s]

    def rlas(time_s: int) -> Callable[[tuple[float, list[tuple[int, ...]]]], str]:
        return lambda row: f"{median(curve[time_s - 1] for curve in row[1]):g}"

    return table_of(
        f"RLAs against time in phase 1 ({growth.task}{', plain reading' if growth.reading == 'plain' else ''})",
        growth.curves.items(),
        ("R", lambda row: f"{row[0]:g}"),
        ("robots", lambda row: len(row[1])),
        *((f"{time_s} s", rlas(time_s)) for time_s in at_s),
        words=0,
        note="Medians.",
    )


def unseen_table(group: Examined) -> Table:
    """Return the table of exams in generated worlds; without rows if there were none."""
    names = group.of.settings.unseen.names if group.of.settings.unseen is not None else ()
    drives = (drive for robot in group.rows for drive in robot.drives if drive.world in names)
    return table_of(
        f"{group.of.label.capitalize()}: unseen worlds",
        sorted(drives, key=lambda each: (names.index(each.world), each.seed)),
        ("world", lambda each: each.world),
        ("robot", lambda each: each.seed),
        ("success", lambda each: _SUCCESS_WORDS.get(each.verdict, each.verdict.text)),
        ("collisions", lambda each: each.collisions),
        ("progress of teacher's own", lambda each: f"{each.progress:.1f} of {measure_text(each, '.1f')} {each.unit}"),
        ("ended early", lambda each: each.early_end),
    )


def _settings_table(experiments: Iterable[Experiment]) -> Table:
    """Return the settings of each experiment; of the scripted teacher's person its name stands for all."""
    parts, left_out = {"learning", "teaching", "exam"}, {"teaching": {"profile": {"person"}}}
    return settings_table(
        "Settings of learning, of the scripted teacher and of the exams",
        {
            f"{each.label}, {each.reading}": each.task.model_dump(mode="json", include=parts, exclude=left_out)
            for each in experiments
        },
    )


def tell(plan: StudyPlan[PaperExtent], factory: SimulationFactory, command: str) -> Told:
    """Write figures and report into the folder of the results; return the tables. Raises StudyError, OSError.

    `factory`: draws the worlds. `command`: typed words, without those that belong to the machine alone.
    """
    study, folder = read_study(plan), plan.results.folder
    tables, reasons = list(all_tables(study)), list(reasons_not_to_judge(plan))
    about = (
        "A simulated robot is taught each task by a scripted teacher, over the commands that a person uses, and then "
        f"examined without it, once per seed ({spans(plan.seeds)}). A seed makes the robot with the spread of its "
        "sensors, its noise and its start. Next to our numbers stand those of section VII.1 of the paper, and those "
        "that were asked of this project. What is missed stands here as it came."
    )
    plain = (
        "The shipped settings first. In the plain reading of the paper all 72 values weigh 1, corrections only replace "
        "actions, and no action is held."
    )
    shared = (
        f"Shared among {ROBOTS} robots whose seeds follow each other: what a robot drives in follows from its own seed."
    )
    unseen = [table for each in study.experiments if (table := unseen_table(each)).rows]
    passed = "; ".join(f"{each} settings {_passed_text(study.of(each))}" for each in study.readings)
    met = "" if reasons else f"{tables[0].note} "
    told = Told(
        tables,
        f"{met}Exams passed without a teacher: {passed}.",
        (about, SUCCESS_NOTE, *([plain] if len(study.readings) > 1 else ())),
        _short_table(study, judged=not reasons),
        reasons,
    )
    more = [
        *([Section("Generated worlds", (shared,), unseen)] if unseen else ()),
        Section("Settings", tables=(_settings_table(each.of for each in study.experiments),)),
    ]
    title, pictures = "KURT2: the paper's basic-level tasks, taught and examined", draw_figures(study, factory, folder)
    return tell_with_report(folder, title, told, command, list(pictures), more, TO_SEE_LESSONS)
