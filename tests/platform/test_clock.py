"""Simulated time."""

import anyio

from kurt2rt.platform.clock import LockstepClock


async def test_lockstep_clock_alternates_world_and_runtime() -> None:
    seen_s: list[float] = []
    clock = LockstepClock(lambda: seen_s.append(clock.now_s()))
    assert clock.now_s() == 0.0
    for number in range(1, 4):
        await clock.wait_until(number * 0.01)
        assert clock.now_s() == number * 0.01
    assert seen_s == [0.0, 0.01, 0.02]  # one step of the world before each deadline


async def test_others_get_their_turn_every_so_often() -> None:
    clock = LockstepClock(lambda: None, steps_per_checkpoint=10)
    turns_at_s: list[float] = []

    async def other() -> None:
        while clock.now_s() < 40:
            turns_at_s.append(clock.now_s())
            await anyio.lowlevel.checkpoint()

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(other)
        for number in range(1, 41):
            await clock.wait_until(float(number))
    assert turns_at_s == [10.0, 20.0, 30.0]
