"""Simulated time."""

from kurt2rt.platform.clock import LockstepClock


async def test_lockstep_clock_alternates_world_and_runtime() -> None:
    seen_s: list[float] = []
    clock = LockstepClock(lambda: seen_s.append(clock.now_s()))
    assert clock.now_s() == 0.0
    for number in range(1, 4):
        await clock.wait_until(number * 0.01)
        assert clock.now_s() == number * 0.01
    assert seen_s == [0.0, 0.01, 0.02]  # one step of the world before each deadline
