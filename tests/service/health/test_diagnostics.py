"""Troubles of a health report: code, beginning and end."""

import math
from dataclasses import replace

import pytest

from hal.guard_reason import GuardReason
from hal.kurt2_settings import load_kurt2
from hal.robot import readings_before_the_first
from hal.sensor_signs import SensorFault
from hal.sensor_watch import BrokenSensor
from kurt2rt.channel.protocol.health import DiskSpace, Trouble
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.service.health.diagnostics import LATELY_S, CounterGrowth, Diagnostics
from kurt2rt.service.health.snapshot import Snapshot
from tests.service.health.reports import A_BUS, WELL

CALM = Snapshot(
    tick=100,
    now_s=50.0,
    readings=readings_before_the_first(10)._replace(infrared_age_s=0.004, encoder_age_s=0.004, bumper_age_s=0.004),
    bus=A_BUS,
    unwritten=0,
    saving_error=None,
    last_write_s=0.004,
    drops={"lines": 0},
    errors={},
    ticks=100,
    missed_ticks=0,
    active=(),
    lessons=0,
    doing="stands and asks",
)


def aged(**ages_s: float) -> Snapshot:
    """Return the calm values with other ages of readings."""
    return replace(CALM, readings=CALM.readings._replace(**ages_s))  # type: ignore[arg-type]


class Ward:
    """One robot, looked at once a second."""

    def __init__(self) -> None:
        self.book = Diagnostics(load_kurt2(), tolerates_stalls=False)
        self.counted = CounterGrowth()
        self.now_s = 50.0
        self.counters = {"missed": 0, "junk": 0, "drops lines": 0}

    def look(self, snapshot: Snapshot = CALM, **changes: object) -> tuple[Trouble, ...]:
        """Return a report with `changes` of its other parts."""
        self.now_s += 1.0
        self.counted.update(dict(self.counters))
        parts = {"punctuality": WELL.punctuality, "disks": WELL.disks, "machine": WELL.machine} | changes
        missed = replace(
            parts["punctuality"],  # type: ignore[type-var]
            missed_lately=self.counted.growth("missed"),
            missed=self.counters["missed"],
        )
        return self.book.judge(
            replace(snapshot, now_s=self.now_s),
            missed,  # type: ignore[arg-type]
            parts["disks"],  # type: ignore[arg-type]
            parts["machine"],  # type: ignore[arg-type]
            self.counted,
        )

    def one(self, snapshot: Snapshot = CALM, **changes: object) -> Trouble:
        (trouble,) = self.look(snapshot, **changes)
        return trouble


@pytest.fixture
def ward() -> Ward:
    return Ward()


def test_silent_sensors_are_urgent_and_it_is_known_for_how_long(ward: Ward) -> None:
    first = ward.one(aged(infrared_age_s=0.6))
    assert first == Trouble(TroubleCode.SENSORS_SILENT, 0.0, True, "range sensors", (0.6,))
    later = ward.one(aged(infrared_age_s=1.6))
    assert (later.numbers, later.since_s) == ((1.6,), 1.0)
    assert ward.look() == ()
    unheard = ward.one(aged(bumper_age_s=math.inf))
    assert (unheard.code, unheard.name) == (TroubleCode.SENSORS_UNHEARD, "bumpers")
    assert ward.one(aged(infrared_age_s=0.6)).since_s == 0.0  # another silence than the one before


def test_a_missed_tick_is_told_for_a_minute(ward: Ward) -> None:
    ward.look()
    ward.counters["missed"] = 2
    assert ward.one() == Trouble(TroubleCode.TICKS_MISSED, 0.0, False, numbers=(2, 2))
    for _ in range(LATELY_S - 2):
        assert ward.one().code is TroubleCode.TICKS_MISSED
    assert ward.one().since_s == LATELY_S - 1
    assert ward.look() == ()


def test_ticks_are_late_from_a_fifth_of_a_period_on(ward: Ward) -> None:
    assert ward.look(punctuality=replace(WELL.punctuality, p99_ms=2.0)) == ()
    trouble = ward.one(punctuality=replace(WELL.punctuality, p99_ms=2.1))
    assert (trouble.code, trouble.urgent) == (TroubleCode.TICKS_LATE, False)


def test_the_bus_says_itself_what_is_wrong_and_what_to_do(ward: Ward) -> None:
    off = replace(A_BUS, controller_trouble="bus can0: bus-off; check cable; then restart", latched=GuardReason.BUS_OFF)
    alarm = ward.one(replace(CALM, bus=off))
    assert alarm == Trouble(TroubleCode.BUS_ALARM, 0.0, True, line=off.trouble)
    assert (alarm.what, alarm.to_do) == ("bus can0: bus-off", "check cable; then restart")
    ward.counters["junk"] = 12
    assert ward.one() == Trouble(TroubleCode.CAN_JUNK, 0.0, False, numbers=(12,))
    assert ward.look(replace(CALM, bus=None)) == ()  # a robot that tells of none


def test_a_disk_that_fails_fills_up_hangs_or_takes_its_time(ward: Ward) -> None:
    failing = ward.one(replace(CALM, saving_error="k: disk full; make room", unwritten=3))
    assert failing == Trouble(TroubleCode.LESSONS_UNSAVED, 0.0, True, line="k: disk full; make room")
    little = ward.one(disks=(DiskSpace("recordings", 499_000_000),))
    assert little == Trouble(TroubleCode.LITTLE_ROOM, 0.0, False, "recordings", (499.0,))
    assert ward.one(disks=(DiskSpace("recordings", 49_000_000),)).urgent
    assert ward.one(disks=(DiskSpace("knowledge", None),)).code is TroubleCode.DISK_SILENT
    slow = ward.one(replace(CALM, last_write_s=0.84))
    assert (slow.code, slow.numbers) == (TroubleCode.SLOW_DISK, (0.84,))


def test_diagnostics_slow_write_lasts_a_minute(ward: Ward) -> None:
    for _ in range(LATELY_S):
        assert ward.one(replace(CALM, last_write_s=0.84)).code is TroubleCode.SLOW_DISK
    ward.one(replace(CALM, last_write_s=0.84))
    assert ward.look(replace(CALM, last_write_s=0.84)) == ()
    ward.one(replace(CALM, last_write_s=0.6))
    assert ward.one().numbers == (0.6,)


def test_a_battery_counts_while_it_is_used_up(ward: Ward) -> None:
    assert ward.look(machine=replace(WELL.machine, battery=0.15, discharging=False)) == ()
    assert not ward.one(machine=replace(WELL.machine, battery=0.15)).urgent
    assert ward.one(machine=replace(WELL.machine, battery=0.05)).urgent
    assert ward.one(machine=replace(WELL.machine, available_bytes=50_000_000)).code is TroubleCode.LITTLE_MEMORY


def test_diagnostics_reports_drops_and_errors_of_parts(ward: Ward) -> None:
    ward.counters["drops lines"] = 40
    assert ward.one() == Trouble(TroubleCode.DROPS, 0.0, False, "lines", (40,))
    ward = Ward()
    said = ward.one(replace(CALM, errors={"channel": "phone: no key; pair it again"}))
    assert said == Trouble(TroubleCode.PROGRAM, 0.0, False, "channel", line="phone: no key; pair it again")


def test_diagnostics_orders_by_urgency_then_duration(ward: Ward) -> None:
    ward.look(replace(CALM, errors={"channel": "a"}))
    ward.look(replace(CALM, errors={"channel": "a", "recording": "b"}))
    troubles = ward.look(replace(aged(encoder_age_s=1.0), errors={"recording": "b", "channel": "a"}))
    assert [each.name for each in troubles] == ["encoders", "channel", "recording"]


@pytest.mark.parametrize(
    ("fault", "code"),
    [
        (SensorFault.STUCK, TroubleCode.SENSOR_STUCK),
        (SensorFault.OUT_OF_RANGE, TroubleCode.SENSOR_OUT_OF_RANGE),
        (SensorFault.SEES_NOTHING, TroubleCode.SENSOR_SEES_NOTHING),
        (SensorFault.SEES_A_PHANTOM, TroubleCode.SENSOR_SEES_A_PHANTOM),
    ],
)
def test_broken_sensors_are_a_trouble_each(fault: SensorFault, code: TroubleCode) -> None:
    sensors = (BrokenSensor(14, "s15", "front left edge", fault, 70), BrokenSensor(0, "s1", "left front", fault, 294))
    first, second = Ward().look(replace(CALM, broken_sensors=sensors))
    assert (first.code, first.name, first.numbers, first.urgent) == (code, "front left edge (s15)", (70,), False)
    assert (second.code, second.name, second.numbers) == (code, "left front (s1)", (294,))
