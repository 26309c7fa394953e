"""Tables, verdicts and measures of the transfer study."""

import math
from pathlib import Path

import pytest

from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.verdict import Target
from kurt2rt.experiments.transfer.outcome import TransferOutcome
from kurt2rt.experiments.transfer.tables import all_tables, curve_table, drive_text, teaching_table
from kurt2rt.experiments.transfer.verdicts import median_of, verdicts
from tests.experiments.transfer.outcomes import NOT_JUDGED, drive, robot, study_of

RIGHT_AT_ONCE = ("right", "right", "right")
RIGHT_AFTER_5 = ("collided", "stuck", "right")
NEVER_RIGHT = ("collided", "collided", "stuck")


def robots(*there: tuple[str, ...], first: int = 1100) -> tuple[TransferOutcome, ...]:
    return tuple(robot(seed, *each) for seed, each in enumerate(there, start=first))


def test_presses_until_right_are_the_fewest_that_passed() -> None:
    assert robot(1, *RIGHT_AT_ONCE).presses_until_right == 0
    assert robot(1, *RIGHT_AT_ONCE).seconds_until_right == 0.0
    late = robot(1, *RIGHT_AFTER_5)
    assert (late.presses_until_right, late.seconds_until_right) == (5, 60.0)
    assert robot(1, "collided", "right", "stuck").presses_until_right == 2
    never = robot(1, *NEVER_RIGHT)
    assert math.isinf(never.presses_until_right)
    assert math.isinf(never.seconds_until_right)


@pytest.mark.parametrize(
    ("values", "median"), [([0, 5, 10], 5), ([0, 5], 2.5), ([0, math.inf], math.inf), ([math.inf, math.inf], math.inf)]
)
def test_median_of_values_that_may_be_infinite(values: list[float], median: float) -> None:
    assert median_of(values) == median


def test_curve_counts_judged_robots_that_are_right(tmp_path: Path) -> None:
    there = (RIGHT_AT_ONCE, RIGHT_AFTER_5, NEVER_RIGHT, (NOT_JUDGED,) * 3)
    after, until_right = curve_table(study_of(Results(tmp_path), *robots(*there))).rows
    assert [cell.split(" (")[0] for cell in after[3:]] == ["1 of 3", "1 of 3", "2 of 3"]
    assert [cell.split(" (")[0] for cell in until_right[3:]] == ["1 of 3", "1 of 3", "2 of 3"]


def test_exam_failed_after_a_passed_one_counts_as_right_before(tmp_path: Path) -> None:
    there = ("collided", "right", "collided")
    after, until_right = curve_table(study_of(Results(tmp_path), *robots(there))).rows
    assert [cell.split(" (")[0] for cell in after[3:]] == ["0 of 1", "1 of 1", "0 of 1"]
    assert [cell.split(" (")[0] for cell in until_right[3:]] == ["0 of 1", "1 of 1", "1 of 1"]


def test_teaching_table_has_medians_and_home(tmp_path: Path) -> None:
    outcomes = (*robots(RIGHT_AT_ONCE, RIGHT_AFTER_5), robot(1102, *RIGHT_AFTER_5, home="collided"))
    (row,) = teaching_table(study_of(Results(tmp_path), *outcomes)).rows
    assert row[2:] == ("5", "60", "5", "1", "9", "3 of 3", "2 of 3", "3 of 3")
    (row,) = teaching_table(study_of(Results(tmp_path), *robots(NEVER_RIGHT))).rows
    assert [word for word in row[2].split() if word.isdigit()] == ["5"]


def test_verdicts_of_twenty_robots(tmp_path: Path) -> None:
    study = study_of(Results(tmp_path), *robots(*[RIGHT_AT_ONCE] * 18, *[NEVER_RIGHT] * 2))
    (summary,) = study.summaries
    assert {each.target: each.met for each in verdicts(summary, study)} == {
        Target.RIGHT_IN_NEW_WORLD: True,
        Target.PRESSES_UNTIL_RIGHT: True,
        Target.RIGHT_AT_HOME: True,
    }
    assert [row[-1] for row in next(all_tables(study)).rows] == ["met"] * 3


def test_verdicts_of_robots_that_are_never_right_are_missed(tmp_path: Path) -> None:
    outcomes = [robot(seed, *NEVER_RIGHT, home="stuck") for seed in range(1100, 1120)]
    study = study_of(Results(tmp_path), *outcomes)
    assert [each.met for each in verdicts(study.summaries[0], study)] == [False] * 3


def test_worlds_without_a_judged_exam_have_no_verdict(tmp_path: Path) -> None:
    study = study_of(Results(tmp_path), *robots((NOT_JUDGED,) * 3))
    assert list(verdicts(study.summaries[0], study)) == []


def test_curve_shows_the_policy_of_all_robots(tmp_path: Path) -> None:
    (after, _) = curve_table(study_of(Results(tmp_path), *robots(RIGHT_AT_ONCE, (NOT_JUDGED,) * 3))).rows
    assert after[2] == "2 of 2"


def test_a_drive_is_told_by_what_went_wrong() -> None:
    assert len({drive_text(drive(what)) for what in ("right", "collided", "stuck", "slow", NOT_JUDGED)}) == 5
    lost_way = drive("slow").model_copy(update={"right_share": 0.9})
    assert drive_text(lost_way) == "90% of junctions right"
