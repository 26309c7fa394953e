"""Pings are the outcome of a look: ticks that come in time, and parts that are alive."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kurt2rt.service.systemd.notifier import Notifier
from kurt2rt.service.systemd.watchdog import WatchdogNotifier
from tests.service.systemd.manager import Manager, manager

PERIOD_S = 0.01


@pytest.fixture
def systemd(tmp_path: Path) -> Iterator[Manager]:
    with manager(tmp_path) as opened:
        yield opened


@pytest.fixture
def notifier(systemd: Manager) -> Iterator[Notifier]:
    with Notifier(systemd.environment(2.0)) as opened:
        yield opened


def ticks(heartbeat: WatchdogNotifier, from_s: float, to_s: float, period_s: float = PERIOD_S) -> None:
    for number in range(round(from_s / period_s), round(to_s / period_s)):
        heartbeat.on_tick(number * period_s)


def test_pings_come_at_half_the_interval(systemd: Manager, notifier: Notifier) -> None:
    heartbeat = WatchdogNotifier(notifier, PERIOD_S, {})
    ticks(heartbeat, 0.0, 10.0)
    assert systemd.heard() == ["WATCHDOG=1"] * 10


def test_a_loop_that_is_late_all_the_time_is_not_well(systemd: Manager, notifier: Notifier) -> None:
    heartbeat = WatchdogNotifier(notifier, PERIOD_S, {})
    ticks(heartbeat, 0.0, 1.5)
    assert systemd.heard() == ["WATCHDOG=1"] * 2
    ticks(heartbeat, 2.0, 4.5, period_s=0.03)
    assert "WATCHDOG=1" not in systemd.heard()
    assert heartbeat.trouble != ""
    ticks(heartbeat, 4.5, 8.0)
    assert "WATCHDOG=1" in systemd.heard()
    assert heartbeat.trouble == ""


def test_a_part_that_died_is_named_and_ends_the_pings(systemd: Manager, notifier: Notifier) -> None:
    alive = {"knowledge journal": True, "simulator": True}
    parts = {name: lambda name=name: alive[name] for name in alive}
    heartbeat = WatchdogNotifier(notifier, PERIOD_S, parts)
    ticks(heartbeat, 0.0, 1.5)
    systemd.heard()
    alive["knowledge journal"] = False
    ticks(heartbeat, 1.5, 5.0)
    (said,) = systemd.heard()
    assert said.startswith("STATUS=")
    assert "knowledge journal" in said
    assert "simulator" not in said
