"""Benchmark of the time from a press to the wheels."""

from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

from kurt2rt.checks.bench.helper_process import helper_process
from kurt2rt.checks.bench.open_robot import OpenRobot, open_robot
from kurt2rt.checks.bench.press_schedule import PressTime, waits_ns
from kurt2rt.checks.bench.result import BenchGoal, BenchResult, Reference
from kurt2rt.checks.bench.robot_under_test import BenchFixture, OnProgress
from kurt2rt.platform.ledger import percentiles_of

MEDIAN_LIMIT_US = 25_000.0
P99_LIMIT_US = 60_000.0
_PRESSES_AT_ONCE = 10
_WARMING_UP = 1

_Ask = Callable[..., Awaitable[dict[str, Any]]]


async def measure_presses(fixture: BenchFixture, folder: Path, presses: int, on_progress: OnProgress) -> BenchResult:
    """Measure from a press in a teacher's program to the first moving CONTROL frame; files go to `folder`.

    Raises KnowledgeError, ChannelError, CredentialsError, HelperLostError, OSError without a timerfd.
    """
    async with (
        open_robot(fixture, folder) as robot,
        helper_process("kurt2rt.checks.bench.device", *robot.address) as device,
    ):
        await device.ask("watch")
        return await _pressed(robot, device.ask, presses, "press to CONTROL", on_progress)


async def measure_presses_on_page(
    fixture: BenchFixture, folder: Path, presses: int, on_progress: OnProgress
) -> BenchResult:
    """Measure from a press on the teacher's page, over WebSocket and page server; files go to `folder`.

    Raises KnowledgeError, ChannelError, CredentialsError, HelperLostError, OSError without a timerfd.
    """
    async with open_robot(fixture, folder) as robot, AsyncExitStack() as ending:
        page = await ending.enter_async_context(helper_process("kurt2rt.checks.bench.page_process", *robot.address))
        place = await page.ask("place")
        browser = await ending.enter_async_context(
            helper_process("kurt2rt.checks.bench.browser", str(place["port"]), place["cookie"])
        )
        await browser.ask("take")
        return await _pressed(robot, browser.ask, presses, "  from the page", on_progress)


async def _pressed(robot: OpenRobot, ask: _Ask, presses: int, what: str, on_progress: OnProgress) -> BenchResult:
    await ask("press", presses=_WARMING_UP)  # what is slow but once
    made: list[PressTime] = []
    while len(made) < presses:
        answer = await ask("press", presses=min(_PRESSES_AT_ONCE, presses - len(made)))
        made += [PressTime(*press) for press in answer["presses"]]
        # Only here: drawing a progress bar takes milliseconds of the loop.
        on_progress(len(made) / presses)
    waits = waits_ns(made, robot.observer.starts)
    return press_result(what, waits, lost=presses - len(waits), period_s=robot.runtime.robot.cycle_s)


def press_result(what: str, waits_ns: list[int], *, lost: int, period_s: float) -> BenchResult:
    """Return the result of presses with the period of the loop in s as reference.

    `what`: name of the result. `waits_ns`: time of each press that moved the wheels. `lost`: number of presses that did
    not.
    """
    took = percentiles_of(waits_ns)
    return BenchResult(
        "channel",
        what,
        took,
        Reference("period", period_s * 1e6, took.median_us),
        (
            BenchGoal("median us", took.median_us, MEDIAN_LIMIT_US),
            BenchGoal("p99 us", took.p99_us, P99_LIMIT_US),
            BenchGoal("lost", lost, 0),
        ),
        f"{len(waits_ns) + lost} presses, {lost} lost; the wait for the next tick "
        f"({period_s * 500:g} ms on average) included",
    )
