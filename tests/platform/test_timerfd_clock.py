"""Real time: that it waits at all, and not how exactly; how exactly is measured by the benchmark."""

import asyncio

from kurt2rt.platform.timerfd_clock import TimerfdClock


async def test_it_returns_at_the_deadline_and_not_before() -> None:
    with TimerfdClock() as clock:
        for _ in range(5):
            deadline_s = clock.now_s() + 0.003
            await clock.wait_until(deadline_s)
            assert clock.now_s() >= deadline_s


async def test_others_run_while_it_waits() -> None:
    with TimerfdClock() as clock:
        order: list[str] = []
        deadline_s = clock.now_s() + 0.02
        asyncio.get_running_loop().call_soon(order.append, "other")
        await clock.wait_until(deadline_s)
        order.append("deadline")
        assert order == ["other", "deadline"]


async def test_timerfd_cancelled_wait_keeps_the_next_deadline() -> None:
    with TimerfdClock() as clock:
        near_s = clock.now_s() + 0.002
        near = asyncio.ensure_future(clock.wait_until(near_s))
        await asyncio.sleep(0)
        while clock.now_s() < near_s:
            pass  # the timer fires while the loop is busy, so no read has emptied it yet
        near.cancel()
        deadline_s = clock.now_s() + 0.01
        await clock.wait_until(deadline_s)
        assert clock.now_s() >= deadline_s
