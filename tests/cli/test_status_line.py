"""The line that the program prints once a second tells what is wrong with the robot and what to do."""

from dataclasses import replace

import pytest

from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason
from hal.health import Health
from kurt2rt.core.decision.standing import STARTED, short_text
from kurt2rt.service.post_tick import ProgramStatus
from kurt2rt.service.status_line import status_line
from tests.channel.channel_fixture import ChannelFixture

WELL = Health(
    frames=700,
    junk=0,
    error_frames=0,
    foreign_control=0,
    send_failures=0,
    receive_failures=0,
    bus_trouble="",
    controller=ControllerState.ACTIVE,
    controller_trouble="",
    alarm="",
    latched=None,
)
PASSIVE = replace(WELL, controller=ControllerState.PASSIVE, controller_trouble="bus can0: error-passive, 130 errors")


@pytest.fixture(scope="module")
def status() -> ProgramStatus:
    desk = ChannelFixture()
    return ProgramStatus(desk.record, desk.runtime, 0, None, "")


def test_status_line_of_a_stopped_robot_names_the_stop() -> None:
    desk = ChannelFixture()
    desk.runtime.handler.control.stop(STARTED)
    status = ProgramStatus(desk.run(), desk.runtime, 0, None, "")
    assert short_text(status.record.standing) in status_line(status, WELL)
    assert status.record.standing.stop == STARTED


def test_status_line_shows_the_error_of_the_knowledge_updater() -> None:
    desk = ChannelFixture()
    desk.runtime.handler.updater.error = "1 change was skipped"
    assert status_line(ProgramStatus(desk.run(), desk.runtime, 0, None, ""), WELL).endswith(" | 1 change was skipped")


def test_status_line_shows_the_alarm_with_its_count(status: ProgramStatus) -> None:
    stopped = replace(WELL, alarm="another node sends CONTROL", foreign_control=2, latched=GuardReason.FOREIGN_CONTROL)
    *_, alarm, count = status_line(status, stopped).split(" | ")
    assert alarm == stopped.alarm
    assert count.startswith("2 CONTROL ")
