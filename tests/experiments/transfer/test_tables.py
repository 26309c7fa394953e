"""Tables, verdicts and measures of the transfer study."""

import pytest

from kurt2rt.experiments.study.examination import Checkpoint
from kurt2rt.experiments.study.study_plan import Group
from kurt2rt.experiments.transfer import (
    HomeOutcome,
    There,
    TransferOutcome,
    TransferStudy,
    all_tables,
    drive_text,
    make_plan,
    verdicts,
)
from tests.experiments.rows import FAILED, MADE_OF, NOT_JUDGED, lesson, row, titled
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
    plan = make_plan(NEW, [each.seed for each in outcomes], parts_in())
    home_outcomes = tuple(
        HomeOutcome(
            made_of=MADE_OF, seed=each.seed, lesson=lesson(each.seed, presses=40), lessons=120, home=row(), policy=row()
        )
        for each in outcomes
    )
    return TransferStudy(plan, Group("a", home_outcomes), (There("rooms-SEED", outcomes),))


def shares(study: TransferStudy) -> list[list[str]]:
    return [[cell.split(" (")[0] for cell in each[3:]] for each in titled(all_tables(study), "Robots that are").rows]


def test_curve_counts_judged_robots_that_are_right() -> None:
    study = robots(RIGHT_AT_ONCE, RIGHT_AFTER_5, NEVER_RIGHT, UNJUDGED)
    assert shares(study) == [["1 of 3", "1 of 3", "2 of 3"]] * 2
    assert titled(all_tables(study), "Robots that are").rows[0][2] == "4 of 4"  # own drives of the policy
    failed_again = robots(("collided", "right", "collided"))
    assert shares(failed_again) == [["0 of 1", "1 of 1", "0 of 1"], ["0 of 1", "1 of 1", "1 of 1"]]


def test_teaching_table_has_medians_and_home() -> None:
    (cells,) = titled(
        all_tables(robots(RIGHT_AT_ONCE, RIGHT_AFTER_5, RIGHT_AFTER_5, home="collided")), "Presses until"
    ).rows
    assert cells[1:] == ("5", "60", "5", "1", "9", "3 of 3", "0 of 3", "3 of 3")
    (cells,) = titled(all_tables(robots(NEVER_RIGHT)), "Presses until").rows
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
    told = [drive_text(each) for each in (*DRIVES.values(), lost_way)]
    assert told == ["right", "2 collisions", "stuck at 300 s", "slow", "not judged", "90% of junctions right"]
