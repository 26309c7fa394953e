"""Phase of the ticks in the period, with a simulated clock."""

import pytest

from hal.kurt2_settings import load_kurt2
from hal.simulation import Simulation
from kurt2rt.checks.bench.robot_under_test import BenchFixture
from kurt2rt.checks.bench.tick_phase import LoopPacer
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.runtime import build_runtime


class PunctualClock:
    """Simulated time in which every wait ends at its deadline."""

    def __init__(self) -> None:
        self._now_s = 100.0

    def now_s(self) -> float:
        return self._now_s

    async def wait_until(self, deadline_s: float) -> None:
        self._now_s = max(self._now_s, deadline_s)


async def test_a_shift_moves_all_later_ticks_and_loses_none(untaught: BenchFixture) -> None:
    clock, settings = PunctualClock(), load_kurt2()
    simulation: Simulation = untaught.open_simulation("pace")
    runtime = build_runtime(simulation.robot, settings, untaught.task, (), NoTeachingAllowed(), clock)
    pace = LoopPacer(runtime.scheduler, clock)
    seen: list[tuple[int, float]] = []

    def after_tick(record: TickRecord) -> None:
        seen.append((record.tick, round(record.now_s - 100.0, 6)))
        if record.tick == 2:
            pace.shift(0.004)
        elif record.tick == 4:
            pace.end()

    try:
        await pace.run(after_tick)
    finally:
        simulation.close()
    assert [tick for tick, _ in seen] == [1, 2, 3, 4]
    assert [now_s for _, now_s in seen] == pytest.approx([0.01, 0.02, 0.034, 0.044])
