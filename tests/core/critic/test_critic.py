"""Opinions of a taught critic, and its state as the command handler reports it."""

import pytest

from kurt2rt.core.critic.critic import Critic, CriticState
from kurt2rt.core.critic.settings import ActivationSettings
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.critic.helpers import FREE, SETTINGS, appraisal
from tests.core.reinforcement.helpers import CALM, CRASHED, QUICK, Track, knows_good_from_bad
from tests.core.rla.helpers import created

CLOSE = FREE._replace(front_m=0.12)


def system() -> RlaSystem:
    space = Space(len(SETTINGS.names), SETTINGS.learning.radius, SETTINGS.weight_vector)
    return RlaSystem(2, 1.0, others={CRITIC: space})


def test_critic_opinion_is_that_of_the_nearest_rla() -> None:
    knowledge = system()
    critic = Critic(knowledge, SETTINGS)
    knowledge.apply_all([appraisal(1, "good", FREE), appraisal(2, "bad", CLOSE)])
    said = critic.opinion(critic.to_vector(CLOSE._replace(front_m=0.13)))
    assert said is not None
    assert (said.value, said.appraisal, said.known, said.said) == (-1, "bad", True, -1)
    assert said.rla is not None
    assert said.rla.rla_id == 2
    assert said.trace_s == next(each.trace_s for each in SETTINGS.appraisals if each.name == "bad")
    assert said.distance == pytest.approx(0.01 * SETTINGS.learning.weights.front_m)
    there = critic.opinion(critic.to_vector(FREE))
    assert there is not None
    assert there.said == 1


def test_critic_far_situation_is_unknown() -> None:
    knowledge = system()
    critic = Critic(knowledge, SETTINGS)
    knowledge.apply(appraisal(1, "bad", CLOSE))
    said = critic.opinion(critic.to_vector(FREE._replace(left_m=0.1)))
    assert said is not None
    assert (said.value, said.appraisal, said.known, said.said) == (0, "", False, None)
    assert said.distance > said.radius == SETTINGS.learning.radius


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
