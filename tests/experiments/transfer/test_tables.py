"""Tables, verdicts and measures of the transfer study."""

import math

import pytest

from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.study.checkpoints import Checkpoint
from kurt2rt.experiments.transfer.study import (
    HomeOutcome,
    TransferOutcome,
    make_plan,
)
from kurt2rt.experiments.transfer.tables import (
    There,
    TransferStudy,
    all_tables,
    curve_table,
    drive_text,
    median_of,
    teaching_table,
    verdicts,
)
from tests.experiments.helpers import short_task
from tests.experiments.rows import FAILED, MADE_OF, NOT_JUDGED, lesson, row
from tests.experiments.study.here import parts_in
from tests.experiments.transfer.test_study import AFTER, NEW

RIGHT_AT_ONCE = ("right", "right", "right")
RIGHT_AFTER_5 = ("collided", "stuck", "right")
NEVER_RIGHT = ("collided", "collided", "stuck")
UNJUDGED = ("not judged",) * 3
DRIVES = {
    "right": row(),
    "collided": row(verdict=FAILED, collisions=2),
    "stuck": row(verdict=FAILED, stuck=True),
    "slow": row(verdict=FAILED),
    "not judged": row(verdict=NOT_JUDGED),
}


def robot(seed: int, *there: str, home: str = "right") -> TransferOutcome:
    """Return a robot whose exams after AFTER presses in the new world went like `there`."""
    points = zip(AFTER, there, strict=True)
    return TransferOutcome(
        made_of=MADE_OF,
        seed=seed,
        lesson=lesson(seed, presses=5, asks=1, collisions=3),
        checkpoints=tuple(
            Checkpoint(presses=after, teaching_s=10.0 * (after + 1), lessons=after, drives=(DRIVES[what],))
            for after, what in points
        ),
        policy=row(),
        home_when_right=DRIVES[home],
        home=row(),
    )


def robots(*there: tuple[str, ...], home: str = "right") -> TransferStudy:
    """Return the study of robots from seed 1100 on, all of which were right at home before."""
    outcomes = tuple(robot(seed, *each, home=home) for seed, each in enumerate(there, start=1100))
    plan = make_plan(short_task(exam_s=4.0), NEW, [each.seed for each in outcomes], parts_in())
    home_outcomes = tuple(
        HomeOutcome(
            made_of=MADE_OF,
            seed=each.seed,
            lesson=lesson(each.seed, presses=40),
            lessons=120,
            drive=row(),
            policy=row(),
        )
        for each in outcomes
    )
    return TransferStudy(plan, home_outcomes, (There("rooms-SEED", outcomes),))


def shares(study: TransferStudy) -> list[list[str]]:
    return [[cell.split(" (")[0] for cell in each[3:]] for each in curve_table(study).rows]


def test_presses_until_right_are_the_fewest_that_passed() -> None:
    assert (robot(1, *RIGHT_AT_ONCE).presses_until_right, robot(1, *RIGHT_AT_ONCE).seconds_until_right) == (0, 0.0)
    assert (robot(1, *RIGHT_AFTER_5).presses_until_right, robot(1, *RIGHT_AFTER_5).seconds_until_right) == (5, 60.0)
    never = robot(1, *NEVER_RIGHT)
    assert math.isinf(never.presses_until_right)
    assert math.isinf(never.seconds_until_right)


@pytest.mark.parametrize(
    ("values", "median"), [([0, 5, 10], 5), ([0, 5], 2.5), ([0, math.inf], math.inf), ([math.inf, math.inf], math.inf)]
)
def test_median_of_values_that_may_be_infinite(values: list[float], median: float) -> None:
    assert median_of(values) == median


def test_curve_counts_judged_robots_that_are_right() -> None:
    study = robots(RIGHT_AT_ONCE, RIGHT_AFTER_5, NEVER_RIGHT, UNJUDGED)
    assert shares(study) == [["1 of 3", "1 of 3", "2 of 3"]] * 2
    assert curve_table(study).rows[0][2] == "4 of 4"  # own drives of the policy
    failed_again = robots(("collided", "right", "collided"))
    assert shares(failed_again) == [["0 of 1", "1 of 1", "0 of 1"], ["0 of 1", "1 of 1", "1 of 1"]]


def test_teaching_table_has_medians_and_home() -> None:
    (cells,) = teaching_table(robots(RIGHT_AT_ONCE, RIGHT_AFTER_5, RIGHT_AFTER_5, home="collided")).rows
    assert cells[1:] == ("5", "60", "5", "1", "9", "3 of 3", "0 of 3", "3 of 3")
    (cells,) = teaching_table(robots(NEVER_RIGHT)).rows
    assert cells[1:3] == ("more than 5", "never")


@pytest.mark.parametrize(
    ("study", "results"),
    [
        (robots(*[RIGHT_AT_ONCE] * 18, *[NEVER_RIGHT] * 2), ["met"] * 3),
        (robots(*[NEVER_RIGHT] * 20, home="stuck"), ["MISSED"] * 3),
        (robots(UNJUDGED), []),
    ],
)
def test_verdicts_are_on_judged_robots(study: TransferStudy, results: list[str]) -> None:
    assert [each.result for each in verdicts(study.there[0], study)] == results
    assert [each[-1] for each in next(all_tables(study)).rows] == results


def test_a_drive_is_told_by_what_went_wrong() -> None:
    lost_way = row(verdict=FAILED, findings={"junctions": 10.0, "junctions right": 9.0})
    drives: list[DriveRow] = [*DRIVES.values(), lost_way]
    assert [drive_text(each) for each in drives] == [
        *("right", "2 collisions", "stuck at 300 s", "slow", "not judged", "90% of junctions right"),
    ]
