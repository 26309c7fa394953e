"""Timer and clock: really measured, and with clocks that are late by a known time."""

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from kurt2rt.checks.doctor.check_result import CheckStatus, FindingCode
from kurt2rt.checks.doctor.timer import check_clock, check_timer
from kurt2rt.platform.clock import Clock


class LateClock:
    """Simulated time in which every wait ends so much too late."""

    def __init__(self, *late_s: float) -> None:
        self._late_s = list(late_s)
        self._now_s = 100.0

    def now_s(self) -> float:
        return self._now_s

    async def wait_until(self, deadline_s: float) -> None:
        self._now_s = deadline_s + self._late_s.pop(0)


def late_by(*late_s: float) -> AbstractContextManager[Clock]:
    return nullcontext(LateClock(*late_s))


def refused() -> AbstractContextManager[Clock]:
    raise OSError(38, "timerfd_create failed; the runtime needs Linux")


@pytest.mark.parametrize("late_s", [(0.002, 0.002, 0.002), (0.0001, 0.0001, 0.011)], ids=["always", "once a period"])
def test_check_timer_often_late_or_by_a_period_warns(late_s: tuple[float, ...]) -> None:
    finding = check_timer(3, 0.01, lambda: late_by(*late_s))
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.TIMER_LATE
    assert not finding.forbids_run


def test_without_a_timer_the_robot_cannot_run() -> None:
    finding = check_timer(open_clock=refused)
    assert finding.forbids_run
    assert finding.code is FindingCode.TIMER_MISSING


def test_a_clock_that_follows_jiffies_is_a_warning(tmp_path: Path) -> None:
    finding = check_clock(0.004, tmp_path / "no clock source here")
    assert finding.status is CheckStatus.WARNING
    assert finding.code is FindingCode.CLOCK_COARSE
    assert finding.values == {"resolution_ns": 4e6, "source": "unknown"}


@pytest.mark.parametrize(("name", "status"), [("tsc", CheckStatus.OK), ("hpet", CheckStatus.WARNING)])
def test_a_clock_source_that_is_slow_to_read_is_a_warning(name: str, status: CheckStatus, tmp_path: Path) -> None:
    source = tmp_path / "current_clocksource"
    source.write_text(f"{name}\n")
    finding = check_clock(1e-9, source)
    assert finding.status is status
    assert finding.values == {"resolution_ns": 1.0, "source": name}
