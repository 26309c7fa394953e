"""ScriptedPerson: delays, old pictures, errors, and the limit on presses."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import pytest

from kurt2rt.core.rla.lesson_history import hold_id
from kurt2rt.core.rla.rla import SCRIPTED, Phase
from kurt2rt.core.teacher_settings import (
    ErrorSettings,
    LapseSettings,
    LinkSettings,
    LogNormalDelay,
    LookBackSettings,
    NoticeSettings,
    PersonSettings,
    TeacherProfile,
    load_teacher,
)
from kurt2rt.core.teaching.commands import Command, Correct, HoldAction, Resume, Stop, Teach, Undo
from kurt2rt.teacher.scripted.basic_teacher import TeacherView
from kurt2rt.teacher.scripted.person import ScriptedPerson, TaskSense
from tests.teacher.scripted.test_teacher import FAR, NEAR, NearIsB

PERIOD_S = 0.01
PICTURE_TICKS, LINK_TICKS = 5, 5
QUESTION_TICKS, MISTAKE_TICKS, DIFFERENT_TICKS, SIMILAR_TICKS = 100, 60, 40, 100
GROUPS = {"a": "ahead", "near_a": "ahead", "b": "left", "c": "right"}


def always(seconds: float) -> LogNormalDelay:
    return LogNormalDelay(kind="log_normal", median_s=seconds, spread=0.0, longest_s=60.0)


def limits(**changes: Any) -> PersonSettings:
    """Return a person of fixed delays without errors, lapses or tiredness."""
    return PersonSettings(
        question_delay=always(1.0),
        mistake_delay=always(0.6),
        reward_delay=always(0.6),
        hand_delay_s=0.3,
        notices=NoticeSettings(different_after_s=0.4, similar_after_s=1.0),
        link=LinkSettings(pictures_per_s=20.0, one_way_s=0.05),
        presses_per_minute=0,
        lapses=LapseSettings(per_minute=0.0, duration=always(1.0)),
        errors=ErrorSettings(answers=0.0, corrections=0.0),
        slower_per_minute=0.0,
    ).model_copy(update=changes)


def person(
    phase: Phase = Phase.CORRECTIONS, *, seed: int = 1, profile: dict[str, Any] | None = None, **changes: Any
) -> ScriptedPerson:
    own = limits(**changes)
    other = {"corrects_tick": "noticed", **(profile or {})}
    taught = TeacherProfile(name="p", description="A person", person=own, **other)
    sense = TaskSense(NearIsB(), tuple(GROUPS), GROUPS)
    teacher = ScriptedPerson(taught, own, sense, period_s=PERIOD_S, seed=seed, session="s")
    if phase is not Phase.SUPERVISED:
        teacher.begin_phase(phase)
    return teacher


def asking(count: int = FAR) -> TeacherView:
    return TeacherView(asking=True, driving=False, action=None, infrared_counts=(count,))


def doing(action: str, count: int = FAR) -> TeacherView:
    return TeacherView(asking=False, driving=True, action=action, infrared_counts=(count,))


def given(teacher: ScriptedPerson, views: Sequence[TeacherView]) -> dict[int, Command]:
    """Return the commands by the tick in which they reach the robot, counted from 1."""
    heard = {tick: teacher.update(view._replace(tick=tick)) for tick, view in enumerate(views, start=1)}
    return {tick: command for tick, command in heard.items() if command is not None}


def test_update_question_is_answered_after_delay_and_both_links() -> None:
    answers = given(person(Phase.SUPERVISED), [asking()] * 130)
    assert list(answers) == [1 + LINK_TICKS + QUESTION_TICKS + LINK_TICKS]


@pytest.mark.parametrize(
    ("named", "action", "decision_tick"),
    [
        *(("began", "b", 1), ("pressed", "b", None), ("by_delay", "b", None)),
        *(("noticed", "b", 1 + DIFFERENT_TICKS), ("noticed", "near_a", 1 + SIMILAR_TICKS)),
    ],
)
def test_update_corrected_tick_is_as_set(named: str, action: str, decision_tick: int | None) -> None:
    (correction,) = given(person(profile={"corrects_tick": named}), [doing(action)] * 175).values()
    assert isinstance(correction, Correct)
    assert correction.decision_tick == decision_tick


def test_update_limit_of_presses_holds_in_every_minute() -> None:
    teacher = person(presses_per_minute=12)
    ticks = list(given(teacher, [doing("b")] * 20_000))
    assert len(ticks) >= 36
    assert all(later - sooner >= 6000 for sooner, later in zip(ticks, ticks[12:], strict=False))


def test_update_wrong_answers_come_at_the_set_rate() -> None:
    errors = ErrorSettings(answers=0.05, corrections=0.0)
    teacher = person(Phase.SUPERVISED, question_delay=always(0.0), errors=errors)
    answers = list(given(teacher, [asking()] * 40_000).values())
    assert len(answers) > 1000
    right = [each for each in answers if isinstance(each, Teach) and each.action == "a"]
    assert 0.93 < len(right) / len(answers) < 0.97


def test_update_corrections_err_at_their_own_rate() -> None:
    teacher = person(errors=ErrorSettings(answers=0.0, corrections=1.0))
    (correction,) = given(teacher, [doing("b")] * 130).values()
    assert isinstance(correction, Correct)
    assert correction.action != "a"


def test_update_tired_person_answers_later() -> None:
    fresh, tired = (person(Phase.SUPERVISED, slower_per_minute=rate) for rate in (0.0, 1.0))
    minute = [doing("a")] * 6000
    waited = [min(given(teacher, minute + [asking()] * 400)) - 6000 for teacher in (fresh, tired)]
    assert waited[1] - waited[0] == pytest.approx(QUESTION_TICKS, abs=2)


HOLDS = {"corrects_by": "hold", "hold_s": 1.0}
HAND_TICKS = 30


def held(commands: dict[int, Command]) -> dict[int, str]:
    """Return the held action by tick."""
    return {tick: each.action for tick, each in commands.items() if isinstance(each, HoldAction)}


def test_update_hold_lasts_as_set_and_is_released() -> None:
    commands = given(person(profile=HOLDS), [doing("b")] * 230)
    begins = 1 + DIFFERENT_TICKS + LINK_TICKS + MISTAKE_TICKS + LINK_TICKS
    ticks = list(held(commands))
    assert min(commands) == ticks[0] == begins
    assert all(later - sooner <= PICTURE_TICKS for sooner, later in pairwise(ticks))
    ((release, stop),) = ((tick, each) for tick, each in commands.items() if isinstance(each, Stop))
    assert release == pytest.approx(begins + 100, abs=PICTURE_TICKS)
    assert stop.press_id == 1
    assert release == max(commands)


def test_update_held_action_follows_the_right_one_by_the_hand() -> None:
    turned = 120
    actions = held(given(person(profile=HOLDS), [doing("c", FAR)] * turned + [doing("c", NEAR)] * 100))
    assert list(dict.fromkeys(actions.values())) == ["a", "b"]
    switch = min(tick for tick, action in actions.items() if action == "b")
    assert switch - turned == pytest.approx(HAND_TICKS + 2 * LINK_TICKS, abs=2 * PICTURE_TICKS)


def test_update_wrong_button_is_held_until_it_is_noticed() -> None:
    wrong = person(profile=HOLDS, errors=ErrorSettings(answers=0.0, corrections=1.0))
    actions = list(held(given(wrong, [doing("b")] * 230)).values())
    assert actions[0] != "a"
    assert actions[-1] == "a"


def test_update_wrong_button_that_is_noticed_is_undone() -> None:
    wrong = person(profile=HOLDS, errors=ErrorSettings(answers=0.0, corrections=1.0, undone=1.0))
    commands = list(given(wrong, [doing("b")] * 180 + [doing("a")] * 100).values())
    (stop,) = (each for each in commands if isinstance(each, Stop))
    (undo,) = (each for each in commands if isinstance(each, Undo))
    assert (stop.press_id, undo.lesson) == (1, hold_id(SCRIPTED, 1))
    assert commands.index(stop) < commands.index(undo)


REWINDS = {"corrects_by": "rewind"}
SURE = LookBackSettings(moment_spread_s=0.0)


def standing() -> TeacherView:
    return TeacherView(asking=False, driving=False, action=None, infrared_counts=(FAR,))


def test_update_rewind_stops_corrects_the_begin_and_resumes() -> None:
    teacher = person(profile=REWINDS, look_back=SURE)
    stop, correction, resume, *_ = given(teacher, [doing("b")] * 120 + [standing()] * 600).values()
    assert isinstance(stop, Stop)
    assert stop.press_id is None
    assert isinstance(correction, Correct)
    assert (correction.action, correction.decision_tick) == ("a", 1)
    assert isinstance(resume, Resume)


LOOKS_BACK = {"corrects_by": "press", "corrects_touch_by": "rewind"}


def test_update_touch_corrects_the_mistake_before_it() -> None:
    wrong = [doing("a")] * 50 + [doing("b")] * 25 + [doing("a")] * 40
    views = [*wrong, *[doing("a")._replace(touching=True)] * 200, *[standing()] * 600]
    stop, correction, resume, *more = given(person(profile=LOOKS_BACK, look_back=SURE), views).values()
    assert isinstance(stop, Stop)
    assert isinstance(correction, Correct)
    assert (correction.action, correction.decision_tick) == ("a", 51)
    assert isinstance(resume, Resume)
    assert not any(isinstance(each, Correct) for each in more)


def test_update_own_wrong_rewind_is_undone() -> None:
    errors = ErrorSettings(answers=0.0, corrections=1.0, undone=1.0)
    teacher = person(profile=REWINDS, errors=errors)
    commands = list(given(teacher, [doing("b")] * 120 + [standing()] * 400 + [doing("a")] * 300).values())
    (correction,) = (each for each in commands if isinstance(each, Correct))
    (undo,) = (each for each in commands if isinstance(each, Undo))
    assert undo.lesson == correction.command_id


def presses_of(name: str, seed: int) -> Iterator[tuple[int, Command]]:
    profile = load_teacher(name)
    assert profile.person is not None
    sense = TaskSense(NearIsB(), tuple(GROUPS), GROUPS)
    teacher = ScriptedPerson(profile, profile.person, sense, period_s=PERIOD_S, seed=seed, session="s")
    teacher.begin_phase(Phase.CORRECTIONS)
    yield from given(teacher, ([asking()] * 600 + [doing("c")] * 400 + [standing()] * 1500) * 6).items()


@pytest.mark.parametrize("name", ["attentive", "ordinary", "slow"])
def test_update_same_seed_gives_the_same_presses(name: str) -> None:
    first, again, other = (list(presses_of(name, seed)) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert len(first) > 5
