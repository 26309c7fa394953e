"""The scheduler on a clock that a test holds in its hand."""

from collections.abc import Callable

import pytest

from behaviors.motor_primitive import MotorPrimitive
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, SensorReadings, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.perception.perception import Perception
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import StatisticsCounter
from kurt2rt.core.teaching.authority import ControlAuthority
from kurt2rt.core.teaching.command_handler import CommandHandler
from kurt2rt.core.teaching.inbox import TeacherInbox
from kurt2rt.core.tick import Tick
from kurt2rt.core.tick_parts import TickOptions, TickParts
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.platform.scheduler import Scheduler
from kurt2rt.platform.tick_timer import TickTimer
from tests.core.perception.helpers import READINGS, SENSORS, definition

PERIOD_S = 0.01


class HandClock:
    """Time that passes only by waiting and by what the test adds."""

    def __init__(self, start_s: float = 0.0) -> None:
        self.time_s = start_s
        self.deadlines_s: list[float] = []

    def now_s(self) -> float:
        return self.time_s

    async def wait_until(self, deadline_s: float) -> None:
        self.deadlines_s.append(deadline_s)
        self.time_s = max(self.time_s, deadline_s)


class StandingRobot:
    """Senses the time and stands."""

    def sense(self, now_s: float) -> SensorReadings:
        return SensorReadings(now_s, (100,) * len(SENSORS), 0.0, 0, 0, 0.0, 0, 0.0)

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:  # noqa: ARG002 - it stands
        return GuardResult(STANDSTILL, (), latched=False)

    def emergency_stop(self, reason: GuardReason) -> None:
        raise AssertionError(reason)

    def release(self) -> None:
        raise AssertionError("the scheduler was not stopped")

    def close(self) -> None:
        raise AssertionError("a scheduler does not close the robot")


class Run:
    """A scheduler, and what its ticks were."""

    def __init__(self, clock: HandClock) -> None:
        small = definition(READINGS)
        level = BasicLevel(
            RlaSystem(small.dimensions, 10.0), {"stand": MotorPrimitive(STANDSTILL)}, 1, ActiveBehaviour()
        )
        self.clock = clock
        self.timer = TickTimer(capacity=100)
        school = CommandHandler(
            level,
            ControlAuthority(level.repertoire, attended=False),
            insert_radius_fraction=0.5,
            handled_command_ids=(),
        )
        parts = TickParts(
            robot=StandingRobot(),
            perception=Perception(small, SENSORS),
            level=level,
            handler=school,
            inbox=TeacherInbox(),
            event_store=NoTeachingAllowed(),
            statistics=StatisticsCounter(),
            timer=self.timer,
        )
        tick = Tick(parts, TickOptions(stale_infrared_s=0.05), now=clock.now_s)
        self.scheduler = Scheduler(clock, tick.run, PERIOD_S, self.timer)
        self.records: list[TickRecord] = []
        self.delays_s: dict[int, float] = {}
        """How much longer than nothing the work after a tick takes, by the tick's number."""

    async def ticks(self, ticks: int | None, after_tick: Callable[[TickRecord], None] = lambda _: None) -> list[int]:
        """Run, and give the numbers of the ticks that were."""
        before = len(self.records)

        def note(record: TickRecord) -> None:
            self.records.append(record)
            self.clock.time_s += self.delays_s.get(record.tick, 0.0)
            after_tick(record)

        await self.scheduler.run(ticks, note)
        return [record.tick for record in self.records[before:]]


async def test_deadlines_do_not_drift_with_late_ticks() -> None:
    run = Run(HandClock())
    run.delays_s = dict.fromkeys(range(1, 500), 0.006)  # each tick's work takes more than half the period
    await run.ticks(500)
    assert run.timer.missed_ticks == 0
    assert run.clock.deadlines_s == [number * PERIOD_S for number in range(1, 501)]


async def test_a_late_tick_is_run_late_and_the_next_one_on_time() -> None:
    run = Run(HandClock())
    run.delays_s = {2: 0.015}  # tick 3 begins half a period late: not missed
    assert await run.ticks(5) == [1, 2, 3, 4, 5]
    assert [round(record.now_s, 6) for record in run.records] == [0.01, 0.02, 0.035, 0.04, 0.05]
    assert run.timer.missed_ticks == 0
    assert run.timer.lateness().worst_us == pytest.approx(5000, abs=1)


async def test_scheduler_missed_ticks_are_skipped_and_counted() -> None:
    run = Run(HandClock())
    run.delays_s = {3: 0.0578}
    assert await run.ticks(15) == [1, 2, 3, 8, 9, 10, 11, 12, 13, 14, 15]
    assert run.timer.missed_ticks == 4
    assert run.timer.ticks == 11
    starts_s = [record.now_s for record in run.records]
    assert starts_s[3] == pytest.approx(0.0878)
    assert starts_s[4:] == pytest.approx([number * PERIOD_S for number in range(9, 16)])
    assert run.timer.lateness().worst_us == pytest.approx(7800, abs=1)


async def test_end_lets_it_return_after_the_tick_it_is_in() -> None:
    run = Run(HandClock())

    def end_in_third(record: TickRecord) -> None:
        if record.tick == 3:
            run.scheduler.end()

    assert await run.ticks(None, end_in_third) == [1, 2, 3]
    assert await run.ticks(2) == [4, 5]
