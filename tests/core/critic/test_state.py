"""State of the critic in phase 5, as the command handler reports it."""

import pytest

from kurt2rt.core.critic.critic import CriticState
from kurt2rt.core.critic.settings import ActivationSettings
from kurt2rt.core.rla.rla import Phase
from tests.core.reinforcement.helpers import CALM, CRASHED, QUICK, Track, knows_good_from_bad
from tests.core.rla.helpers import created

WINDOW_TICKS = 100
NEEDS_A_TENTH = QUICK.model_copy(update={"need": ActivationSettings(bad_share=0.1, mean_s=100.0, first_s=0.0)})


def alone(*taught_the_critic: bool) -> Track:
    """Return a robot with one RLA in phase 5."""
    events = knows_good_from_bad() if all(taught_the_critic) else []
    return Track(created(1, (0.0,), "a"), *events, critic=NEEDS_A_TENTH, phase=Phase.AUTONOMOUS)


def standing(track: Track) -> tuple[CriticState, float | None]:
    return track.school.updater.critic_state, track.school.updater.bad_share


def test_state_measures_then_not_needed_then_acts() -> None:
    track = alone()
    track.go(0.0)
    assert standing(track) == (CriticState.MEASURES, 0.0)
    track.go(0.0, WINDOW_TICKS)
    assert standing(track) == (CriticState.NOT_NEEDED, 0.0)
    track.go(0.0, 5, CRASHED)
    role, share = standing(track)
    assert role is CriticState.NOT_NEEDED
    assert share == pytest.approx(0.05, abs=0.005)
    track.go(0.0, 50, CRASHED)
    assert standing(track)[0] is CriticState.ACTS
    track.go(0.0, 5, CALM)
    assert standing(track)[0] is CriticState.ACTS
