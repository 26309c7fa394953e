"""Opinions of a taught critic."""

import pytest

from kurt2rt.core.critic.critic import Critic
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.critic.helpers import FREE, SETTINGS, appraisal

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
