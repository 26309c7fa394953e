"""The robot's question."""

import math
from dataclasses import replace

import numpy as np

from hal.robot_settings import load_robot
from kurt2rt.core.basic.doubt import NewObstacle
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.rla import ASK, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.question import Question, ask, ask_in_doubt, ask_the_way
from tests.core.rla.helpers import created, withdrawn

NAMES = ("s1", "s2", "s3", "s1 (10 s average)", "s2 (10 s average)", "s3 (10 s average)", "maximum left")


def asked(condition: tuple[float, ...], here: tuple[float, ...], radius: float | None = None) -> Question:
    system = RlaSystem(len(here), 300.0)
    system.apply(created(1, condition, "curve_left", radius))
    situation = np.array(here)
    return ask(system.match(situation), situation, system.weights, NAMES)


def test_question_keeps_the_words_it_is_asked_with() -> None:
    words = words_for(load_robot().infrared)
    system = RlaSystem(1, 300.0)
    system.apply(created(1, (108.0,), "forward"))
    here = np.array((441.0,))
    assert ask(system.match(here), here, system.weights, ("s9",), words=words).words is words


def test_question_is_about_the_active_behaviour() -> None:
    assert ask(None, np.zeros(7), np.ones(7), NAMES, "turn_left").behaviour == "turn_left"
    system = RlaSystem(7, 300.0)
    system.apply(created(1, (0,) * 7, "curve_left", behaviour="turn_left"))
    here = np.array((0, 0, 400, 0, 0, 0, 0))
    question = ask(system.match(here, "turn_left"), here, system.weights, NAMES, "turn_left")
    assert (question.nearest_rla, question.behaviour) == (1, "turn_left")


def test_question_of_a_withdrawn_action_says_so_in_place_of_it() -> None:
    system = RlaSystem(7, 300.0)
    for event in (created(1, (0,) * 7, "forward"), withdrawn(1)):
        system.apply(event)
    for here in (np.zeros(7), np.full(7, 200.0)):
        question = ask(system.match(here), here, system.weights, NAMES)
        assert (question.nearest_rla, question.action) == (1, ASK)
        assert ASK not in str(question).split()


def test_a_robot_that_does_not_know_where_it_is_asks_for_that() -> None:
    system = RlaSystem(1, 1.0, others={MID: Space(3, 0.5)})
    system.apply(created(1, (0.0, 0.0, 0.0), "straight_on", level=MID))
    nowhere = np.array([math.nan, math.nan, 1.0])
    words = load_mid_level("places").situation.describe((math.nan, math.nan, 1.0, 0.0, 0.5, 0.5))
    asked = ask_the_way(system.match(nowhere, level=MID), words)
    assert (asked.here, asked.distance) == ((), math.inf)


def test_question_of_a_doubt_begins_with_the_new_obstacle() -> None:
    question = asked((100, 100, 100, 100, 100, 100, 100), (110, 190, 100, 100, 100, 100, 100))
    doubt = ask_in_doubt(question, NewObstacle(0, 110.0, 70.0), NAMES)
    assert [(each.name, each.in_condition) for each in doubt.differing] == [("s1", 70.0), ("s2", 100.0)]
    assert doubt.doubts


def test_question_of_a_doubt_by_distance_alone_keeps_its_order() -> None:
    question = asked((100, 100, 100, 100, 100, 100, 100), (110, 190, 100, 100, 100, 100, 100))
    assert ask_in_doubt(question, None, NAMES) == replace(question, doubts=True)
