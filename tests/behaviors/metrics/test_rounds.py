import pytest

from behaviors.metrics.rounds import Rounds, RoundsSettings
from config.settings import SettingsError
from simbridge.contracts.simulation import SimulatedPost
from tests.behaviors.metrics.paths import arc, follow, put
from tests.behaviors.metrics.worlds import course_in

POST = SimulatedPost("post", 2.0, 2.0, 0.05)
LEFT = RoundsSettings(kind="rounds", wanted_m=0.45, within_m=0.8, turning="left")
RIGHT = LEFT.model_copy(update={"turning": "right"})
CENTRE = (2.0, 2.0)


def driven(radius_m: float, to_deg: float, settings: RoundsSettings = LEFT) -> Rounds:
    rounds = Rounds(settings, POST, "")
    path = arc(CENTRE, radius_m, 0.0, to_deg)
    put(rounds, path[0], 90.0)
    follow(rounds, path)
    return rounds


def test_rounds_with_the_post_on_the_left_count_fractions() -> None:
    assert driven(0.5, 900.0).progress == pytest.approx(2.5, abs=1e-6)
    assert driven(0.5, 900.0, RIGHT).progress == pytest.approx(-2.5, abs=1e-6)
    assert driven(0.5, -900.0, RIGHT).progress == pytest.approx(2.5, abs=1e-6)


def test_rounds_distance_error_ends_at_the_face_of_the_post() -> None:
    assert driven(0.5, 720.0).findings == {"distance error, m": pytest.approx(0.0, abs=1e-3)}
    assert driven(0.6, 720.0).findings == {"distance error, m": pytest.approx(0.1, abs=1e-3)}


def test_rounds_out_of_sight_of_the_post_count_for_nothing() -> None:
    assert driven(0.9, 720.0).progress == 0.0


def test_rounds_repositioning_counts_no_angle() -> None:
    rounds = driven(0.5, 90.0)
    put(rounds, (1.5, 2.0), 0.0)
    assert rounds.progress == pytest.approx(0.25, abs=1e-6)


def test_a_world_without_a_single_post_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"two objects .*2"):
        course_in("two_objects", LEFT)
    assert course_in("one_object", LEFT).unit == "rounds"
