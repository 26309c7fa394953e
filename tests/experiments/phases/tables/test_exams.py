"""How robots drive at each stage."""

from kurt2rt.experiments.phases.steps import BRANCHES, PATH, PHASE_2, TITLES
from kurt2rt.experiments.phases.tables.exams import exam_sheet
from tests.experiments.phases.outcomes import exam, stage, study, teaching
from tests.experiments.phases.tables.cells import cells


def test_every_stage_has_a_row_for_each_world() -> None:
    robots = [stage(PHASE_2, exam(), exam("c", succeeded=False, collisions=3), taught=teaching()) for _ in range(2)]
    sheet = exam_sheet("t", PATH, study(phase_2=robots), "")
    named = [row[0] for row in sheet.rows if row[0]]
    assert named == [TITLES[name] for name in PATH]
    second = cells(sheet, len(PATH) - 4 + 1)  # the row below phase 2 in A
    assert (second["stage"], second["world"], second["success"]) == ("", "C", "0 of 2")
    assert second["collisions in 10 min"] == "6.00"


def test_every_branch_is_beside_the_others() -> None:
    sheet = exam_sheet("t", BRANCHES, study(), "")
    assert [row[0] for row in sheet.rows] == [TITLES[name] for name in BRANCHES]
