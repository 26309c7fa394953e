"""States of a robot, tick by tick."""

from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.rla.rla import ASK, Phase
from kurt2rt.core.teaching.commands import BeginSession, EndSession, Resume, Reward, SetPhase
from tests.channel.channel_fixture import STAMP, ChannelFixture
from tests.service.health.reports import ILL


def test_urgent_trouble_of_health_is_state_trouble(desk: ChannelFixture) -> None:
    full = Trouble(TroubleCode.LITTLE_ROOM, 3.0, True, "knowledge", (20.0,))
    desk.health = replace(ILL, troubles=(*ILL.troubles, full))
    assert desk.picture.trouble == f"{full.what}; {full.to_do}"
    desk.bus_trouble = "the cable is out"
    assert desk.picture.trouble == "the cable is out"
    desk.bus_trouble, desk.health = "", ILL  # in which only the sensors are urgent: the cause says so
    assert desk.picture.trouble == ""


async def test_a_robot_that_drives_by_what_it_was_taught(desk: ChannelFixture) -> None:
    await drives(desk)
    told = desk.picture
    assert (told.action, told.rla) == ("forward", 1)
    assert (told.left_m_s, told.right_m_s) == (0.3, 0.3)
    learning = desk.runtime.task.learning  # in phase 1 the robot asks sooner
    assert (told.nearest, told.nearest_action) == (1, "forward")
    assert told.radius == learning.radius * learning.ask_radius_fraction
    assert told.distance < 1.0
    assert (told.taught_by, told.taught_at, told.teacher) == ("ann", STAMP, "ann")
    assert (told.rlas, told.lessons, told.unsaved, told.by_hand) == (1, 1, 0, False)


async def test_phase_session_and_clock(desk: ChannelFixture) -> None:
    await desk.ask(desk.command(SetPhase, Phase.CORRECTIONS))
    await desk.ask(desk.command(BeginSession, "morning"))
    desk.run(250)
    told = desk.picture
    assert (told.phase, told.session) == (2, "morning")
    assert told.clock_s == pytest.approx(2.5)
    await desk.ask(desk.command(EndSession))
    desk.run(100)
    told = desk.picture
    assert told.session is None
    assert told.clock_s == pytest.approx(2.51)
    assert told.stopped == ActiveStop(StopReason.SESSION_OVER, "morning")
    await desk.ask(desk.command(Resume))
    assert desk.picture.stopped is None


async def drives(desk: ChannelFixture) -> None:
    """Let the robot drive by an RLA while its teacher watches."""
    await desk.ask(desk.answer("forward"))
    await desk.stream(desk.watch())
    desk.run()
    assert desk.picture.cause == "rla"


async def test_worth_of_an_rla_whose_action_was_withdrawn_is_told(desk: ChannelFixture) -> None:
    await drives(desk)
    assert desk.picture.nearest_value is None
    while desk.picture.nearest_action != ASK:
        await desk.stream(desk.watch())
        desk.run()
        await desk.ask(desk.command(Reward, -1, None))
        desk.run()
    told = desk.picture
    assert told.cause == "unknown"
    assert told.nearest_value is not None
    assert told.nearest_value < 0
