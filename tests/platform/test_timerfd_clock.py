"""Real time: that it waits at all, and not how exactly; how exactly is measured by the benchmark."""

from kurt2rt.platform.timerfd_clock import TimerfdClock


async def test_it_returns_at_the_deadline_and_not_before() -> None:
    with TimerfdClock() as clock:
        for _ in range(5):
            deadline_s = clock.now_s() + 0.003
            await clock.wait_until(deadline_s)
            assert clock.now_s() >= deadline_s
