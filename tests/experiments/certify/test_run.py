"""Runs of a certificate follow from their numbers."""

from kurt2rt.experiments.certify.run import Run, draw_runs, draw_witnesses

PLACES = ("a", "b", "rooms-SEED")


def test_world_of_a_run_follows_from_its_number() -> None:
    assert Run(17, "rooms-SEED").world == "rooms-17"
    assert Run(17, "b").world == "b"


def test_runs_do_not_depend_on_how_many_are_drawn() -> None:
    assert draw_runs(100, 30, PLACES)[10:] == draw_runs(110, 20, PLACES)


def test_each_place_is_drawn_about_equally_often() -> None:
    places = [run.place for run in draw_runs(0, 3000, PLACES)]
    assert all(abs(places.count(place) - 1000) < 100 for place in PLACES)


def test_witnesses_are_a_share_but_at_least_three() -> None:
    runs = draw_runs(0, 1000, PLACES)
    assert len(draw_witnesses(runs, 0.01, 3)) == 10
    assert len(draw_witnesses(runs[:50], 0.01, 3)) == 3
    assert len(draw_witnesses(runs[:2], 0.01, 3)) == 2
    assert set(draw_witnesses(runs, 0.01, 3)) <= set(runs)
