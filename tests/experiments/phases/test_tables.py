"""The tables, of outcomes that are known."""

from dataclasses import replace

from kurt2rt.experiments.phases.steps import ASKS, BRANCHES, LONG_RUN, PATH, PHASE_2, REWARDS, TITLES
from kurt2rt.experiments.phases.tables import (
    asked_sheet,
    critic_sheet,
    exam_sheet,
    load_sheet,
    long_run_sheet,
    teachers_sheet,
    words_of_controls,
)
from kurt2rt.experiments.shown.sheet import Sheet
from tests.experiments.phases.outcomes import exam, stage, study, teaching


def cells(sheet: Sheet, place: int) -> dict[str, str]:
    row = dict(zip(sheet.columns, sheet.rows[place], strict=True))
    assert len(sheet.rows[place]) == len(sheet.columns)
    return row


def test_every_stage_has_a_row_for_each_world() -> None:
    robots = [stage(PHASE_2, exam(), exam("c", succeeded=False, collisions=3), taught=teaching()) for _ in range(2)]
    sheet = exam_sheet("t", PATH, study(phase_2=robots), "")
    named = [row[0] for row in sheet.rows if row[0]]
    assert named == [TITLES[name] for name in PATH]
    second = cells(sheet, len(PATH) - 4 + 1)  # the row below phase 2 in A
    assert (second["stage"], second["world"], second["success"]) == ("", "C", "0 of 2")
    assert second["collisions in 10 min"] == "6.00"


def test_the_load_is_told_in_all_and_in_a_minute() -> None:
    sheet = load_sheet("t", (REWARDS,), study(rewards=[stage(REWARDS, taught=teaching(blame=30))]))
    row = cells(sheet, 0)
    assert (row["lasts, s"], row["answers"], row["corrections"]) == ("120", "4 (2.0)", "6 (3.0)")
    assert (row["rewards"], row["-1"], row["withdrawn"]) == ("30 (15.0)", "30", "3")


def test_a_critic_of_which_too_little_was_heard_says_so() -> None:
    told = study(2)
    row = cells(critic_sheet(told), 0)
    assert (row["agreement at its end"], row["trusted"], row["undone"]) == ("0.90", "2 of 2", "1")
    silent = study(phase_4=[stage("phase-4", taught=teaching(agreement=(None, None))) for _ in range(2)])
    assert cells(critic_sheet(silent), 0)["agreement at its end"] == "too little heard"


def test_why_somebody_had_to_come_is_told_apart() -> None:
    robots = [stage(LONG_RUN, taught=teaching(7200.0, collisions=1, rescues=3, unknown_rescues=2)) for _ in range(2)]
    row = cells(long_run_sheet(study(long_run=robots)), 0)
    assert (row["hours"], row["collisions"], row["stuck"], row["unknown for long"]) == ("4.0", "2", "2", "4")
    assert row["an hour"] == "2.00"


def test_nothing_is_judged_where_there_is_a_reason_not_to() -> None:
    sheet = asked_sheet(study(), ["Too few."])
    assert {row[-1] for row in sheet.rows} == {"not judged"}
    assert sheet.note == "Not judged. Too few."
    judged = asked_sheet(study(), [])
    assert {row[-1] for row in judged.rows} <= {"met", "MISSED"}


def test_every_branch_is_beside_the_others() -> None:
    sheet = exam_sheet("t", BRANCHES, study(), "")
    assert [row[0] for row in sheet.rows] == [TITLES[name] for name in BRANCHES]


def test_agreement_is_told_of_phase_4_alone() -> None:
    rows = critic_sheet(study()).rows
    assert [bool(row[2]) for row in rows] == [True, *[False] * 4]


def test_where_the_teacher_failed_himself_stands_beside_what_he_reaches() -> None:
    told = replace(study(3), teachers=((exam(),), (exam(succeeded=False, collisions=1),), (exam(progress=9.0),)))
    row = cells(teachers_sheet(told), 0)
    assert (row["without fault"], row["seeds that failed"], row["progress"]) == ("2 of 3", "101", "8.0 laps")


def test_a_control_that_equals_another_is_said_to() -> None:
    words = list(words_of_controls(study(2)))
    assert "asks, unknown is -1: 2 of 2 robots never met the unknown, so no -1 came." in words
    assert "asks only: 2 of 2 robots drive exactly as in 'corrupted, untouched'." in words
    assert not any("no robot asked" in each for each in words)
    silent = [stage(ASKS, exam(progress=7.0), taught=teaching().model_copy(update={"asks": 0})) for _ in range(2)]
    words = list(words_of_controls(study(2, asks_only=silent)))
    assert "asks only: no robot asked anything." in words
    assert not any(each.startswith("asks only: 2 of 2") for each in words)
