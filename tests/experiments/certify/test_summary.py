"""Runs of a certificate follow from their numbers; probabilities and rates, from outcomes by hand."""

from typing import Any

import pytest

from kurt2rt.experiments.certify import Extent, draw_runs, summarise_runs, worst_of
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind
from kurt2rt.experiments.study.intervals import wilson_interval
from tests.experiments.rows import row

PLACES = ("a", "b", "rooms-SEED")


def run(seed: int, **more: Any) -> DriveRow:
    """Return a run of 60 s in world A without any event, but for `more`."""
    fields: dict[str, Any] = {"duration_s": 60.0, "way_m": 12.0, "share_unknown": 0.0, **more}
    return row(seed=seed, **fields)


ASKS = run(3, questions=4, first_question_s=30.0, share_unknown=0.1)
STUCK = run(4, stuck=True, duration_s=30.0)
COLLIDES = run(5, collisions=2, first_collision_s=1.0)
RUNS = [run(1), run(2), ASKS, STUCK, COLLIDES]


def test_shares_are_of_runs_with_wilson_intervals() -> None:
    summary = summarise_runs("a", RUNS)
    assert summary.collided == (1, 0.2, *wilson_interval(1, 5))
    assert (summary.stuck.events, summary.asked.events, summary.stopped.events, summary.clean.events) == (1, 1, 0, 2)


def test_rates_count_time_until_the_end_of_runs() -> None:
    summary = summarise_runs("a", RUNS)
    hours = 270 / 3600
    assert summary.hours == pytest.approx(hours)
    assert summary.collisions_per_hour.value == pytest.approx(2 / hours)
    assert summary.questions_per_hour.value == pytest.approx(4 / hours)
    assert summary.unknown_share == pytest.approx(6 / 270)
    assert summary.m_per_minute == pytest.approx(60 / 4.5)


def test_worst_runs_are_ordered_and_clean_ones_follow() -> None:
    worse = run(9, collisions=7)
    assert [each.seed for each in worst_of([*RUNS, worse], 10)] == [9, 5, 4, 3, 1, 2]
    assert worst_of(RUNS, 1) == [COLLIDES]


def test_run_follows_from_its_number() -> None:
    runs = draw_runs(Extent(0, 3000, PLACES))
    assert {run.world for run in runs if run.number == 17} < {"a", "b", "rooms-17"}
    assert runs[10:30] == draw_runs(Extent(10, 20, PLACES))
    assert all(abs([run.place for run in runs].count(place) - 1000) < 100 for place in PLACES)


def test_share_of_the_runs_has_another_broken_sensor_each() -> None:
    sensors = ("s1", "s2", "s3")
    runs = draw_runs(Extent(0, 1000, PLACES, broken_share=0.2), sensors)
    broken = [run.broken for run in runs if run.broken]
    assert 160 < len(broken) < 240
    assert set(broken) == {f"{sensor}={fault}" for sensor in sensors for fault in FaultKind}
    assert tuple(run._replace(broken="") for run in runs) == draw_runs(Extent(0, 1000, PLACES))
