"""The school robot on a pseudo-terminal, opened by pyserial as a real port is."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from config.settings import SettingsError
from hal.bus import BusError
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult
from kurt2rt.robots.school.kind import SCHOOL
from simbridge.contracts.robot_kind import kind_of
from simbridge.links import PtyPort
from tests.patience import PATIENCE_S
from tests.robots.school.rig import FORWARD, SETTINGS, PtyRobot


def drive_until(robot: object, reached: Callable[[GuardResult], bool]) -> GuardResult:
    """Drive at 100 Hz until a result is reached."""
    ends_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < ends_s:
        now_s = time.monotonic()
        robot.sense(now_s)  # type: ignore[attr-defined]
        result: GuardResult = robot.drive(FORWARD, now_s, now_s)  # type: ignore[attr-defined]
        if reached(result):
            return result
        time.sleep(0.01)
    raise AssertionError("not reached in time")


def open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


def test_serial_robot_greets_drives_and_is_lost(tmp_path: Path) -> None:
    device = tmp_path / "robot"
    with PtyRobot(device) as simulated:
        robot = kind_of(SETTINGS).open(SETTINGS, str(device))
        try:
            drive_until(robot, lambda result: result.wheel_speeds == FORWARD)
            drive_until(robot, lambda _: simulated.simulated.wheel_speeds.left_m_s > 0.07)
            assert robot.health.junk == 0
            simulated.unplug()
            result = drive_until(robot, lambda result: result.latched)
            assert result.reasons == (GuardReason.BUS_LOST,)
            assert result.wheel_speeds == STANDSTILL
            robot.release()
            assert drive_until(robot, lambda _: True).latched
            with PtyRobot(device):  # plugged in again

                def drives_again(result: GuardResult) -> bool:
                    robot.release()
                    return result.wheel_speeds == FORWARD

                drive_until(robot, drives_again)
        finally:
            robot.close()


def test_serial_robot_brakes_when_its_program_ends(tmp_path: Path) -> None:
    with PtyRobot(tmp_path / "robot") as simulated:
        robot = SCHOOL.open(SETTINGS, str(tmp_path / "robot"))
        drive_until(robot, lambda _: simulated.simulated.wheel_speeds.left_m_s > 0.05)
        robot._close_link()  # as the end of a process does, without a brake
        ends_s = time.monotonic() + PATIENCE_S
        while simulated.simulated.wheel_speeds != STANDSTILL and time.monotonic() < ends_s:
            time.sleep(0.01)
        assert simulated.simulated.controller.watchdog_expired
        assert simulated.simulated.wheel_speeds == STANDSTILL


def test_serial_port_is_for_one_program(tmp_path: Path) -> None:
    with PtyRobot(tmp_path / "robot"):
        robot = SCHOOL.open(SETTINGS, str(tmp_path / "robot"))
        with pytest.raises(BusError, match=r"robot: .*lock"):
            SCHOOL.open(SETTINGS, str(tmp_path / "robot"))
        robot.close()


def test_serial_device_that_does_not_greet_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kurt2rt.robots.school.link._GREETED_WITHIN_S", 0.05)
    port = PtyPort()
    with pytest.raises(BusError, match="no school robot answers; switch the robot on"):
        SCHOOL.open(SETTINGS, port.device)
    assert port.read().startswith(b"school ")
    port.close()


def test_serial_port_that_is_missing_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(BusError, match=r"nothing: .*No such file.*plug the robot in"):
        SCHOOL.open(SETTINGS, str(tmp_path / "nothing"))


def test_serial_robot_with_a_tap_is_refused() -> None:
    class Silent:
        def on_rx(self, *_: object) -> None: ...

        def on_tx(self, *_: object) -> None: ...

    with pytest.raises(SettingsError, match="no CAN frames"):
        SCHOOL.open(SETTINGS, "nowhere", Silent())


def test_pty_path_in_use_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "robot"
    path.write_text("mine")
    before = open_files()
    with pytest.raises(BusError, match="take another path, or delete it"):
        PtyPort(str(path))
    assert path.read_text() == "mine"
    assert open_files() == before


def test_pty_link_of_a_killed_program_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "robot"
    path.symlink_to(tmp_path / "gone")
    port = PtyPort(str(path))
    assert path.exists()
    port.close()
    assert not path.is_symlink()
