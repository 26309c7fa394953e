"""The tables of the results section."""

from collections.abc import Iterator, Sequence

from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from kurt2rt.experiments.lockstep.exam_verdict import EXAM_VERDICT_TEXTS, ExamVerdict
from kurt2rt.experiments.lockstep.report import quartiles
from kurt2rt.experiments.paper.eligibility import reasons_not_to_judge
from kurt2rt.experiments.paper.outcome import DriveOutcome
from kurt2rt.experiments.paper.settings_tables import SUCCESS
from kurt2rt.experiments.paper.summary import (
    GrowthStudy,
    PaperStudy,
    PaperSummary,
    Quartiles,
    WorldSummary,
    success_text,
)
from kurt2rt.experiments.paper.verdicts import verdicts
from kurt2rt.experiments.study.table import Table
from kurt2rt.experiments.study.targets_table import targets_table

_SUCCESS_WORDS = {**EXAM_VERDICT_TEXTS, ExamVerdict.PASSED: "yes", ExamVerdict.FAILED: "NO"}
_GROWTH_AT_S = (60, 120, 200, 345, 600)
_OF_RATES = (
    "Its interval is the wider at each end of Poisson's exact one and a bootstrap over robots; in generated worlds "
    "over drives, of which one robot has several."
)


def all_tables(study: PaperStudy) -> Iterator[Table]:
    """Yield all tables, reading by reading."""
    reasons = list(reasons_not_to_judge(study.plan))
    for reading in study.readings:
        summaries = study.of(reading)
        how = "" if reading == "shipped" else "plain reading: "
        yield paper_targets_table(summaries, f"{how}what was asked", reasons)
        yield knowledge_table(summaries, f"{how}what was taught")
        yield exam_table(summaries, f"{how}exams without teacher")
        yield drive_table(summaries, f"{how}drives of these exams")
        if any(each.rlas_of for each in summaries):
            yield behaviour_table(summaries, f"{how}taught in common")
    for growth in study.growth:
        yield growth_table(growth)


def paper_targets_table(summaries: Sequence[PaperSummary], title: str, not_judged_because: Sequence[str] = ()) -> Table:
    """Return the table of all targets with their results, a row for each.

    `not_judged_because`: reasons against judging; with any, all results are `not judged`.
    """
    return targets_table(
        [((each.label,), verdict) for each in summaries for verdict in verdicts(each)],
        not_judged_because,
        title=_sentence(title),
        headings=("task",),
        note_without_targets="Of these tasks nothing is asked.",
    )


def knowledge_table(summaries: Sequence[PaperSummary], title: str) -> Table:
    """Return the table of RLAs and teaching time, with the paper's numbers."""
    rows = [
        (
            each.label,
            f"{each.rlas.median:g}",
            _span(each.rlas),
            str(each.task.paper.rlas),
            f"{each.teaching_s:g}",
            each.task.paper.teaching_time_text,
            f"{each.asks:g}",
            f"{each.corrections:g}",
            f"{each.rescues:g}",
        )
        for each in summaries
    ]
    return Table(
        _sentence(title),
        ("task", "RLAs", "quartiles", "paper", "teaching, s", "paper", "asks", "corrections", "rescues"),
        tuple(rows),
        note=f"{_robots(summaries)} RLAs, asks, corrections and rescues by hand are medians. Teaching in robot time. "
        f"Taught by the scripted teacher {' or '.join(_teachers(summaries))}.",
    )


def _teachers(summaries: Sequence[PaperSummary]) -> list[str]:
    return sorted({each.task.teaching.profile.name for each in summaries})


def exam_table(summaries: Sequence[PaperSummary], title: str) -> Table:
    """Return the table of success and collisions by world."""
    rows = []
    for each, world in _worlds(summaries):
        interval = "" if world.interval is None else "{:.0%} to {:.0%}".format(*world.interval)
        rate = world.collisions
        rows.append(
            (
                each.label,
                world.label,
                success_text(world),
                interval,
                str(world.ended_early),
                str(world.collided),
                f"{rate.value:.2f}",
                f"{rate.low:.2f} to {rate.high:.2f}",
            )
        )
    times = sorted({each.task.exam.duration_s for each in summaries})
    return Table(
        _sentence(title),
        ("task", "world", "success", "95 %", "stuck", "collided", "in 10 min", "95 %"),
        tuple(rows),
        words=2,
        note=f"Exams of {' or '.join(f'{time_s:g}' for time_s in times)} s. {SUCCESS} Wilson's interval. Stuck: or "
        "stopped by the guard for good. Collided: drives with any collision. In 10 min: collisions of all drives. "
        f"{_OF_RATES}",
    )


def drive_table(summaries: Sequence[PaperSummary], title: str) -> Table:
    """Return the table of progress and measures by world."""
    names = list(dict.fromkeys(name for _, world in _worlds(summaries) for name in world.lengths))
    rows = []
    for each, world in _worlds(summaries):
        right = world.right
        of_junctions = "" if right is None else f"{right.value:.1%} of {world.junctions}"
        interval = "" if right is None else f"{right.low:.1%} to {right.high:.1%}"
        rows.append(
            (
                each.label,
                world.label,
                f"{world.progress:.1f} {world.unit}",
                f"{world.teachers_progress:.1f}",
                f"{world.teacher_failed}, {world.teacher_got_nowhere}",
                f"{world.share_unknown:.1%}",
                *(f"{world.lengths[name]:.3f}" if name in world.lengths else "" for name in names),
                of_junctions,
                interval,
            )
        )
    return Table(
        _sentence(title),
        ("task", "world", "progress", "teacher's own", "failed, nowhere", "unknown", *names, "junctions right", "95 %"),
        tuple(rows),
        words=2,
        note="Medians, but for the junctions, which are those of all drives. A junction that the robot was asked for "
        "and did not get through, because it got stuck, was stopped for good or turned back, was not left as asked. "
        f"{_OF_RATES} Failed: so many of the teacher's own drives collided, got stuck or were stopped by the guard for "
        "good. Nowhere: so many made too little progress to measure another drive by. "
        "Unknown: share of the time in which the robot did not know the situation.",
    )


def behaviour_table(summaries: Sequence[PaperSummary], title: str) -> Table:
    """Return the table of RLAs and junctions by behaviour."""
    rows = []
    for each in summaries:
        for name, rlas in each.rlas_of.items():
            paper = each.settings.paper_rlas_of.get(name)
            drives = [drive for outcome in each.outcomes for drive in outcome.drives]
            passed = sum(drive.findings.get(f"{JUNCTIONS}, {name}", 0.0) for drive in drives)
            right = sum(drive.findings.get(f"{RIGHT}, {name}", 0.0) for drive in drives)
            rows.append(
                (
                    each.label,
                    name,
                    f"{rlas.median:g}",
                    _span(rlas),
                    "not told" if paper is None else str(paper),
                    f"{right:.0f} of {passed:.0f}",
                )
            )
    columns = ("task", "behaviour", "RLAs, median", "quartiles", "paper's RLAs", "junctions right")
    return Table(_sentence(title), columns, tuple(rows), words=2)


def growth_table(growth: GrowthStudy) -> Table:
    """Return the table of the median number of RLAs after some times, a row for each R (Fig. 2 of the paper)."""
    last_s = min(len(each.growth) for each in growth.outcomes)
    at_s = [time_s for time_s in _GROWTH_AT_S if time_s <= last_s] or [last_s]
    rows = []
    for radius in growth.radii:
        curves = growth.curves(radius)
        cells = [f"{quartiles([curve[time_s - 1] for curve in curves])[1]:g}" for time_s in at_s]
        rows.append((f"{radius:g}", str(len(curves)), *cells))
    how = ", plain reading" if growth.reading == "plain" else ""
    return Table(
        f"RLAs against time in phase 1 ({growth.task}{how})",
        ("R", "robots", *(f"{time_s} s" for time_s in at_s)),
        tuple(rows),
        words=0,
        note="Medians.",
    )


def unseen_table(summary: PaperSummary) -> Table:
    """Return the table of exams in generated worlds; without rows if there were none."""
    names = summary.settings.unseen.names if summary.settings.unseen is not None else ()
    drives = sorted(
        (names.index(drive.world), outcome.seed, drive)
        for outcome in summary.outcomes
        for drive in outcome.drives
        if drive.world in names
    )
    rows = []
    for place, seed, drive in drives:
        early = drive.alarm or ("stuck" if drive.stuck else "")
        rows.append(
            (
                names[place],
                f"{seed}",
                _SUCCESS_WORDS[drive.verdict],
                str(drive.collisions),
                f"{drive.progress:.1f} ({_of_teacher(drive)}) {drive.unit}",
                f"{early} after {drive.duration_s:.0f} s" if early else "",
            )
        )
    columns = ("world", "robot", "success", "collisions", "progress (teacher's own)", "ended early")
    return Table(f"{_sentence(summary.label)}: unseen worlds", columns, tuple(rows))


def _of_teacher(drive: DriveOutcome) -> str:
    """His progress, and whether it is a measure."""
    how = ", got nowhere" if drive.teacher_got_nowhere else ", failed" if drive.teacher_failed else ""
    return f"{drive.teachers_progress:.1f}{how}"


def _worlds(summaries: Sequence[PaperSummary]) -> Iterator[tuple[PaperSummary, WorldSummary]]:
    return ((each, world) for each in summaries for world in each.worlds)


def _robots(summaries: Sequence[PaperSummary]) -> str:
    robots = max(each.robots for each in summaries)
    return f"{robots} robots for each task." if robots > 1 else "One robot for each task."


def _span(values: Quartiles) -> str:
    return f"{values.low:g} to {values.high:g}"


def _sentence(title: str) -> str:
    return title[0].upper() + title[1:]
