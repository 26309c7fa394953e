"""Runs of a certificate follow from their numbers."""

from kurt2rt.experiments.certify.run import BrokenShare, Run, draw_runs
from kurt2rt.experiments.lockstep.faulty_sensor import FaultKind

PLACES = ("a", "b", "rooms-SEED")


def test_world_of_a_run_follows_from_its_number() -> None:
    assert Run(17, "rooms-SEED").world == "rooms-17"
    assert Run(17, "b").world == "b"


def test_runs_do_not_depend_on_how_many_are_drawn() -> None:
    assert draw_runs(100, 30, PLACES)[10:] == draw_runs(110, 20, PLACES)


def test_each_place_is_drawn_about_equally_often() -> None:
    places = [run.place for run in draw_runs(0, 3000, PLACES)]
    assert all(abs(places.count(place) - 1000) < 100 for place in PLACES)


def test_share_of_the_runs_has_another_broken_sensor_each() -> None:
    sensors = ("s1", "s2", "s3")
    runs = draw_runs(0, 1000, PLACES, BrokenShare(0.2, sensors))
    broken = [run.broken for run in runs if run.broken]
    assert 160 < len(broken) < 240
    assert set(broken) == {f"{sensor}={fault}" for sensor in sensors for fault in FaultKind}
    assert [run._replace(broken="") for run in runs] == draw_runs(0, 1000, PLACES)
