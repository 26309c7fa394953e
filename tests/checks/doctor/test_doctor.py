"""`kurt2rt doctor`: what it finds on this machine, and on trees that stand for other machines."""

import json
import math
import os
import socket
import threading
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from kurt2rt.checks.doctor.can_bus import check_can_interfaces, check_can_kernel
from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.checks import (
    check_cores,
    check_disk,
    check_free_space,
    check_governor,
    check_package,
    check_real_time_priority,
    check_sqlite_log,
    check_sync,
    check_timer,
)
from kurt2rt.platform.clock import Clock
from tests.cli.helpers import CommandLine

SUBJECTS = {"timer", "real-time priority", "cores", "CPU governor", "knowledge folder", "CAN in the kernel", "pymunk"}
OF_THE_DISK = {"free space", "fsync", "SQLite log"}


def test_doctor_prints_every_subject_and_a_last_line(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt("doctor", "--folder", tmp_path, "--ticks", "3")
    assert said.exit_code == 0, said.err
    for subject in SUBJECTS | OF_THE_DISK:
        assert subject in said.out
    assert f" {CheckStatus.OK}, " in said.out.splitlines()[-1]


def test_a_program_gets_json_and_code_1_when_there_is_no_disk(kurt2rt: CommandLine) -> None:
    said = kurt2rt("doctor", "--json", "--folder", "/proc/kurt2rt", "--ticks", "3")
    assert said.exit_code == 1
    findings = {each["subject"]: each for each in json.loads(said.out)}
    assert [name for name, each in findings.items() if each["needed"] and each["status"] == "missing"] == [
        "knowledge folder"
    ]
    assert findings.keys() >= SUBJECTS


def interface(net: Path, name: str, *, up: bool = True, device: bool = True, carrier: str = "1") -> None:
    """Make an interface in a tree like /sys/class/net."""
    folder = net / name
    folder.mkdir()
    (folder / "type").write_text("280\n")
    (folder / "flags").write_text("0x400c1\n" if up else "0x400c0\n")
    if device:
        (folder / "device").mkdir()
    if up:  # of an interface that is down the kernel refuses to tell it
        (folder / "carrier").write_text(f"{carrier}\n")


def test_each_can_interface_with_hardware_is_looked_at(tmp_path: Path) -> None:
    (tmp_path / "bonding_masters").write_text("")  # a file among the folders, as the kernel has it
    (none,) = check_can_interfaces(tmp_path)
    assert none.code is FindingCode.CAN_INTERFACE_NONE
    interface(tmp_path, "can0")
    interface(tmp_path, "can1", up=False)
    interface(tmp_path, "can2", carrier="0")
    interface(tmp_path, "vcan0", device=False)
    up, down, off = check_can_interfaces(tmp_path)
    assert (up.code, up.status, up.values["name"]) == (FindingCode.CAN_INTERFACE, CheckStatus.OK, "can0")
    assert (down.code, down.status) == (FindingCode.CAN_INTERFACE_DOWN, CheckStatus.WARNING)
    assert down.values == {"name": "can1", "up": "sudo ip link set can1 up type can bitrate 1000000"}
    assert off.code is FindingCode.CAN_INTERFACE_OFF_BUS


def test_kernel_without_can_still_allows_a_run(tmp_path: Path) -> None:
    def refuse() -> socket.socket:
        raise OSError(97, "Address family not supported by protocol")

    finding = check_can_kernel(refuse, tmp_path)
    assert (finding.code, finding.forbids_run) == (FindingCode.CAN_MISSING, False)
    (tmp_path / "modules.dep").write_text("kernel/net/can/can-raw.ko.xz: kernel/net/can/can.ko.xz\n")
    assert check_can_kernel(refuse, tmp_path).code is FindingCode.CAN_UNLOADED


def test_disk_of_a_missing_folder_is_its_parents(tmp_path: Path) -> None:
    findings = check_disk(tmp_path / "robots" / "anna's")
    assert [each.code for each in findings][::3] == [FindingCode.FOLDER_TO_MAKE, FindingCode.SQLITE_LOG]
    assert not any(each.forbids_run for each in findings)
    assert not list(tmp_path.iterdir())
    assert check_disk(tmp_path)[0].code is FindingCode.FOLDER


@pytest.mark.parametrize("name", ["", "kurt2rt"], ids=["itself", "its parent"])
def test_folder_that_cannot_be_written_forbids_to_run(name: str) -> None:
    (finding,) = check_disk(Path("/proc", name))  # /proc refuses root too
    assert (finding.code, finding.forbids_run) == (FindingCode.FOLDER_UNWRITABLE, True)


def test_room_and_speed_of_the_disk_have_limits(tmp_path: Path) -> None:
    enormous = 2**80
    assert check_free_space(tmp_path, 0, 0).status is CheckStatus.OK
    assert check_free_space(tmp_path, 0, enormous).status is CheckStatus.WARNING
    assert check_free_space(tmp_path, enormous, enormous).forbids_run
    assert check_sync(tmp_path, math.inf).status is CheckStatus.OK
    assert check_sync(tmp_path, 0.0).code is FindingCode.SYNC_SLOW
    assert check_sqlite_log(tmp_path / "nowhere").forbids_run


def test_trial_of_the_priority_changes_nothing_that_lasts() -> None:
    policy, priority, threads = os.sched_getscheduler(0), os.sched_getparam(0).sched_priority, threading.enumerate()
    check_real_time_priority()
    assert (os.sched_getscheduler(0), os.sched_getparam(0).sched_priority) == (policy, priority)
    assert set(threading.enumerate()) <= set(threads)


def test_refused_priority_is_a_warning() -> None:
    def refuse(pid: int, policy: int, parameters: os.sched_param) -> None:
        raise PermissionError(1, f"Operation not permitted: {pid} {policy} {parameters.sched_priority}")

    finding = check_real_time_priority(refuse)
    assert (finding.code, finding.status) == (FindingCode.PRIORITY_REFUSED, CheckStatus.WARNING)
    assert finding.values == {"error": "Operation not permitted: 0 1 21"}


def test_processor_needs_two_cores_at_full_clock(tmp_path: Path) -> None:
    assert [check_cores(usable).status for usable in (1, 2)] == [CheckStatus.WARNING, CheckStatus.OK]
    assert check_governor(tmp_path).code is FindingCode.GOVERNOR_NONE
    for number in range(3):
        (tmp_path / f"cpu{number}" / "cpufreq").mkdir(parents=True)
        (tmp_path / f"cpu{number}" / "cpufreq" / "scaling_governor").write_text("performance\n")
    assert check_governor(tmp_path).code is FindingCode.GOVERNOR
    (tmp_path / "cpu1" / "cpufreq" / "scaling_governor").write_text("powersave\n")
    assert check_governor(tmp_path).code is FindingCode.GOVERNOR_SAVING


def test_package_that_crashes_on_import_spares_the_doctor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "crashes_on_import.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    for name, fault in (("crashes_on_import", "-9"), ("kurt2rt_no_such_package", "No module named ")):
        finding = check_package(name, "nothing")
        assert (finding.code, finding.forbids_run) == (FindingCode.PACKAGE_MISSING, False)
        assert fault in str(finding.values["fault"])


class LateClock:
    """Simulated time in which every wait ends so much too late."""

    def __init__(self, *late_s: float) -> None:
        self._late_s = list(late_s)
        self._now_s = 100.0

    def now_s(self) -> float:
        return self._now_s

    async def wait_until(self, deadline_s: float) -> None:
        self._now_s = deadline_s + self._late_s.pop(0)


@pytest.mark.parametrize("late_s", [(0.002, 0.002, 0.002), (0.0001, 0.0001, 0.011)], ids=["always", "once a period"])
def test_timer_often_late_or_by_a_period_warns(late_s: tuple[float, ...]) -> None:
    finding = check_timer(3, 0.01, lambda: nullcontext(LateClock(*late_s)))
    assert (finding.code, finding.status, finding.forbids_run) == (FindingCode.TIMER_LATE, CheckStatus.WARNING, False)


def test_without_a_timer_the_robot_cannot_run() -> None:
    def refused() -> AbstractContextManager[Clock]:
        raise OSError(38, "timerfd_create failed; the runtime needs Linux")

    finding = check_timer(open_clock=refused)
    assert (finding.code, finding.forbids_run) == (FindingCode.TIMER_MISSING, True)
