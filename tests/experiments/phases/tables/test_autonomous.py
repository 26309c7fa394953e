"""What happened while nobody taught."""

from kurt2rt.experiments.phases.steps import LONG_RUN
from kurt2rt.experiments.phases.tables.autonomous import long_run_sheet
from tests.experiments.phases.outcomes import stage, study, teaching
from tests.experiments.phases.tables.cells import cells


def test_why_somebody_had_to_come_is_told_apart() -> None:
    robots = [stage(LONG_RUN, taught=teaching(7200.0, collisions=1, rescues=3, unknown_rescues=2)) for _ in range(2)]
    row = cells(long_run_sheet(study(long_run=robots)), 0)
    assert (row["hours"], row["collisions"], row["stuck"], row["unknown for long"]) == ("4.0", "2", "2", "4")
    assert row["an hour"] == "2.00"
