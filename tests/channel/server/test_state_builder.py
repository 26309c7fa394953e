"""States of a robot, tick by tick."""

import math
from dataclasses import replace

import pytest

from hal.guard_reason import GuardReason
from hal.simulation import SimulatedPlace
from kurt2rt.channel.protocol.codec import decode_state, encode_state
from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.requests import (
    AppraiseRequest,
    BehaviourRequest,
    PhaseRequest,
    PursueRequest,
    ResumeRequest,
    RewardRequest,
    SessionRequest,
    TakeRequest,
)
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.standing import Standing, StandReason
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import ASK, CRITIC
from tests.channel.channel_fixture import BOOT, ROBOT, STAMP, ChannelFixture, outcome_of, reply_of
from tests.channel.grounds import Yard
from tests.service.health.reports import ILL, WELL

LEAST = load_critic().agreement.least
APART = round(load_critic().agreement.apart_s / ROBOT.cycle_s)
COUNT = len(ROBOT.infrared.sensors)


@pytest.fixture
def desk() -> ChannelFixture:
    return ChannelFixture()


def picture(desk: ChannelFixture) -> State:
    """Return the state of the newest tick, checked by a round trip."""
    told = desk.channel._states.build(desk.record)
    assert decode_state(encode_state(told)) == told
    return told


def test_lateness_is_taken_from_health_report(desk: ChannelFixture) -> None:
    assert picture(desk).late_p99_ms == 0.0
    desk.health = WELL
    assert [picture(desk).late_p99_ms for _ in range(9)] == [0.0] * 9  # looked up once a second, with 20 pictures
    later = [picture(desk).late_p99_ms for _ in range(20)]
    assert later[-1] == WELL.punctuality.p99_ms


def test_way_of_the_wheels_sums_up_all_ticks(desk: ChannelFixture) -> None:
    assert picture(desk).way_m == (0.0, 0.0)
    desk.robot.ticks = (30, -10)
    desk.run(7)
    metres = ROBOT.geometry.metres_per_tick
    assert picture(desk).way_m == pytest.approx((210 * metres, -70 * metres))


def test_urgent_trouble_of_health_is_state_trouble(desk: ChannelFixture) -> None:
    full = Trouble(TroubleCode.LITTLE_ROOM, 3.0, True, "knowledge", (20.0,))
    desk.health = replace(ILL, troubles=(*ILL.troubles, full))
    assert picture(desk).trouble == f"{full.what}; {full.to_do}"
    desk.bus_trouble = "the cable is out"
    assert picture(desk).trouble == "the cable is out"
    desk.bus_trouble, desk.health = "", ILL  # in which only the sensors are urgent: the cause says so
    assert picture(desk).trouble == ""


def test_a_robot_that_knows_nothing(desk: ChannelFixture) -> None:
    desk.run(counts=120)
    assert picture(desk) == State(
        boot=BOOT,
        tick=desk.tick,
        phase=1,
        infrared_counts=(120,) * COUNT,
        infrared_age_s=0.0,
        bumpers=0,
        left_m_s=0.0,
        right_m_s=0.0,
        cause="unknown",
        action=None,
        rla=None,
        nearest=None,
        nearest_action=None,
        distance=math.inf,
        radius=desk.runtime.task.learning.radius,
        taught_by="",
        taught_at="",
        question=(),
        teacher=None,
        by_hand=False,
        stopped=None,
        rlas=0,
        lessons=0,
        unsaved=0,
        session=None,
        clock_s=0.0,
        guard=(),
        trouble="",
        late_p99_ms=0.0,
        missed_ticks=0,
        place=None,
        signals_missing=(LEAST, LEAST),
        standing=Standing(StandReason.ASKS, asks=True),
        way_m=(0.0, 0.0),
    )


async def test_a_robot_that_drives_by_what_it_was_taught(desk: ChannelFixture) -> None:
    await desk.ask(desk.answer("forward"))
    await desk.stream(desk.watch())
    desk.run()
    told = picture(desk)
    assert (told.cause, told.action, told.rla) == ("rla", "forward", 1)
    assert (told.left_m_s, told.right_m_s) == (0.3, 0.3)
    learning = desk.runtime.task.learning  # in phase 1 the robot asks sooner
    assert (told.nearest, told.nearest_action) == (1, "forward")
    assert told.radius == learning.radius * learning.asks_beyond_share
    assert told.distance < 1.0
    assert (told.taught_by, told.taught_at, told.teacher) == ("ann", STAMP, "ann")
    assert (told.rlas, told.lessons, told.unsaved, told.by_hand) == (1, 1, 0, False)


async def test_lesson_is_unsaved_without_time_until_durable(desk: ChannelFixture) -> None:
    task = await desk.send(desk.answer())
    desk.run()
    assert (picture(desk).taught_at, picture(desk).unsaved) == ("", 1)
    desk.write()
    assert (picture(desk).taught_at, picture(desk).unsaved) == (STAMP, 0)
    await reply_of(task)


async def test_a_question_names_the_features_that_differ_most(desk: ChannelFixture) -> None:
    await desk.ask(desk.answer())
    desk.run(counts=900)
    told = picture(desk)
    assert (told.cause, told.nearest, told.rla) == ("unknown", 1, None)
    assert told.distance > told.radius
    assert len(told.question) == 5
    assert all(each.here > each.in_condition for each in told.question)
    desk.run(counts=100)
    assert picture(desk).question == ()


async def test_a_hand_on_the_wheels_and_the_stop_after_it(desk: ChannelFixture) -> None:
    await desk.stream(desk.press())
    desk.run()
    told = picture(desk)
    assert (told.cause, told.action, told.rla, told.by_hand, told.teacher) == ("teacher", "by hand", None, True, "ann")
    assert (told.left_m_s, told.right_m_s) == (0.2, 0.1)
    desk.run(30)
    told = picture(desk)
    assert (told.cause, told.by_hand, told.stopped) == ("stopped", False, ActiveStop(StopReason.LET_GO, "ann"))
    assert (told.left_m_s, told.right_m_s) == (0.0, 0.0)


async def test_a_behaviour_counts_as_the_hand(desk: ChannelFixture) -> None:
    reply = await desk.ask(desk.command(BehaviourRequest, "back", 5))
    assert outcome_of(reply) == Outcome(RefusalCode.TEACHER_ABSENT)
    await desk.ask(desk.command(TakeRequest))
    await desk.stream(desk.watch())
    desk.run()
    await desk.ask(desk.command(BehaviourRequest, "back", 5))
    told = picture(desk)
    assert (told.action, told.by_hand) == ("back", True)


async def test_phase_session_and_clock(desk: ChannelFixture) -> None:
    await desk.ask(desk.command(PhaseRequest, Phase.CORRECTIONS))
    await desk.ask(desk.command(SessionRequest, "morning"))
    desk.run(250)
    told = picture(desk)
    assert (told.phase, told.session) == (2, "morning")
    assert told.clock_s == pytest.approx(2.5)
    await desk.ask(desk.command(SessionRequest, None))
    desk.run(100)
    told = picture(desk)
    assert told.session is None
    assert told.clock_s == pytest.approx(2.51)
    assert told.stopped == ActiveStop(StopReason.SESSION_OVER, "morning")
    await desk.ask(desk.command(ResumeRequest))
    assert picture(desk).stopped is None


def test_trouble_with_the_disk_goes_before_trouble_with_the_bus(desk: ChannelFixture) -> None:
    desk.bus_trouble = "the bus is off"
    assert picture(desk).trouble == "the bus is off"
    desk.notebook.saving_error = "the disk is full"
    assert picture(desk).trouble == "the disk is full"


def test_learning_error_is_state_trouble(desk: ChannelFixture) -> None:
    desk.runtime.handler.updater.error = "1 change was skipped"
    assert picture(desk).trouble == "1 change was skipped"


def test_blind_bumped_and_held_by_the_guard(desk: ChannelFixture) -> None:
    desk.robot.infrared_age_s = math.inf
    desk.robot.bumpers = 5
    desk.robot.refuses = (GuardReason.INFRARED_STALE, GuardReason.FRONT_BUMPER)
    desk.run()
    told = picture(desk)
    assert (told.infrared_age_s, told.bumpers, told.guard) == (math.inf, 5, desk.robot.refuses)
    assert told.cause == "blind"


def test_simulated_robot_has_place() -> None:
    assert picture(ChannelFixture(ground=Yard())).place == SimulatedPlace(1.0, 2.0, 0.5, 0.25, 3, 0)


def test_lateness_is_computed_once_a_second(desk: ChannelFixture) -> None:
    first = picture(desk)
    ledger = desk.runtime.timer
    for _ in range(200):
        ledger.begin(0.004)
        ledger.end()
    ledger.missed_ticks = 3
    assert picture(desk) == replace(first, missed_ticks=3)
    assert {picture(desk).late_p99_ms for _ in range(18)} == {0.0}
    assert picture(desk).late_p99_ms == pytest.approx(4.0)


async def test_state_names_selected_behaviour_and_its_rlas() -> None:
    desk = ChannelFixture(behaviours=("straight_on", "turn_left"))
    await desk.ask(desk.answer("forward"))
    told = picture(desk)
    assert (told.behaviour, told.nearest, told.cause) == ("straight_on", 1, "unattended")
    await desk.ask(desk.command(PursueRequest, "turn_left"))
    told = picture(desk)
    assert (told.behaviour, told.nearest, told.cause) == ("turn_left", None, "unknown")


async def drives(desk: ChannelFixture) -> None:
    """Let the robot drive by an RLA while its teacher watches."""
    await desk.ask(desk.answer("forward"))
    await desk.stream(desk.watch())
    desk.run()
    assert picture(desk).cause == "rla"


async def test_state_tells_opinion_and_missing_rewards(desk: ChannelFixture) -> None:
    await drives(desk)
    assert (picture(desk).opinion, picture(desk).opinion_of) == (None, None)
    reply = await desk.ask(desk.command(AppraiseRequest, "bad", None))
    assert outcome_of(reply) == Outcome.of(ResultCode.RLA_TAUGHT, rla=2, level=CRITIC, action="bad")
    desk.run()
    told = picture(desk)
    assert (told.opinion, told.opinion_of, told.rla) == (-1, 2, 1)
    assert (told.signals_missing, told.agreement, told.trusted) == ((LEAST - 1, LEAST), None, False)


async def test_it_tells_how_well_the_critic_agrees_with_its_teacher(desk: ChannelFixture) -> None:
    await drives(desk)
    await desk.ask(desk.command(AppraiseRequest, "bad", None))
    for each in ("bad",) * (LEAST - 1) + ("good",) * LEAST:
        desk.run(APART)  # sooner it would only repeat what it was just told
        await desk.ask(desk.command(AppraiseRequest, each, None))
    told = picture(desk)
    # Of each value the first one was news to the critic, and was learnt.
    assert told.agreement == pytest.approx((LEAST - 1) / LEAST)
    assert (told.trusted, told.signals_missing) == (True, (0, 0))
    assert (told.role, told.bad_share) == ("listens", None)
    await desk.ask(desk.command(PhaseRequest, Phase.AUTONOMOUS))
    told = picture(desk)
    assert (told.role, told.bad_share) == ("measures", 0.0)


async def test_blame_shows_in_what_the_rla_that_drives_is_worth(desk: ChannelFixture) -> None:
    assert picture(desk).value is None
    await drives(desk)
    before = picture(desk).value
    assert before is not None
    await desk.ask(desk.command(RewardRequest, -1, None))
    after = picture(desk).value
    assert after is not None
    assert after < before


async def test_worth_of_an_rla_whose_action_was_withdrawn_is_told(desk: ChannelFixture) -> None:
    await drives(desk)
    assert picture(desk).nearest_value is None
    while picture(desk).nearest_action != ASK:
        await desk.stream(desk.watch())
        desk.run()
        await desk.ask(desk.command(RewardRequest, -1, None))
        desk.run()
    told = picture(desk)
    assert told.cause == "unknown"
    assert told.nearest_value is not None
    assert told.nearest_value < 0


async def test_withdrawn_action_makes_robot_ask(desk: ChannelFixture) -> None:
    await drives(desk)
    while picture(desk).cause == "rla":
        for _ in range(10):
            await desk.stream(desk.watch())
            desk.run(10)
        await desk.ask(desk.command(RewardRequest, -1, None))
        desk.run()
    told = picture(desk)
    assert (told.cause, told.action, told.nearest, told.nearest_action) == ("unknown", None, 1, "ask")
    assert told.distance < told.radius
    assert (await desk.ask(desk.answer("back"))).body["ok"]
    await desk.stream(desk.watch())
    desk.run()
    assert (picture(desk).cause, picture(desk).action, picture(desk).rla) == ("rla", "back", 1)
