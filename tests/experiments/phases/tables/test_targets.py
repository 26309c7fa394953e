"""What was asked, beside what came."""

from kurt2rt.experiments.phases.tables.targets import asked_sheet
from tests.experiments.phases.outcomes import study


def test_nothing_is_judged_where_there_is_a_reason_not_to() -> None:
    sheet = asked_sheet(study(), ["Too few."])
    assert {row[-1] for row in sheet.rows} == {"not judged"}
    assert sheet.note == "Not judged. Too few."
    judged = asked_sheet(study(), [])
    assert {row[-1] for row in judged.rows} <= {"met", "MISSED"}
