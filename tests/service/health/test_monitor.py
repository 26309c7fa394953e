"""The report of a robot that runs on ticks that the test makes; the thread is real."""

import threading
from dataclasses import replace
from pathlib import Path
from typing import cast

import pytest

from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_text import rules_in
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.service.health.monitor import HealthMonitor, MachineMonitor, battery_of
from kurt2rt.service.health.probes import Probes
from tests.channel.channel_fixture import ChannelFixture
from tests.knowledge.lessons import created, withdrawn
from tests.patience import PATIENCE_S


class Keeping:
    """Journal of the lessons, as the monitor sees it."""

    unwritten = 2
    saving_error: str | None = None
    last_write_s: float | None = 0.005


FLIGHT = "policies flight from flight 0.1.0, hash 1a2b3c4d"


class Robot:
    """A robot, and the watch on it."""

    def __init__(self, folder: Path) -> None:
        self.desk = ChannelFixture()
        self.keeping = Keeping()
        self.now_s = 1000.0
        self.dropped = 0
        instruments = Probes(drops={"lines": lambda: self.dropped})
        self.watch = HealthMonitor(
            self.desk.runtime,
            cast(JournalWriter, self.keeping),
            instruments,
            boot="626f6f74",
            knowledge=folder / "not made yet" / "x.knowledge",
            now=lambda: self.now_s,
            plugins=(FLIGHT,),
        )
        self.heard: list[HealthReport] = []
        self.watch.add_listener(self.heard.append)

    def tick(self, count: int = 1) -> None:
        for _ in range(count):
            self.watch.after_tick(self.desk.run())
            self.now_s += 0.01

    def report(self) -> HealthReport:
        """Return the report of the newest tick."""
        return self.watch.report(self.watch.snapshot(self.desk.record))


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    return Robot(tmp_path)


def test_a_report_is_made_once_a_second_and_told_after_a_tick(robot: Robot) -> None:
    ticked, made = threading.Event(), threading.Event()
    work = robot.watch.report

    def report(snapshot: object) -> HealthReport:
        assert ticked.wait(PATIENCE_S)  # a thread that is quicker than the tick would be heard by it
        try:
            return work(snapshot)  # type: ignore[arg-type]
        finally:
            made.set()

    robot.watch.report = report  # type: ignore[method-assign]
    with robot.watch:
        robot.tick(99)
        assert not made.is_set()
        robot.tick()
        ticked.set()
        assert made.wait(PATIENCE_S)
        maker = next(each for each in threading.enumerate() if each.name == "health")
    maker.join(PATIENCE_S)  # the monitor's end waits for 0.2 s only, which a busy processor may not give the thread
    assert robot.watch.newest is None  # the loop publishes after its next tick, not the thread
    robot.tick()
    assert robot.heard == [robot.watch.newest]
    robot.tick()
    assert len(robot.heard) == 1


def test_rules_are_counted_with_their_actions(robot: Robot) -> None:
    system = robot.desk.runtime.level.system
    for number, action in enumerate(("forward", "forward", "back", "stand"), start=1):
        rla = replace(created(number, action=action).rla, condition=(100.0 * number,) * system.dimensions)
        system.apply(RlaCreated(rla))
    system.apply(withdrawn(4, "stand"))
    robot.tick()
    assert rules_in(robot.report()) == "4 rules of 2 actions"


def test_the_battery_is_the_machines_own_and_of_two_the_emptier(tmp_path: Path) -> None:
    assert battery_of(tmp_path) == (None, False)
    for name, kind, scope, percent, status in (
        ("AC", "Mains", "", "", ""),
        ("BAT0", "Battery", "System", "83", "Full"),
        ("BAT1", "Battery", "", "61", "Discharging"),
        ("mouse", "Battery", "Device", "4", "Discharging"),
    ):
        (tmp_path / name).mkdir()
        for file, text in (("type", kind), ("scope", scope), ("capacity", percent), ("status", status)):
            if text:
                (tmp_path / name / file).write_text(f"{text}\n")
    assert battery_of(tmp_path) == (0.61, True)
    assert MachineMonitor(tmp_path).poll().battery == 0.61
