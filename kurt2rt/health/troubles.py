"""What is not as it should be, in words: what, since when, what to do."""

import math
from collections import deque
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from hal.robot_settings import RobotSettings
from kurt2rt.health.report import SENSORS, DiskSpace, Machine, Punctuality, Trouble
from kurt2rt.health.snapshot import Snapshot

LATELY_S = 60
"""Counters are judged by how they grew in so many seconds, one report each."""
LATE_SHARE = 0.2
"""Of a period: ticks that begin later than that are late, 2 ms at 100 Hz."""
TOLERATED_SHARE = 0.1
"""Of the ticks of the last minute: fewer missed ones are no trouble where the robot stalls with the program, for it
then still drives as it was taught.
"""
SLOW_WRITE_S = 0.5
LITTLE_ROOM_BYTES = 500 * 10**6
NO_ROOM_BYTES = 50 * 10**6
LITTLE_MEMORY_BYTES = 100 * 10**6
LOW_BATTERY = 0.2
EMPTY_BATTERY = 0.07


class _Found(NamedTuple):
    about: str
    key: str
    """Stays the same while the words change with the numbers."""
    what: str
    to_do: str
    urgent: bool


class Counted:
    """How counters grew in the last minute."""

    def __init__(self) -> None:
        self._past: deque[Mapping[str, int]] = deque([{}], maxlen=LATELY_S + 1)  # all begin at nothing
        self._now: Mapping[str, int] = {}

    def see(self, counters: Mapping[str, int]) -> None:
        """Their values, once a second."""
        self._now = counters
        self._past.append(counters)

    def lately(self, name: str) -> int:
        """How much one grew; nothing for one that is not counted."""
        return self._now.get(name, 0) - self._past[0].get(name, 0)


class _Writes:
    """The slowest write of lessons in the last minute."""

    def __init__(self) -> None:
        self._newest_s: float | None = None
        self._slow: deque[tuple[float, float]] = deque()

    def see(self, now_s: float, last_write_s: float | None) -> None:
        """What the newest one took; a value that is there still is of the same write."""
        if last_write_s != self._newest_s:
            self._newest_s = last_write_s
            if last_write_s is not None and last_write_s > SLOW_WRITE_S:
                self._slow.append((now_s, last_write_s))
        while self._slow and now_s - self._slow[0][0] > LATELY_S:
            self._slow.popleft()

    @property
    def slowest_s(self) -> float | None:
        """None when all were quick."""
        return max((took_s for _, took_s in self._slow), default=None)


class TroubleBook:
    """Finds what is wrong in each report, and remembers since when."""

    def __init__(self, settings: RobotSettings, *, tolerates_stalls: bool = False) -> None:
        """`tolerates_stalls`: of a robot that stalls with this program; late ticks are then no trouble."""
        self._settings = settings
        self._tolerates_stalls = tolerates_stalls
        self._since_s: dict[str, float] = {}
        self._writes = _Writes()

    def judge(
        self,
        snapshot: Snapshot,
        punctuality: Punctuality,
        disks: tuple[DiskSpace, ...],
        machine: Machine,
        counted: Counted,
    ) -> tuple[Trouble, ...]:
        """The troubles of one report: the urgent ones first, then those that have lasted longest."""
        self._writes.see(snapshot.now_s, snapshot.last_write_s)
        found = [
            *self._of_senses(snapshot),
            *_of_bus(snapshot, counted),
            *_of_keeping(snapshot, self._writes.slowest_s, disks),
            *self._of_ticks(punctuality),
            *_of_machine(machine),
            *_of_drops(snapshot, counted),
            *(_said(part, line) for part, line in snapshot.says.items()),
        ]
        now_s = snapshot.now_s
        self._since_s = {each.key: self._since_s.get(each.key, now_s) for each in found}
        troubles = [
            Trouble(each.about, each.what, now_s - self._since_s[each.key], each.to_do, each.urgent) for each in found
        ]
        return tuple(sorted(troubles, key=lambda each: (not each.urgent, -each.since_s)))

    def _of_senses(self, snapshot: Snapshot) -> Iterator[_Found]:
        guard = self._settings.guard
        for name, age_s, stale_s in (
            ("infra-red sensors", snapshot.infrared_age_s, guard.stale_infrared_s),
            ("encoders", snapshot.encoder_age_s, guard.stale_encoder_s),
            ("bumpers", snapshot.bumper_age_s, guard.stale_bumper_s),
        ):
            if age_s <= stale_s:
                continue
            silent = "have never been heard" if math.isinf(age_s) else f"are silent, the newest is {age_s:.1f} s old"
            to_do = "look whether the robot is switched on and its CAN cable sits; the robot stands until they are back"
            yield _Found(SENSORS, name, f"the {name} {silent}", to_do, True)

    def _of_ticks(self, punctuality: Punctuality) -> Iterator[_Found]:
        to_do = "end other work on this machine; kurt2rt doctor says what it lacks, real_time_priority helps"
        lately_ticks = min(punctuality.ticks, round(LATELY_S / self._settings.can.cycle_s))
        if self._tolerates_stalls and punctuality.missed_lately <= TOLERATED_SHARE * lately_ticks:
            return
        if punctuality.missed_lately:
            what = f"{_many(punctuality.missed_lately, 'tick')} missed in the last minute, {punctuality.missed} in all"
            yield _Found("ticks", "missed", what, to_do, False)
        bound_ms = LATE_SHARE * self._settings.can.cycle_s * 1000
        if punctuality.p99_ms > bound_ms and not self._tolerates_stalls:
            what = f"one tick in a hundred begins {punctuality.p99_ms:.1f} ms late or later"
            yield _Found("lateness", "late", what, to_do, False)


def _of_bus(snapshot: Snapshot, counted: Counted) -> Iterator[_Found]:
    bus = snapshot.bus
    if bus is None:
        return
    if bus.trouble:
        yield _told("bus", "bus", bus.trouble, urgent=bus.latched is not None)
    check = "check cable, termination and bit rate"
    for name, what, to_do in (
        ("junk", "CAN frames with junk in them", check),
        ("error frames", "CAN error frames", check),
        ("send failures", "CONTROL frames that the bus did not take", check),
        ("receive failures", "times that the bus could not be read", check),
        ("foreign control", "CONTROL frames of somebody else", "find the other sender and end it"),
    ):
        lately = counted.lately(name)
        if lately:
            yield _Found("bus", name, f"{lately} {what} in the last minute", to_do, False)


def _of_keeping(snapshot: Snapshot, slowest_write_s: float | None, disks: tuple[DiskSpace, ...]) -> Iterator[_Found]:
    if snapshot.keeper_trouble:
        yield _told("lessons", "keeper", snapshot.keeper_trouble, urgent=True)
    if slowest_write_s is not None:
        what = f"in the last minute the disk took up to {slowest_write_s:.1f} s to keep a lesson"
        yield _Found("lessons", "slow disk", what, "end what else writes to it; kurt2rt doctor measures it", False)
    for disk in disks:
        if disk.free_bytes is None:
            what = f"the disk of {disk.of} does not answer"
            yield _Found("disk", f"disk {disk.of}", what, "look at its health and its mount", True)
        elif disk.free_bytes < LITTLE_ROOM_BYTES:
            what = f"only {disk.free_bytes / 10**6:.0f} MB are free for {disk.of}"
            urgent = disk.free_bytes < NO_ROOM_BYTES
            yield _Found("disk", f"disk {disk.of}", what, "make room on that disk, or move old recordings away", urgent)


def _of_machine(machine: Machine) -> Iterator[_Found]:
    if machine.battery is not None and machine.discharging and machine.battery < LOW_BATTERY:
        what = f"this machine's battery has {machine.battery:.0%} left"
        yield _Found("machine", "battery", what, "plug it in", machine.battery < EMPTY_BATTERY)
    available = machine.available_bytes
    if available is not None and available < LITTLE_MEMORY_BYTES:
        what = f"this machine has {available / 10**6:.0f} MB of memory left"
        yield _Found("machine", "memory", what, "end other programs", False)


def _of_drops(snapshot: Snapshot, counted: Counted) -> Iterator[_Found]:
    for queue in snapshot.drops:
        lately = counted.lately(f"drops {queue}")
        if lately:
            what = f"{queue}: {lately} thrown away in the last minute, for they came quicker than they were taken"
            yield _Found("queues", f"drops {queue}", what, "", False)


def _said(part: str, line: str) -> _Found:
    return _told("program", f"says {part}", line, urgent=False)


def _told(about: str, key: str, line: str, *, urgent: bool) -> _Found:
    """A line as all of this project are: what is wrong, and behind a semicolon what to do."""
    what, _, to_do = line.partition("; ")
    return _Found(about, key, what, to_do, urgent)


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
