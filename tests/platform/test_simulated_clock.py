"""Time of a simulated robot: real, or faster in lockstep with its world."""

import pytest

from kurt2rt.platform.simulated_clock import SimulatedClock

PERIOD_S = 0.01


class RealTime:
    """A clock that passes while it is waited for, and while the test says that something takes its time."""

    def __init__(self) -> None:
        self.s = 500.0

    def now_s(self) -> float:
        return self.s

    async def wait_until(self, deadline_s: float) -> None:
        self.s = max(self.s, deadline_s)


class World:
    """Counts its steps, and takes some real time for each."""

    def __init__(self, real: RealTime) -> None:
        self.real = real
        self.takes_s = 0.0
        self.held = False
        self.steps = 0

    def hold(self) -> None:
        assert not self.held
        self.held = True

    def step(self) -> None:
        assert self.held
        self.steps += 1
        self.real.s += self.takes_s

    def go_on(self) -> None:
        assert self.held
        self.held = False


class Rig:
    """A clock, and a scheduler that waits for one deadline after the other."""

    def __init__(self) -> None:
        self.real = RealTime()
        self.world = World(self.real)
        self.clock = SimulatedClock(self.real, self.world, fastest=10)
        self.deadline_s = self.clock.now_s()

    async def tick(self, ticks: int) -> None:
        for _ in range(ticks):
            self.deadline_s += PERIOD_S
            before_s = self.clock.now_s()
            await self.clock.wait_until(self.deadline_s)
            assert self.clock.now_s() >= max(before_s, self.deadline_s - 1e-9)


async def test_simulated_clock_at_speed_1_never_jumps() -> None:
    rig = Rig()
    rig.clock.set(5)
    await rig.tick(500)
    rig.clock.set(1)
    await rig.tick(200)
    assert rig.clock.now_s() == pytest.approx(rig.deadline_s, abs=1e-6)
    assert rig.real.s == pytest.approx(503.0, abs=0.02)
    assert (rig.world.steps, rig.world.held) == (500, False)
    assert rig.clock.reached == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize("times", [0, 11])
def test_another_speed_is_refused(times: int) -> None:
    with pytest.raises(ValueError, match="give 1 to 10"):
        Rig().clock.set(times)
