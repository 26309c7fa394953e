"""Tables of the teaching."""

import re

from kurt2rt.experiments.phases.steps import ASKS, CORRUPTED, LONG_RUN, REWARDS, TITLES, UNKNOWN_BAD
from kurt2rt.experiments.phases.training_tables import critic_table, long_run_table, words_of_controls, workload_table
from tests.experiments.phases.outcomes import cells, exam, stage, study, teaching


def test_why_somebody_had_to_come_is_told_apart() -> None:
    robots = [stage(LONG_RUN, taught=teaching(7200.0, collisions=1, rescues=3, unknown_rescues=2)) for _ in range(2)]
    row = cells(long_run_table(study(long_run=robots)), 0)
    assert (row["hours"], row["collisions"], row["stuck"], row["unknown for long"]) == ("4.0", "2", "2", "4")
    assert row["an hour"] == "2.00"


def test_a_control_that_equals_another_is_said_to() -> None:
    words = list(words_of_controls(study(2)))
    assert any(each.startswith(f"{TITLES[UNKNOWN_BAD]}: 2 of 2 ") for each in words)
    equal = [each for each in words if each.startswith(f"{TITLES[ASKS]}: ")]
    assert len(equal) == 1
    assert TITLES[CORRUPTED] in equal[0]
    silent = [stage(ASKS, exam(progress=7.0), taught=teaching().model_copy(update={"asks": 0})) for _ in range(2)]
    words = list(words_of_controls(study(2, asks_only=silent)))
    (said,) = (each for each in words if each.startswith(f"{TITLES[ASKS]}: "))
    assert TITLES[CORRUPTED] not in said


def test_a_critic_of_which_too_little_was_heard_says_so() -> None:
    told = study(2)
    row = cells(critic_table(told), 0)
    assert (row["agreement at its end"], row["trusted"], row["undone"]) == ("0.90", "2 of 2", "1")
    silent = study(phase_4=[stage("phase-4", taught=teaching(agreement=(None, None))) for _ in range(2)])
    assert not re.search(r"\d", cells(critic_table(silent), 0)["agreement at its end"])


def test_agreement_is_told_of_phase_4_alone() -> None:
    rows = critic_table(study()).rows
    assert [bool(row[2]) for row in rows] == [True, *[False] * 4]


def test_the_load_is_told_in_all_and_in_a_minute() -> None:
    table = workload_table("t", (REWARDS,), study(rewards=[stage(REWARDS, taught=teaching(blame=30))]))
    row = cells(table, 0)
    assert (row["lasts, s"], row["answers"], row["corrections"]) == ("120", "4 (2.0)", "6 (3.0)")
    assert (row["rewards"], row["-1"], row["withdrawn"]) == ("30 (15.0)", "30", "3")
