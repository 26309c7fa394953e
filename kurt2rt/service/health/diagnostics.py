"""Diagnosis of health reports: troubles, and the time that each has lasted."""

import math
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from hal.robot_settings import RobotSettings
from hal.sensor_signs import SensorFault
from kurt2rt.channel.protocol.health import DiskSpace, MachineHealth, TickLateness, Trouble
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.service.health.snapshot import Snapshot

LATELY_S = 60
"""Window over which counters are judged, in s; one report per second."""
LATE_SHARE = 0.2
"""Fraction of a period by which a tick is late, 2 ms at 100 Hz."""
SLOW_WRITE_S = 0.5
LITTLE_ROOM_BYTES = 500 * 10**6
NO_ROOM_BYTES = 50 * 10**6
LITTLE_MEMORY_BYTES = 100 * 10**6
LOW_BATTERY = 0.2
EMPTY_BATTERY = 0.07


_SENSOR_FAULTS: Final = {
    SensorFault.STUCK: TroubleCode.SENSOR_STUCK,
    SensorFault.OUT_OF_RANGE: TroubleCode.SENSOR_OUT_OF_RANGE,
    SensorFault.SEES_NOTHING: TroubleCode.SENSOR_SEES_NOTHING,
    SensorFault.SEES_A_PHANTOM: TroubleCode.SENSOR_SEES_A_PHANTOM,
}


class _Found(NamedTuple):
    code: TroubleCode
    urgent: bool = False
    name: str = ""
    numbers: tuple[float, ...] = ()
    line: str = ""

    @property
    def key(self) -> tuple[str, str]:
        """Identity across reports: a sensor or disk keeps it when its code changes."""
        return self.code.about, self.name or self.code


class CounterGrowth:
    """Growth of error counters in the last minute, which tells present faults from old ones."""

    def __init__(self) -> None:
        self._past: deque[Mapping[str, int]] = deque([{}], maxlen=LATELY_S + 1)  # all begin at 0
        self._now: Mapping[str, int] = {}

    def update(self, counters: Mapping[str, int]) -> None:
        """Add the values of the counters; call it once a second."""
        self._now = counters
        self._past.append(counters)

    def growth(self, name: str) -> int:
        """Return the growth of one counter; 0 if it is not counted."""
        return self._now.get(name, 0) - self._past[0].get(name, 0)


class _Writes:
    """Slowest write of lessons in the last minute."""

    def __init__(self) -> None:
        self._newest_s: float | None = None
        self._slow: deque[tuple[float, float]] = deque()

    def update(self, now_s: float, last_write_s: float | None) -> None:
        """Add the duration of the newest write; an unchanged value belongs to the write before."""
        if last_write_s != self._newest_s:
            self._newest_s = last_write_s
            if last_write_s is not None and last_write_s > SLOW_WRITE_S:
                self._slow.append((now_s, last_write_s))
        while self._slow and now_s - self._slow[0][0] > LATELY_S:
            self._slow.popleft()

    @property
    def slowest_s(self) -> float | None:
        """Return the longest duration in s; None if all writes were quick."""
        return max((took_s for _, took_s in self._slow), default=None)


class Diagnostics:
    """Finder of the troubles in each health report, which remembers since when each one lasts."""

    def __init__(self, settings: RobotSettings, *, tolerates_stalls: bool = False) -> None:
        """`tolerates_stalls`: whether the robot stalls with this program, so that no tick is late or missed for it."""
        self._settings = settings
        self._tolerates_stalls = tolerates_stalls
        self._since_s: dict[tuple[str, str], float] = {}
        self._writes = _Writes()

    def judge(
        self,
        snapshot: Snapshot,
        punctuality: TickLateness,
        disks: tuple[DiskSpace, ...],
        machine: MachineHealth,
        counted: CounterGrowth,
    ) -> tuple[Trouble, ...]:
        """Return the troubles of one report: urgent ones first, then by the time that they have lasted."""
        self._writes.update(snapshot.now_s, snapshot.last_write_s)
        found = [
            *self._of_readings(snapshot),
            *_of_bus(snapshot, counted),
            *_of_keeping(snapshot, self._writes.slowest_s, disks),
            *self._of_ticks(punctuality),
            *_of_machine(machine),
            *_of_drops(snapshot, counted),
            *(_Found(TroubleCode.PROGRAM, name=part, line=line) for part, line in snapshot.errors.items()),
        ]
        now_s = snapshot.now_s
        self._since_s = {each.key: self._since_s.get(each.key, now_s) for each in found}
        troubles = [
            Trouble(each.code, now_s - self._since_s[each.key], each.urgent, each.name, each.numbers, each.line)
            for each in found
        ]
        return tuple(sorted(troubles, key=lambda each: (not each.urgent, -each.since_s)))

    def _of_readings(self, snapshot: Snapshot) -> Iterator[_Found]:
        guard, readings = self._settings.guard, snapshot.readings
        for name, age_s, stale_s in (
            ("range sensors", readings.infrared_age_s, guard.stale_infrared_s),
            ("encoders", readings.encoder_age_s, guard.stale_encoder_s),
            ("bumpers", readings.bumper_age_s, guard.stale_bumper_s),
        ):
            if math.isinf(age_s):
                yield _Found(TroubleCode.SENSORS_UNHEARD, True, name)
            elif not age_s <= stale_s:  # a NaN, too
                yield _Found(TroubleCode.SENSORS_SILENT, True, name, (age_s,))
        for sensor in snapshot.broken_sensors:
            yield _Found(_SENSOR_FAULTS[sensor.fault], False, sensor.title, (sensor.counts,))

    def _of_ticks(self, punctuality: TickLateness) -> Iterator[_Found]:
        if self._tolerates_stalls:
            return
        if punctuality.missed_lately:
            yield _Found(TroubleCode.TICKS_MISSED, numbers=(punctuality.missed_lately, punctuality.missed))
        bound_ms = LATE_SHARE * self._settings.cycle_s * 1000
        if punctuality.p99_ms > bound_ms:
            yield _Found(TroubleCode.TICKS_LATE, numbers=(punctuality.p99_ms,))


BUS_COUNTERS: Final = {
    "junk": TroubleCode.CAN_JUNK,
    "error_frames": TroubleCode.CAN_ERROR_FRAMES,
    "send_failures": TroubleCode.SEND_FAILURES,
    "receive_failures": TroubleCode.RECEIVE_FAILURES,
    "foreign_control": TroubleCode.FOREIGN_CONTROL,
}
"""Trouble of each counter of errors on the bus, by its name in hal.health.Health."""


def _of_bus(snapshot: Snapshot, counted: CounterGrowth) -> Iterator[_Found]:
    bus = snapshot.bus
    if bus is None:
        return
    if bus.trouble:
        yield _Found(TroubleCode.BUS_ALARM, bus.latched is not None, line=bus.trouble)
    for name, code in BUS_COUNTERS.items():
        lately = counted.growth(name)
        if lately:
            yield _Found(code, numbers=(lately,))


def _of_keeping(snapshot: Snapshot, slowest_write_s: float | None, disks: tuple[DiskSpace, ...]) -> Iterator[_Found]:
    if snapshot.saving_error:
        yield _Found(TroubleCode.LESSONS_UNSAVED, True, line=snapshot.saving_error)
    if slowest_write_s is not None:
        yield _Found(TroubleCode.SLOW_DISK, numbers=(slowest_write_s,))
    for disk in disks:
        if disk.free_bytes is None:
            yield _Found(TroubleCode.DISK_SILENT, True, disk.of)
        elif disk.free_bytes < LITTLE_ROOM_BYTES:
            urgent = disk.free_bytes < NO_ROOM_BYTES
            yield _Found(TroubleCode.LITTLE_ROOM, urgent, disk.of, (disk.free_bytes / 10**6,))


def _of_machine(machine: MachineHealth) -> Iterator[_Found]:
    if machine.battery is not None and machine.discharging and machine.battery < LOW_BATTERY:
        yield _Found(TroubleCode.LOW_BATTERY, machine.battery < EMPTY_BATTERY, numbers=(machine.battery,))
    available = machine.available_bytes
    if available is not None and available < LITTLE_MEMORY_BYTES:
        yield _Found(TroubleCode.LITTLE_MEMORY, numbers=(available / 10**6,))


def _of_drops(snapshot: Snapshot, counted: CounterGrowth) -> Iterator[_Found]:
    for queue in snapshot.drops:
        lately = counted.growth(f"drops {queue}")
        if lately:
            yield _Found(TroubleCode.DROPS, name=queue, numbers=(lately,))
