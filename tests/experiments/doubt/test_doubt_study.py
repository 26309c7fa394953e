"""Study of doubt: its measures by hand, and a robot in the real simulator."""

import math
from pathlib import Path

import numpy as np
import pytest

from config.settings import SettingsError
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.doubt.drive import (
    DoubtResponse,
    DriveLog,
    Scores,
    area_under_curve,
    judge_score,
    question_ticks,
    threshold_for,
    with_doubt,
    wrong_ticks,
)
from kurt2rt.experiments.doubt.study import (
    DoubtDrives,
    DoubtJob,
    DoubtOutcome,
    collision_table,
    make_plan,
    score_table,
    tell,
)
from kurt2rt.experiments.study.study_plan import Group
from tests.experiments.helpers import teach
from tests.experiments.study.here import carry_out, parts_in

TICKS = 3000


def log(
    doubt: Scores, *, missed: tuple[slice, ...] = (), collisions: tuple[int, ...] = (), seen: tuple[bool, ...] = ()
) -> DriveLog:
    """Return a drive of 30 s with this doubt, half as great a distance, and wrong actions at `missed`."""
    flags = np.zeros(TICKS, dtype=np.bool_)
    for each in missed:
        flags[each] = True
    driving = np.ones(TICKS, dtype=np.bool_)
    return DriveLog(
        world="a", doubt=doubt, distance=doubt / 2, driving=driving, missed=flags, collisions=collisions, seen=seen
    )


def pulses(*ticks: int) -> Scores:
    """Return scores that are 0, and 5 for 0.5 s from each of these ticks."""
    scores = np.zeros(TICKS)
    for tick in ticks:
        scores[tick : tick + 50] = 5.0
    return scores


def test_area_under_curve_of_known_scores() -> None:
    wrong = np.array([False, False, True, True])
    assert area_under_curve(np.array([1.0, 2.0, 3.0, 4.0]), wrong) == 1.0
    assert area_under_curve(np.array([1.0, 3.0, 2.0, 4.0]), wrong) == 0.75
    assert area_under_curve(np.zeros(4), wrong) == 0.5
    assert math.isnan(area_under_curve(np.zeros(4), np.zeros(4, dtype=np.bool_)))


def test_wrong_ticks_are_lasting_misses_and_times_before_a_crash() -> None:
    wrong = wrong_ticks(log(pulses(), missed=(slice(100, 129), slice(500, 530)), collisions=(2000,)))
    assert np.flatnonzero(wrong).tolist() == [*range(500, 530), *range(1800, 2000)]


def test_judge_score_counts_collisions_and_false_questions() -> None:
    scores = pulses(1000, 2500)
    result = judge_score([log(scores, collisions=(1100, 2100, 2505), seen=(True, True, False))], [scores], 5.0)
    assert result.caught_seen == 1
    assert (result.caught, result.questions, result.false_questions) == (1, 2, 0)
    alarm = judge_score([log(scores)], [scores], 5.0)
    assert (alarm.caught, alarm.questions, alarm.false_questions) == (0, 2, 2)


def test_threshold_for_a_budget_keeps_to_it() -> None:
    scores = pulses(100, 1000)
    scores[1000:1050] = 7.0
    threshold = threshold_for([log(scores)], [scores], 1)
    assert threshold == 7.0
    assert len(question_ticks(scores, np.ones(TICKS, dtype=np.bool_), threshold)) == 1


def test_tables_have_doubt_and_its_control() -> None:
    told = log(pulses(1000), collisions=(1100,), seen=(True,))
    first, second = score_table([told], 5.0).rows
    assert (first[0], first[2:]) == ("doubt", ("1 of 1", "1 of 1", "4.00", "0.00"))
    assert second[0] == "distance / R"
    table = collision_table([Group(DoubtResponse.TELLS, (told,)), Group(DoubtResponse.STANDS, (log(pulses()),))], 0.0)
    rows = table.rows
    assert table.note == "A robot that asks stands for as long as its question lasts."
    assert [row[:3] for row in rows] == [("only told", "1", "1"), ("stands", "0", "0")]
    assert [row[3].split()[0] for row in rows] == ["200.0", "0.0"]


def test_task_without_doubt_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"fleeing\b.*\bdoubt"):
        with_doubt(load_task("fleeing"), DoubtResponse.STANDS)


def test_log_is_stored_with_infinite_scores() -> None:
    made = log(pulses(1000), collisions=(1100,))
    made.doubt[5] = math.inf
    read = DriveLog.model_validate_json(made.model_dump_json())
    assert all((getattr(read, name) == getattr(made, name)).all() for name in ("doubt", "distance", "driving"))
    assert read.collisions == (1100,)


@pytest.mark.deep  # a lesson and two drives in the simulator
def test_robot_that_stands_at_its_doubt_collides_no_more_often(tmp_path: Path) -> None:
    task = load_task("wall_following")
    teach(tmp_path / "wall_following-3.knowledge", task, seed=3)
    about = DoubtDrives(task, ("maps/flat",), tuple(DoubtResponse), 60.0, 10.0)
    plan = carry_out(make_plan(about, (3,), tmp_path, parts_in(tmp_path)), tmp_path)
    told, stands = (job.results.read(job, DoubtOutcome).log for job in plan.of(DoubtJob))
    assert len(told.doubt) == len(stands.doubt) == 6000
    assert told.doubt.max() > 1.0
    assert stands.driving.sum() <= told.driving.sum()
    assert len(stands.collisions) <= len(told.collisions)
    assert [len(table.rows) for table in tell(plan, "").tables] == [2, 2]
