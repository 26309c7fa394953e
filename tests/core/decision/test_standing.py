"""Reasons of a standing robot: page, terminal, status line and status give one text and one remedy."""

from typing import cast

import pytest

from hal.guard_reason import Effect, GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.decision import BY_KNOWLEDGE, Decision, DecisionCause, StandReason
from kurt2rt.core.decision.standing import (
    ASKS_AFTER_TICKS,
    DRIVES,
    GO_IN_TERMINAL,
    GO_ON_PAGE,
    ActiveStop,
    Standing,
    StandingWatch,
    StopReason,
    question_text,
    reason_text,
    short_text,
    standing_for,
    standing_headline,
)
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.commands import Teach, Watch
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.health.snapshot import format_activity, take_snapshot
from kurt2rt.teacher.client.link_quality import LinkQuality
from kurt2rt.teacher.page.views import state_view
from kurt2rt.teacher.scripted.channel_teacher import view_of_state
from kurt2rt.teacher.terminal.terminal_text import build_question, expects_answer, format_state
from tests.channel.channel_fixture import ChannelFixture

ASKS = Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None)


class LatchingDesk(ChannelFixture):
    """A robot that drives forward by its first RLA, until the guard has a word for it to stand."""

    def __init__(self) -> None:
        super().__init__()
        self.runtime.handler.authority.attended = False
        self.runtime.inbox.put(Teach("t", "Ann", "forward"))
        self.run(3)
        assert self.record.standing == DRIVES

    def latch(self, word: GuardReason) -> None:
        drive = self.robot.drive

        def latched(wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
            drive(wanted, decided_at_s, now_s)
            return GuardResult(STANDSTILL, (word,), latched=True)

        self.robot.drive = latched  # type: ignore[method-assign]

    def stall(self, ticks: int) -> None:
        self._tick += ticks
        self.run()


def page_of(picture: State) -> str:
    text: str = state_view(picture, LinkQuality(None, None, 20.0), 0.0, "")["stands"]["text"]
    return text


def test_latched_stall_has_length_and_resume_on_every_surface() -> None:
    desk = LatchingDesk()
    desk.latch(GuardReason.TICKS_CEASED)
    desk.stall(11)
    desk.run(5)  # what was measured stays
    assert desk.record.decision.driving  # its layer goes on wanting to
    stands = desk.record.standing
    assert (stands.reason, stands.needs_resume, stands.says) == (StandReason.COMPUTER_TOO_SLOW, True, "")
    assert stands.stall_s == pytest.approx(0.12)
    assert page_of(desk.picture) == standing_headline(stands, GO_ON_PAGE)
    assert format_state(desk.picture) == standing_headline(stands, GO_IN_TERMINAL)
    short = short_text(stands)
    assert format_activity(desk.record) == short
    snapshot = take_snapshot(desk.runtime, desk.record, cast("JournalWriter", _Keeping()), Probes(), 0.0)
    assert snapshot.doing == short


class _Keeping:
    unwritten = 0
    saving_error: str | None = None
    last_write_s: float | None = None


@pytest.mark.parametrize("word", [each for each in GuardReason if each.text and each.effect is Effect.LATCHES])
def test_each_latch_of_the_guard_has_a_text_with_go(word: GuardReason) -> None:
    desk = LatchingDesk()
    desk.latch(word)
    desk.run()
    told = desk.record.standing
    assert told.reason is not StandReason.HALTED
    assert told.needs_resume
    assert page_of(desk.picture).startswith("Stands: ")
    assert page_of(desk.picture).endswith(GO_ON_PAGE)
    assert word not in (told.says, "")


def test_each_text_of_the_guard_has_a_word_of_the_wire() -> None:
    assert {each.guard for each in StandReason} - {None} == {each for each in GuardReason if each.text}


def test_a_robot_without_its_teacher_waits_for_no_go() -> None:
    desk = LatchingDesk()
    desk.runtime.handler.authority.attended = True
    desk.runtime.handler.stops.active = None
    desk.run()
    desk.runtime.handler.stops.active = None  # that it lost its teacher on the way is another story
    desk.run()
    assert desk.record.standing == Standing(StandReason.UNATTENDED)
    desk.runtime.inbox.put(Watch("Ann", desk.tick))
    desk.run()
    assert desk.record.standing == DRIVES


@pytest.mark.parametrize("reason", list(StandReason))
def test_every_reason_has_a_text_of_one_or_two_short_sentences(reason: StandReason) -> None:
    for needs_go in (False, True):
        standing = Standing(reason, needs_go, stop=ActiveStop(StopReason.SAID_STOP, "Ann"))
        text = standing_headline(standing, GO_ON_PAGE)
        assert "{" not in text
        assert len(text) < 100
        if reason is not StandReason.DRIVES:
            assert reason_text(standing) in text
            assert (GO_ON_PAGE in text) is needs_go
            assert short_text(standing) or (not needs_go and reason.value in ("asks", "doubts", "asks the way"))


def test_a_question_waits_while_the_guard_has_latched() -> None:
    told = StandingWatch().update(ASKS, GuardResult(STANDSTILL, (GuardReason.BUS_LOST,), latched=True), 0.0, None, None)
    assert told == Standing(StandReason.BUS_LOST, True, True)


def test_a_robot_that_is_held_at_a_bumper_asks_on_every_surface() -> None:
    desk = LatchingDesk()
    desk.robot.touches_in_front = True
    desk.run(ASKS_AFTER_TICKS)
    picture = desk.picture
    assert (picture.cause, picture.standing) == ("touches", Standing(StandReason.FRONT_BUMPER, asks=True))
    question = question_text(picture.standing)
    assert page_of(picture) == question
    assert str(build_question(picture)).startswith(f"{question} RLA 1 ")
    short = short_text(picture.standing)
    assert format_activity(desk.record) == short
    assert take_snapshot(desk.runtime, desk.record, cast("JournalWriter", _Keeping()), Probes(), 0.0).doing == short
    assert picture.question == ()  # the situation is known: nothing differs
    assert not expects_answer(picture)  # an action that is typed corrects the RLA
    assert view_of_state(picture).asking  # and so a scripted teacher answers


@pytest.mark.parametrize("cause", DecisionCause)
def test_every_cause_of_a_decision_has_a_standing(cause: DecisionCause) -> None:
    drives = standing_for(cause, BASIC, None).reason is StandReason.DRIVES
    assert drives == (cause in BY_KNOWLEDGE or cause is DecisionCause.TEACHER)
