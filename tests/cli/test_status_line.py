"""The line that the program prints once a second tells what is wrong with the robot and what to do."""

from dataclasses import replace

from hal.guard_reason import GuardReason
from kurt2rt.core.decision.standing import STARTED, short_text
from kurt2rt.service.post_tick import ProgramStatus
from kurt2rt.service.status_line import status_line
from tests.channel.channel_fixture import ChannelFixture
from tests.service.health.reports import A_BUS


def status_of(desk: ChannelFixture) -> ProgramStatus:
    """Return the status after one more tick."""
    return ProgramStatus(desk.run(), desk.runtime, 0, None, "")


def test_status_line_of_a_stopped_robot_names_the_stop() -> None:
    desk = ChannelFixture()
    desk.runtime.handler.control.stop(STARTED)
    status = status_of(desk)
    assert short_text(status.record.standing) in status_line(status, A_BUS)
    assert status.record.standing.stop == STARTED


def test_status_line_shows_the_error_of_the_knowledge_updater() -> None:
    desk = ChannelFixture()
    desk.runtime.handler.updater.error = "1 change was skipped"
    assert status_line(status_of(desk), A_BUS).endswith(" | 1 change was skipped")


def test_status_line_shows_the_alarm_with_its_count() -> None:
    stopped = replace(A_BUS, alarm="another node sends CONTROL", foreign_control=2, latched=GuardReason.FOREIGN_CONTROL)
    *_, alarm, count = status_line(status_of(ChannelFixture()), stopped).split(" | ")
    assert alarm == stopped.alarm
    assert count.startswith("2 CONTROL ")
