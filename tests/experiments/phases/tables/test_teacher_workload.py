"""What the teacher had to do."""

from kurt2rt.experiments.phases.steps import REWARDS
from kurt2rt.experiments.phases.tables.teacher_workload import load_sheet
from tests.experiments.phases.outcomes import stage, study, teaching
from tests.experiments.phases.tables.cells import cells


def test_the_load_is_told_in_all_and_in_a_minute() -> None:
    sheet = load_sheet("t", (REWARDS,), study(rewards=[stage(REWARDS, taught=teaching(blame=30))]))
    row = cells(sheet, 0)
    assert (row["lasts, s"], row["answers"], row["corrections"]) == ("120", "4 (2.0)", "6 (3.0)")
    assert (row["rewards"], row["-1"], row["withdrawn"]) == ("30 (15.0)", "30", "3")
