"""Numbers in the tables, against results that were written by hand."""

import re
from collections.abc import Sequence
from typing import Any

import pytest
from rich.console import Console

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.paper.settings import WHOLE, load_paper
from kurt2rt.experiments.paper.study import Examined, Experiment, GrowthStudy, PaperExtent, PaperStudy
from kurt2rt.experiments.paper.tables import all_tables, paper_targets_table, unseen_table
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.experiments.study.table import Table, as_rich
from tests.experiments.rows import FAILED, MADE_OF, NOT_JUDGED, PASSED, lesson, row, titled


def drive(
    world: str = "a", *, passed: bool = True, teacher: dict[str, Any] | None = None, judged: bool = True, **more: Any
) -> DriveRow:
    verdict = NOT_JUDGED if not judged else PASSED if passed else FAILED
    return row(world, verdict, teacher=row(world, **{"progress": 9.0, **(teacher or {})}), **more)


def robot(seed: int, rlas: int, *drives: DriveRow, rlas_of: dict[str, int] | None = None) -> ExaminedOutcome:
    counts = lesson(seed, rlas=rlas)
    own = tuple(each.model_copy(update={"seed": seed}) for each in drives)
    return ExaminedOutcome(made_of=MADE_OF, seed=seed, lesson=counts, rlas_of=rlas_of or {}, drives=own)


def summary_of(task: str, robots: Sequence[ExaminedOutcome]) -> Examined:
    settings = next(each for each in load_paper().experiments if each.task == task)
    return Examined(Experiment(settings, "shipped", load_task(task)), tuple(robots))


def table_of(group: Examined, title: str, *growth: GrowthStudy) -> Table:
    plan = StudyPlan(PaperExtent(load_paper(), WHOLE), (100,), ())
    return titled(all_tables(PaperStudy(plan, (group,), growth)), title)


def verdicts_of(table: Table) -> dict[str, tuple[str, ...]]:
    return {row[1]: row[2:] for row in table.rows}


def test_success_and_collisions_come_with_intervals() -> None:
    robots = [
        robot(1, 80, drive("a"), drive("b", passed=False, collisions=3)),
        robot(2, 80, drive("a"), drive("b", passed=False, stuck=True, duration_s=150.0)),
        robot(3, 80, drive("a"), drive("b", collisions=0, duration_s=150.0)),
    ]
    a, b = table_of(summary_of("wall_following", robots), "Exams without").rows
    # Wilson's interval of 3 of 3; Poisson's exact upper end of no collision in 1.5 times 10 min.
    assert a == ("wall following", "A", "3 of 3", "44% to 100%", "0", "0", "0.00", "0.00 to 2.46")
    # 3 collisions in 600 s: drawn robots alone have none, or 3 in 300 s; Poisson's upper end is 8.77.
    assert b == ("wall following", "B", "1 of 3", "6% to 79%", "1", "1", "3.00", "0.00 to 8.77")


def test_junctions_are_counted_over_all_robots() -> None:
    def driven(junctions: float, right: float) -> dict[str, float]:
        return {"junctions": junctions, "junctions right": right, "lateral deviation, m": 0.03}

    robots = [
        robot(1, 130, drive("manhattan", findings=driven(50, 50))),
        robot(2, 140, drive("manhattan", findings=driven(30, 26))),
    ]
    table = table_of(summary_of("streets", robots), "Drives of")
    assert table.columns[-3:] == ("lateral deviation, m", "junctions right", "95 %")
    (row,) = table.rows
    assert row[:6] == ("streets", "manhattan", "8.0 laps", "9.0", "0, 0", "3.4%")
    assert row[6:8] == ("0.030", "95.0% of 80")
    assert row[8] == "86.7% to 100.0%"  # the second robot drawn twice, and the first


def test_comparisons_with_a_teacher_who_did_not_do_well_are_told() -> None:
    robots = [
        robot(1, 80, drive("a", teacher={"stuck": True}), drive("rooms-100")),
        robot(2, 80, drive("a", teacher={"collisions": 2}), drive("rooms-101", teacher={"alarm": "bus lost"})),
        robot(3, 80, drive("a"), drive("rooms-102", judged=False, teacher={"progress": 0.0})),
    ]
    summary = summary_of("wall_following", robots)
    table = table_of(summary, "Drives of")
    assert table.columns[4] == "failed, nowhere"
    assert [row[4] for row in table.rows] == ["2, 0", "1, 1"]
    told = [row[4] for row in unseen_table(summary).rows]
    assert [re.findall(r"[\d.]+", each) for each in told] == [["8.0", "9.0"], ["8.0", "9.0"], ["8.0", "0.0"]]
    assert ["failed" in each for each in told] == [False, True, False]
    assert ["nowhere" in each for each in told] == [False, False, True]


def test_exams_without_a_measure_count_neither_way() -> None:
    robots = [
        robot(1, 80, drive("a"), drive("b", judged=False), drive("rooms-100", judged=False)),
        robot(2, 80, drive("a", judged=False), drive("b", judged=False)),
        robot(3, 80, drive("a", passed=False), drive("b", judged=False)),
    ]
    summary = summary_of("wall_following", robots)
    a, b, _ = table_of(summary, "Exams without").rows
    assert (a[1], re.findall(r"\d+", a[2]), a[3]) == ("A", ["1", "2", "1"], "9% to 91%")
    assert (b[1], re.findall(r"\d+", b[2]), b[3]) == ("B", ["0", "0", "3"], "")
    assert [row[2] for row in unseen_table(summary).rows] == ["not judged"]
    table = paper_targets_table([summary], "What was asked")
    said = verdicts_of(table)
    assert (said["success in A"][1], said["success in A"][2]) == (a[2], "MISSED")
    assert (said["success in B"][1], said["success in B"][2]) == (b[2], "not judged")


def test_behaviour_table_has_the_papers_parts() -> None:
    found = {
        "junctions": 9.0,
        "junctions right": 8.0,
        "junctions, turn_left": 4.0,
        "junctions right, turn_left": 3.0,
        "junctions, straight_on": 5.0,
        "junctions right, straight_on": 5.0,
    }
    of = {"straight_on": 70, "turn_left": 40}
    robots = [robot(seed, 110, drive("manhattan", findings=found), rlas_of=of) for seed in (1, 2)]
    table = table_of(summary_of("streets", robots), "Taught in common")
    assert table.rows == (
        ("streets", "straight_on", "70", "70 to 70", "71", "10 of 10"),
        ("streets", "turn_left", "40", "40 to 40", "43", "6 of 8"),
    )


def test_targets_table_marks_missed_targets() -> None:
    robots = [
        robot(seed, 92, drive("a"), drive("b", passed=seed < 18), drive("c", passed=seed < 17)) for seed in range(20)
    ]
    table = paper_targets_table([summary_of("wall_following", robots)], "What was asked")
    assert {name: (*re.findall(r"\d+", asked), *rest) for name, (asked, *rest) in verdicts_of(table).items()} == {
        "RLAs, median": ("91", "92", "MISSED"),
        "teaching": ("345", "345 s", "met"),
        "success in A": ("19", "20", "20 of 20", "met"),
        "success in B": ("18", "20", "18 of 20", "met"),
        "success in C": ("18", "20", "17 of 20", "MISSED"),
    }
    assert table.note.startswith("3 of 5 ")
    console = Console(width=100, no_color=True)
    with console.capture() as capture:
        console.print(as_rich(table))
    assert capture.get().count("MISSED") == 2


@pytest.mark.parametrize(("right", "collisions", "verdicts"), [(95, 0, ("met", "met")), (94, 1, ("MISSED", "MISSED"))])
def test_streets_are_judged_by_junctions_and_collisions(right: int, collisions: int, verdicts: tuple[str, str]) -> None:
    found = {"junctions": 100.0, "junctions right": float(right)}
    robots = [robot(1, 130, drive("manhattan", collisions=collisions, duration_s=600.0, findings=found))]
    said = verdicts_of(paper_targets_table([summary_of("streets", robots)], "What was asked"))
    assert said["junctions right in manhattan"] == ("at least 95%", f"{right}.0% of 100", verdicts[0])
    assert said["collisions in 10 min in manhattan"] == ("below 0.5", f"{collisions:.2f}", verdicts[1])


def test_growth_is_told_at_the_times_of_the_study() -> None:
    curves = {radius: [tuple(range(seed, seed + 130)) for seed in (1, 2, 3)] for radius in (150.0, 300.0)}
    table = table_of(
        summary_of("circle", [robot(1, 20, drive())]), "RLAs against", GrowthStudy("plain", "wall_following", curves)
    )
    assert table.columns == ("R", "robots", "60 s", "120 s")
    assert table.rows == (("150", "3", "61", "121"), ("300", "3", "61", "121"))
