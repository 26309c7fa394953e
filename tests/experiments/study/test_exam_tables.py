import re

from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.lesson import LessonCounts
from kurt2rt.experiments.study.exam_tables import exam_tables, lesson_table, seeds_tables
from kurt2rt.experiments.study.jobs import ExaminedOutcome
from tests.experiments.helpers import short_task
from tests.experiments.rows import MADE_OF, judged, lesson


def test_lesson_table_has_the_papers_numbers() -> None:
    table = lesson_table(lesson(7, rlas=88), short_task())
    assert {"wall_following", "a,", "7"} <= set(re.split(r"[ ]", table.title))
    assert table.rows[:2] == (("teacher", "superhuman", "a person"), ("RLAs", "88", "91"))
    assert table.rows[2][1:] == ("345", "345")
    assert table.rows[3:5] == (("asks", "41", ""), ("corrections", "52", ""))
    assert table.rows[-1][1:] == ("3", "")


def test_exam_tables_show_drive_and_measures() -> None:
    drives, measures = exam_tables([judged()], short_task())
    assert drives.rows == (("A", "8.00", "9.00", "0", "no", "3.4%", "yes"),)
    assert measures.rows == (("distance error, m", "0.05"),)
    stuck = next(exam_tables([judged(stuck=True, duration_s=123.0), judged(alarm="bus lost")], short_task()))
    assert [row[4::2] for row in stuck.rows] == [("after 123 s", "no"), ("bus lost after 300 s", "no")]


def robot(counts: LessonCounts, *drives: DriveRow) -> ExaminedOutcome:
    return ExaminedOutcome(made_of=MADE_OF, seed=counts.seed, lesson=counts, rlas_of={}, drives=drives)


def test_seeds_tables_leave_out_exams_not_judged() -> None:
    robots = [
        robot(lesson(seed), judged(world="a", teachers_laps=laps), judged(world="b", teachers_laps=0.0))
        for seed, laps in ((100, 9.0), (101, 0.0), (102, 20.0))
    ]
    seeds, _, success, _ = seeds_tables(robots, short_task())
    assert [re.findall(r"[\d.]+", cell) for cell in seeds.rows[1][5:]] == [["8.0", "0.0", "0"]] * 2
    assert success.rows == (
        ("A", "1 of 2, 1 not judged", "9% to 91%", "0", "0", "8.00", "3.4%"),
        ("B", "0 of 0, 3 not judged", "none", "0", "0", "8.00", "3.4%"),
    )


def test_seeds_tables_have_medians_quartiles_and_intervals() -> None:
    ends = (
        {"progress": 8.5},
        {"progress": 1.0, "stuck": True, "duration_s": 123.0},
        {"progress": 7.5, "collisions": 1},
    )
    robots = [
        robot(lesson(100 + place, rlas=80 + 10 * place), judged(world="a"), judged(world="b", **end))
        for place, end in enumerate(ends)
    ]
    seeds, medians, success, measures = seeds_tables(robots, short_task())
    assert seeds.rows[1][1:6] == ("90", "41", "52", "3", "8.0 of 9.0, 0")
    assert re.findall(r"[\d.]+", seeds.rows[1][6]) == ["1.0", "9.0", "0", "123"]
    assert seeds.rows[2] == ("102", "100", "41", "52", "3", "8.0 of 9.0, 0", "7.5 of 9.0, 1, failed")
    assert medians.rows[0] == ("RLAs", "90", "85 to 95", "91")
    assert medians.rows[-1][1:] == ("345", "345 to 345", "345")
    assert success.rows == (
        ("A", "3 of 3", "44% to 100%", "0", "0", "8.00", "3.4%"),
        ("B", "1 of 3", "6% to 79%", "1", "1", "7.50", "3.4%"),
    )
    assert measures.rows == (("distance error, m", "0.05", "0.05"),)
