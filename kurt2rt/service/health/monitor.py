"""Health report of the program, once a second."""

import queue
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Self

import psutil

from hal.health import Health
from kurt2rt.channel.protocol.health import (
    BusHealth,
    DiskSpace,
    Drops,
    HealthReport,
    JournalHealth,
    MachineHealth,
    SensorAges,
    TickLateness,
)
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import JournalWriter
from kurt2rt.platform.durable_files import free_bytes
from kurt2rt.runtime import Runtime
from kurt2rt.service.health.diagnostics import BUS_COUNTERS, CounterGrowth, Diagnostics
from kurt2rt.service.health.probes import Probes
from kurt2rt.service.health.snapshot import Snapshot, take_snapshot

_ENDS_WITHIN_S = 0.2
_POWER = Path("/sys/class/power_supply")
_DISKS_EVERY_S = 1.0
_DISK_ANSWERS_WITHIN_S = 4.0


class HealthMonitor:
    """Monitor that takes a snapshot once a second, between two ticks.

    A thread makes the report of it, because percentiles cost more than a tick.
    """

    def __init__(
        self,
        runtime: Runtime,
        keeping: JournalWriter,
        instruments: Probes,
        *,
        boot: str,
        knowledge: Path,
        now: Callable[[], float] = time.monotonic,
        tolerates_stalls: bool = False,
        plugins: tuple[str, ...] = (),
    ) -> None:
        """Start no thread yet.

        Args:
            runtime: runtime of the robot.
            keeping: writer of the journal.
            instruments: other parts of the program.
            boot: id of this start, hexadecimal.
            knowledge: path of the knowledge file.
            now: clock in s.
            tolerates_stalls: whether the robot stalls with this program.
            plugins: text of each plug-in in use.
        """
        self._runtime = runtime
        self._keeping = keeping
        folders = {"knowledge": knowledge.parent, **instruments.folders}
        self._instruments = replace(instruments, folders=folders)
        self._boot = boot
        self._knowledge = str(knowledge)
        self._plugins = plugins
        self._now = now
        self._every_ticks = max(1, round(1 / runtime.robot.cycle_s))
        self._started_s = now()
        self._started_at = datetime.now(UTC).isoformat(timespec="seconds")
        self._version = version("kurt2rt")
        self._listeners: list[Callable[[HealthReport], None]] = []
        self._ticks = 0
        self.newest: HealthReport | None = None
        """None in the first second."""
        # Used by the thread only, or by a test that calls `report`.
        self._disks = DiskMonitor(self._instruments.folders)
        self._machine = MachineMonitor()
        self._counted = CounterGrowth()
        self._troubles = Diagnostics(runtime.robot, tolerates_stalls=tolerates_stalls)
        self._waiting: queue.SimpleQueue[Snapshot | None] = queue.SimpleQueue()
        self._made: HealthReport | None = None
        self._thread = threading.Thread(target=self._run, name="health", daemon=True)

    def include(
        self,
        *,
        drops: Mapping[str, Callable[[], int]] | None = None,
        errors: Mapping[str, Callable[[], str]] | None = None,
    ) -> None:
        """Add parts of the program to the report, such as a channel that opened later.

        `drops`: number of dropped items by queue. `errors`: error and cure of each part, in a line; empty without one.
        """
        self._instruments = self._instruments.with_more(drops, errors)

    def add_listener(self, listener: Callable[[HealthReport], None]) -> None:
        """Call `listener` with each report, in the loop, after a tick; it must not wait."""
        self._listeners.append(listener)

    def after_tick(self, record: TickRecord) -> None:
        """Take a snapshot once a second and publish a new report; call it after each tick, it never waits."""
        self._ticks += 1
        if self._ticks % self._every_ticks == 0 and self._waiting.empty():
            self._waiting.put(self.snapshot(record))
        made = self._made
        if made is not self.newest and made is not None:
            self.newest = made
            for listener in self._listeners:
                listener(made)

    def snapshot(self, record: TickRecord) -> Snapshot:
        """Return the program's values after a tick."""
        return take_snapshot(self._runtime, record, self._keeping, self._instruments, self._now())

    def report(self, snapshot: Snapshot) -> HealthReport:
        """Return the report of one snapshot, in about 1 ms; call it once a second, for growth is counted by reports."""
        self._counted.update(_counters(snapshot))
        punctuality = self._punctuality(snapshot)
        disks, machine = self._disks.spaces(), self._machine.poll()
        last_write_s, readings = snapshot.last_write_s, snapshot.readings
        rlas = [each for each in snapshot.active if each.level == BASIC]
        return HealthReport(
            version=self._version,
            boot=self._boot,
            robot=self._runtime.robot.name,
            task=self._runtime.task.name,
            knowledge=self._knowledge,
            started_at=self._started_at,
            uptime_s=snapshot.now_s - self._started_s,
            tick=snapshot.tick,
            doing=snapshot.doing,
            rlas=len(rlas),
            actions=len({each.action for each in rlas if not each.is_withdrawn}),
            lessons=snapshot.lessons,
            punctuality=punctuality,
            ages=SensorAges(
                _finite(readings.infrared_age_s), _finite(readings.encoder_age_s), _finite(readings.bumper_age_s)
            ),
            bus=None if snapshot.bus is None else _bus_health(snapshot.bus),
            disks=disks,
            safety=JournalHealth(snapshot.unwritten, None if last_write_s is None else last_write_s * 1000),
            machine=machine,
            progress=snapshot.progress,
            phase=snapshot.phase,
            teacher=snapshot.teacher,
            reached=snapshot.reached,
            plugins=self._plugins,
            drops=tuple(Drops(of, count) for of, count in snapshot.drops.items()),
            troubles=self._troubles.judge(snapshot, punctuality, disks, machine, self._counted),
        )

    def __enter__(self) -> Self:
        self._disks.__enter__()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._waiting.put(None)
        self._thread.join(_ENDS_WITHIN_S)
        self._disks.__exit__()

    def _punctuality(self, snapshot: Snapshot) -> TickLateness:
        timer = self._runtime.timer
        lately, late = timer.lateness_of_last(self._every_ticks), timer.lateness()
        return TickLateness(
            newest_ms=lately.worst_us / 1000,
            median_ms=late.median_us / 1000,
            p99_ms=late.p99_us / 1000,
            worst_ms=late.worst_us / 1000,
            took_p99_ms=timer.tick().p99_us / 1000,
            ticks=snapshot.ticks,
            missed=snapshot.missed_ticks,
            missed_lately=self._counted.growth("missed"),
        )

    def _run(self) -> None:
        while (snapshot := self._waiting.get()) is not None:
            self._made = self.report(snapshot)


def _counters(snapshot: Snapshot) -> Mapping[str, int]:
    counters = {f"drops {of}": count for of, count in snapshot.drops.items()}
    counters["missed"] = snapshot.missed_ticks
    if snapshot.bus is not None:
        counters |= {name: getattr(snapshot.bus, name) for name in BUS_COUNTERS}
    return counters


def _bus_health(bus: Health) -> BusHealth:
    counters = {name: getattr(bus, name) for name in BUS_COUNTERS}
    return BusHealth(controller=bus.controller.value, frames=bus.frames, **counters)


def _finite(age_s: float) -> float | None:
    return age_s if age_s < float("inf") else None


class MachineMonitor:
    """Source of the health report's part on the machine: memory, processor and battery."""

    def __init__(self, power: Path = _POWER) -> None:
        """`power`: folder in which the kernel lists batteries."""
        self._power = power
        self._process = psutil.Process()
        self._looked_at_s = time.monotonic()
        self._used_s = time.process_time()

    def poll(self) -> MachineHealth:
        """Return the present values; takes some 100 µs."""
        now_s, used_s = time.monotonic(), time.process_time()
        share = (used_s - self._used_s) / max(now_s - self._looked_at_s, 1e-3)
        self._looked_at_s, self._used_s = now_s, used_s
        battery, discharging = battery_of(self._power)
        return MachineHealth(
            memory_bytes=self._process.memory_info().rss,
            available_bytes=psutil.virtual_memory().available,
            processor_share=share,
            threads=threading.active_count(),
            battery=battery,
            discharging=discharging,
        )


def battery_of(power: Path) -> tuple[float | None, bool]:
    """Return the charge of the emptiest battery, 0 to 1, and whether it is discharging; None and False without one.

    `power`: folder of the kernel's power supplies.
    """
    found = []
    for supply in sorted(power.glob("*")):
        # Mice and keyboards have batteries as well, with the scope Device.
        if _text(supply / "type") != "Battery" or _text(supply / "scope") == "Device":
            continue
        percent = _text(supply / "capacity")
        if percent.isdecimal():
            found.append((int(percent) / 100, _text(supply / "status") == "Discharging"))
    return min(found) if found else (None, False)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii").strip()
    except OSError:
        return ""


class DiskMonitor:
    """Threads that read the free space once a second; an answer counts for 4 s."""

    def __init__(self, folders: Mapping[str, Path], now: Callable[[], float] = time.monotonic) -> None:
        """`folders`: by the name of their content; `now`: a clock in s."""
        self._folders = dict(folders)
        self._now = now
        self._said: dict[str, tuple[float, int]] = {}
        self._ending = threading.Event()
        self._threads = [
            threading.Thread(target=self._run, args=(of,), name=f"room for {of}", daemon=True) for of in self._folders
        ]

    def poll(self, of: str) -> None:
        """Read the free space of one disk; may wait for the disk."""
        try:
            found = free_bytes(self._folders[of])
        except OSError:
            return  # reported as a disk that does not answer
        self._said[of] = self._now(), found

    def spaces(self) -> tuple[DiskSpace, ...]:
        """Return the newest space of each disk, without waiting; `free_bytes` is None if the disk does not answer."""
        now_s = self._now()
        found = []
        for of in self._folders:
            said_at_s, free_bytes = self._said.get(of, (float("-inf"), 0))
            found.append(DiskSpace(of, free_bytes if now_s - said_at_s <= _DISK_ANSWERS_WITHIN_S else None))
        return tuple(found)

    def __enter__(self) -> Self:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()  # not joined: a disk that hangs would hang the end

    def _run(self, of: str) -> None:
        self.poll(of)
        while not self._ending.wait(_DISKS_EVERY_S):
            self.poll(of)
