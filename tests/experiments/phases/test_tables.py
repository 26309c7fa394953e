"""Tables of exams, teachers and targets."""

from dataclasses import replace

from kurt2rt.experiments.phases.steps import BRANCHES, PATH, PHASE_2, TITLES
from kurt2rt.experiments.phases.tables import exam_table, phases_targets_table, teachers_table
from tests.experiments.phases.outcomes import cells, exam, stage, study, teaching


def test_every_stage_has_a_row_for_each_world() -> None:
    robots = [stage(PHASE_2, exam(), exam("c", succeeded=False, collisions=3), taught=teaching()) for _ in range(2)]
    table = exam_table("t", PATH, study(phase_2=robots), "")
    named = [row[0] for row in table.rows if row[0]]
    assert named == [TITLES[name] for name in PATH]
    second = cells(table, len(PATH) - 4 + 1)  # the row below phase 2 in A
    assert (second["stage"], second["world"], second["success"]) == ("", "C", "0 of 2")
    assert second["collisions in 10 min"] == "6.00"


def test_every_branch_is_beside_the_others() -> None:
    table = exam_table("t", BRANCHES, study(), "")
    assert [row[0] for row in table.rows] == [TITLES[name] for name in BRANCHES]


def test_nothing_is_judged_where_there_is_a_reason_not_to() -> None:
    table = phases_targets_table(study(), ["Too few."])
    assert {row[-1] for row in table.rows} == {"not judged"}
    assert table.note.endswith("Too few.")
    judged = phases_targets_table(study(), [])
    assert {row[-1] for row in judged.rows} <= {"met", "MISSED"}


def test_teachers_table_names_failed_seeds() -> None:
    told = replace(study(3), teachers=((exam(),), (exam(succeeded=False, collisions=1),), (exam(progress=9.0),)))
    row = cells(teachers_table(told), 0)
    assert (row["without fault"], row["seeds that failed"], row["progress"]) == ("2 of 3", "101", "8.0 laps")
