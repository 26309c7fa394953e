"""How the teacher drives himself."""

from dataclasses import replace

from kurt2rt.experiments.phases.tables.teachers import teachers_sheet
from tests.experiments.phases.outcomes import exam, study
from tests.experiments.phases.tables.cells import cells


def test_where_the_teacher_failed_himself_stands_beside_what_he_reaches() -> None:
    told = replace(study(3), teachers=((exam(),), (exam(succeeded=False, collisions=1),), (exam(progress=9.0),)))
    row = cells(teachers_sheet(told), 0)
    assert (row["without fault"], row["seeds that failed"], row["progress"]) == ("2 of 3", "101", "8.0 laps")
