"""What the critic was taught."""

from kurt2rt.experiments.phases.tables.critic import critic_sheet
from tests.experiments.phases.outcomes import stage, study, teaching
from tests.experiments.phases.tables.cells import cells


def test_a_critic_of_which_too_little_was_heard_says_so() -> None:
    told = study(2)
    row = cells(critic_sheet(told), 0)
    assert (row["agreement at its end"], row["trusted"], row["undone"]) == ("0.90", "2 of 2", "1")
    silent = study(phase_4=[stage("phase-4", taught=teaching(agreement=(None, None))) for _ in range(2)])
    assert cells(critic_sheet(silent), 0)["agreement at its end"] == "too little heard"


def test_agreement_is_told_of_phase_4_alone() -> None:
    rows = critic_sheet(study()).rows
    assert [bool(row[2]) for row in rows] == [True, *[False] * 4]
