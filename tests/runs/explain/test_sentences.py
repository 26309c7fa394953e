"""Why, in sentences: one for each thing that a robot may do, or not do."""

import math
from dataclasses import replace

import pytest

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.active_stop import STARTED
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.facts import DecisionFacts, DoubtFacts, LessonFact
from kurt2rt.runs.explain.reasons import format_reasons, headline
from kurt2rt.runs.explain.sentences import (
    format_guard,
    format_held,
    format_mid_level,
    format_runner_up,
    format_stamp,
    format_teaching,
    format_usage,
)
from tests.runs.explain.helpers import facts, level, story, with_mid

NEAR = story(17, (1.0, 2.0), "forward", 4.0)
NEXT = story(5, (3.0, 2.0), "forward", 6.0)
ELSE = story(9, (9.0, 2.0), "back", 8.0)
FAR = replace(NEAR, distance=15.0)
KNOWN = level((1.0, 6.0), NEAR, NEXT, ELSE)


def standing(cause: DecisionCause, **more: object) -> DecisionFacts:
    stood = replace(facts(replace(KNOWN, driver=None), cause.value, None), decided=WheelSpeeds(0, 0))
    return replace(stood, **more)  # type: ignore[arg-type]


def test_reasons_for_driving_name_the_nearest_rla() -> None:
    driven = facts(KNOWN)
    assert headline(driven) == "forward"
    assert format_reasons(driven) == ["This is like RLA 17, which says forward: distance 4 of R 10 (40 %)."]
    assert format_guard(driven) == ""


def test_runner_up_with_equal_action_adds_the_next_that_differs() -> None:
    first, second = format_runner_up(KNOWN)
    assert first.startswith("The runner-up of 3 is RLA 5 (forward) at 6; the border to it is ")
    assert second.startswith("It says the same; the nearest that says something else is RLA 9 (back) at 8;")


def test_the_only_rla_has_nobody_beside_it() -> None:
    assert format_runner_up(level((1.0, 6.0), NEAR)) == ["No other RLA competes: RLA 17 is the only one."]


def test_reasons_for_a_held_action_name_the_nearest_rla_too() -> None:
    held = facts(replace(KNOWN, driver=ELSE), DecisionCause.HELD.value, "back")
    first, second = format_reasons(held)
    assert first == "RLA 9 (back) was chosen a moment ago, and its action keeps its minimum time."
    assert second == "Nearest by now is RLA 17 (forward), at 4 of R 10 (40 %)."


def test_reasons_on_a_shared_condition_give_the_chosen_value() -> None:
    chosen = replace(story(30, NEAR.condition, "back", 4.0), value=0.5)
    (line,) = format_reasons(facts(replace(KNOWN, driver=chosen)))
    assert line.endswith("Of those on the very same condition RLA 30 was chosen, which says back and is worth 0.50.")


def test_a_robot_that_knows_nothing_asks() -> None:
    asks = facts(level((1.0, 6.0)), DecisionCause.UNKNOWN.value, None)
    assert headline(asks) == "stands and asks"
    assert format_reasons(asks) == ["Nothing was taught yet, so the robot asks."]


def test_a_robot_outside_r_asks_and_says_by_how_much() -> None:
    far = level((1.0, 6.0), replace(NEAR, distance=15.0))
    assert format_reasons(facts(far, DecisionCause.UNKNOWN.value, None)) == [
        "No RLA is near enough: the nearest is RLA 17 (forward), at 15, 1.50 times R (10)."
    ]


def test_counterfactual_of_a_withdrawn_action_asks() -> None:
    withdrawn = level((1.0, 6.0), replace(NEAR, action="ask", asks=True))
    (line,) = format_reasons(facts(withdrawn, DecisionCause.UNKNOWN.value, None))
    assert line == "This is like RLA 17, at 4 of R 10, whose action was withdrawn: there the robot asks."


def test_an_action_that_is_lost_asks_inside_r() -> None:
    (line,) = format_reasons(facts(KNOWN, DecisionCause.UNKNOWN.value, None))
    assert line == "RLA 17 says forward, which does not know how to go on here: the robot asks."


@pytest.mark.parametrize(
    ("cause", "more", "said"),
    [
        (
            DecisionCause.STOPPED,
            {"stopped": STARTED},
            "The robot was stopped: the robot program was started. It waits",
        ),
        (DecisionCause.UNATTENDED, {}, "The robot knows what to do, but drives only while a teacher is there"),
        (
            DecisionCause.UNSAVED,
            {"trouble": "the disk is full"},
            "Lessons cannot be saved at the moment (the disk is full)",
        ),
    ],
)
def test_a_robot_that_stands_says_why_and_what_it_would_do(
    cause: DecisionCause, more: dict[str, object], said: str
) -> None:
    stood = standing(cause, **more)
    assert headline(stood).startswith("stands: ")
    first, second = format_reasons(stood)
    assert first.startswith(said)
    assert second == "By itself it would do as RLA 17 (forward) says, at 4 of R 10."


@pytest.mark.parametrize(
    ("cause", "more", "said"),
    [
        (DecisionCause.BLIND, {"infrared_age_s": math.inf}, "The infra-red readings never came"),
        (DecisionCause.BLIND, {"infrared_age_s": 0.07}, "The infra-red readings are 70 ms old"),
        (DecisionCause.AT_GOAL, {"plan_says": "arrived at door"}, "arrived at door."),
        (DecisionCause.NO_WAY, {"plan_says": "no way to door"}, "no way to door."),
    ],
)
def test_reasons_of_own_standstill_tell_no_other_action(
    cause: DecisionCause, more: dict[str, object], said: str
) -> None:
    (line,) = format_reasons(standing(cause, hindrances=(cause.value,), **more))
    assert line.startswith(said)


@pytest.mark.parametrize(
    ("hindrances", "would"),
    [
        ((DecisionCause.BLIND, DecisionCause.UNATTENDED), "stand: it sees nothing."),
        ((DecisionCause.UNSAVED,), "stand: lessons cannot be saved."),
        ((DecisionCause.UNATTENDED, DecisionCause.AT_GOAL), "stand: no teacher is there."),
        ((DecisionCause.AT_GOAL,), "stand: it is at its goal."),
        ((DecisionCause.NO_WAY,), "stand: no way leads to its goal."),
        ((), "do as RLA 17 (forward) says, at 4 of R 10."),
    ],
)
def test_a_stopped_robot_may_have_stood_all_the_same(hindrances: tuple[DecisionCause, ...], would: str) -> None:
    stood = standing(DecisionCause.STOPPED, hindrances=tuple(each.value for each in hindrances))
    assert format_reasons(stood)[1] == f"By itself it would {would}"


def test_robot_stopped_at_an_unknown_junction_would_ask() -> None:
    place = replace(story(12, (5.0,), "turn_left", 3.0, 1.0), title="mid-level RLA 12")
    for mid, why in (
        (level((1.0,)), "the mid level was taught nothing yet"),
        (level((1.0,), place), "nearest is mid-level RLA 12 (turn_left), at 3 of R 1"),
        (
            level((math.nan,), replace(place, distance=math.inf)),
            "it is lost, because no teacher has set its location",
        ),
    ):
        led = replace(
            with_mid(facts(KNOWN, DecisionCause.TEACHER.value, "by hand"), replace(mid, driver=None)), asks_at=MID
        )
        assert format_reasons(led)[1] == f"By itself it would ask the way: {why}."


def test_stopped_robot_on_shared_condition_names_the_leading_rla() -> None:
    crowd = level((1.0, 6.0), replace(NEAR, leads=False), replace(NEAR, rla_id=30, title="RLA 30", action="back"))
    stood = replace(standing(DecisionCause.STOPPED), basic=replace(crowd, driver=None))
    assert format_reasons(stood)[1] == "By itself it would do as RLA 30 (back) says, at 4 of R 10."


def test_reasons_of_a_led_robot_tell_that_it_would_ask() -> None:
    for known, said in ((level((1.0, 6.0)), "nothing was taught yet"), (level((1.0, 6.0), FAR), "nearest is RLA 17")):
        led = replace(
            facts(known, DecisionCause.TEACHER.value, "by hand"), hindrances=(DecisionCause.UNATTENDED.value,)
        )
        assert format_reasons(led)[1].startswith(f"By itself it would ask: {said}")


def test_while_an_action_keeps_its_minimum_time_that_is_said() -> None:
    assert format_held(facts(KNOWN)) == ""
    assert format_held(replace(facts(KNOWN), kept="forward")).startswith("forward had not driven for its minimum time")


def test_a_teacher_who_drives_is_named() -> None:
    led = replace(facts(KNOWN, DecisionCause.TEACHER.value, "by hand"), teacher="Ann")
    assert headline(led) == "by hand: Ann drives"
    assert format_reasons(led)[0] == "Ann drives: by hand. No RLA was asked."


def test_the_guard_tells_what_it_let_through() -> None:
    held_back = replace(facts(KNOWN), granted=WheelSpeeds(0.1, 0.1), reasons=("slew limit",))
    assert format_guard(held_back) == "The guard let +0.10/+0.10 m/s through instead of +0.30/+0.30 m/s: slew limit."


def test_an_alarm_goes_before_whatever_was_decided() -> None:
    alarm = replace(facts(KNOWN), granted=WheelSpeeds(0, 0), reasons=("bus lost",), latched=True)
    assert headline(alarm) == "stands until Go: its bus is lost"
    assert format_reasons(alarm)[0].startswith("The guard stopped the robot for bus lost")
    assert format_guard(alarm) == ""


def test_teaching_text_is_the_newest_standing_lesson() -> None:
    corrected = LessonFact("RLA 17 corrected: back instead of forward", "Bob", 2, 2000, "2026-11-22T04:00:00+00:00")
    undone = replace(corrected, text="RLA 17 corrected: spin", changes=False, undone=True)
    told = replace(NEAR, acts=(*NEAR.acts, corrected, undone))
    assert format_teaching(told) == (
        "RLA 17 corrected: back instead of forward; 2026-11-22 04:00:00 UTC (tick 2000), by Bob in phase 2."
    )
    assert format_stamp(replace(corrected, stamp="")) == "tick 2000 of its run"


def test_usage_counts_since_the_action_was_set_if_known() -> None:
    assert format_usage(NEAR) == "Used 7 times since."
    assert format_usage(replace(NEAR, uses_since=1)) == "Used once since, 7 times with the actions it had before."
    assert format_usage(replace(NEAR, uses_since=None)) == "Used 7 times since it was first taught."
    praised = replace(NEAR, rewards=2, punishments=1, value=0.25)
    assert format_usage(praised) == "Used 7 times since; praised twice, blamed once, worth 0.25."


def test_mid_level_lines_give_its_command_lesson_and_goal() -> None:
    place = replace(story(12, (0.0,), "turn_left", 1.0), title="mid-level RLA 12")
    above = replace(level((0.0,), place), level=MID, words=("left", "straight", ""))
    lines = format_mid_level(replace(with_mid(facts(KNOWN), above), plan_says="on the way to door"))
    assert lines[0] == "Mid level: mid-level RLA 12 commands turn_left, at 1 of R 10. Here: left, straight."
    assert lines[1].startswith("RLA 12 taught: turn_left;")
    assert lines[2] == "Goal: on the way to door"


def test_a_mid_level_that_asks_has_the_robot_stand() -> None:
    place = replace(story(12, (0.0,), "turn_left", 20.0), title="mid-level RLA 12")
    above = replace(level((5.0,), place), driver=None, level=MID)
    asks = replace(with_mid(facts(KNOWN, DecisionCause.UNKNOWN.value, None), above), asks_at=MID)
    assert headline(asks) == "stands and asks the way"
    assert format_reasons(asks) == [
        "The mid level does not know the way from here: nearest is mid-level RLA 12 (turn_left), at 20 of R 10."
    ]


def test_touching_robot_names_the_rla_that_drives_on_toward_it() -> None:
    touches = replace(
        facts(KNOWN, "touches", None), granted=WheelSpeeds(0, 0), reasons=("front bumper",), decided=WheelSpeeds(0, 0)
    )
    assert headline(touches) == "stands: I touch something in front of me; what now?"
    (line,) = format_reasons(touches)
    assert line.startswith("It touches something in front, and RLA ")
    assert line.endswith(" goes on toward it: the guard lets no wheel turn that way, so the robot asks.")
    assert format_guard(touches) == ""
    pushes = replace(facts(KNOWN), granted=WheelSpeeds(0, 0), reasons=("rear bumper",))
    assert headline(pushes) == "stands: it touches something behind"


def test_doubting_robot_names_the_sensor_that_sees_an_obstacle() -> None:
    doubt = DoubtFacts(3.41, 2.8, "front left", "13 cm", "40 cm")
    doubting = replace(standing(DecisionCause.DOUBT), doubt=doubt)
    assert headline(doubting) == "stands and asks: it doubts its action"
    assert format_reasons(doubting) == [
        "RLA 17 (forward) would drive, at 4 of R 10, but the robot doubts it and asks: front left sees 13 cm, and "
        "lessons to drive on reach 40 cm. Doubt 3.4, it asks from 2.8."
    ]


def test_driving_robot_tells_a_rare_doubt_but_no_usual_one() -> None:
    doubted = replace(facts(KNOWN), doubt=DoubtFacts(1.25, 2.8))
    assert format_reasons(doubted)[1:] == [
        "Doubt 1.2, it asks from 2.8: the situation is farther from the lesson than usual."
    ]
    assert len(format_reasons(replace(doubted, doubt=DoubtFacts(0.9, 2.8)))) == 1
