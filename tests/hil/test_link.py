"""The interface goes down, comes up, is unplugged and plugged in again while the robot drives."""

from collections.abc import Callable

import pytest

from hal.guard_reason import GuardReason
from tests.hil.drive import Drive
from tests.hil.link import Link

pytestmark = pytest.mark.hil

AWAY = pytest.mark.parametrize("away", [Link.down, Link.delete], ids=["down", "deleted"])
Away = Callable[[Link], None]


def back(link: Link) -> None:
    link.restore()


@AWAY
def test_lost_interface_latches_and_reports_one_line(drive: Drive, link: Link, away: Away) -> None:
    away(link)
    drive.tick()
    assert drive.grant == ((0.0, 0.0), (GuardReason.BUS_LOST,), True)
    assert drive.health.latched == GuardReason.BUS_LOST
    assert drive.health.trouble.startswith("bus vcan0: ")
    assert "\n" not in drive.health.trouble
    drive.until_it_stands()  # by the controller's own watchdog, for no brake came through


@AWAY
def test_restored_interface_robot_waits_for_resume(drive: Drive, link: Link, away: Away) -> None:
    away(link)
    drive.ticks(50)
    back(link)
    drive.until_fresh()
    assert drive.now_s < 10.0
    assert drive.ticks(50) == ((0.0, 0.0), (GuardReason.BUS_LOST,), True)
    drive.kurt2.release()
    drive.until_it_drives()
    assert drive.health.trouble == ""


def test_a_moment_down_is_long_enough_to_stop(drive: Drive, link: Link) -> None:
    link.down()
    link.up()
    drive.tick()
    assert drive.grant == ((0.0, 0.0), (GuardReason.BUS_LOST,), True)
    drive.until_fresh()
    drive.kurt2.release()
    drive.until_it_drives()


def test_a_resume_moves_nothing_while_nothing_is_heard(drive: Drive, link: Link) -> None:
    link.down()
    drive.tick()
    link.up()
    drive.kurt2.release()
    assert {drive.tick().wheel_speeds for _ in range(10)} == {(0.0, 0.0)}
    assert drive.health.trouble


def test_the_second_loss_is_as_the_first(drive: Drive, link: Link) -> None:
    for away in (Link.down, Link.delete, Link.down):
        away(link)
        drive.ticks(5)
        assert drive.health.latched == GuardReason.BUS_LOST
        back(link)
        drive.until_fresh()
        drive.kurt2.release()
        drive.until_it_drives()
