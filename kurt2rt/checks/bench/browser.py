"""Browser process with the teacher's page open: `python -m kurt2rt.checks.bench.browser PORT COOKIE`.

It sends what the page's JavaScript sends, with the same period, and paints nothing.
"""

import itertools
import json
import sys
import time
from collections.abc import Callable
from typing import Any

import anyio
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Origin

from kurt2rt.checks.bench.job_loop import run_jobs
from kurt2rt.checks.bench.press_schedule import SPEED_M_S, press_schedules
from kurt2rt.checks.bench.robot_under_test import SEED

_BEAT_S = 0.1
_PRESS_S = 0.05


class Browser:
    """Page with the control lease."""

    def __init__(self, page: ClientConnection) -> None:
        self._page = page
        self._schedules = press_schedules(SEED)
        self._forward = True
        self._numbers = itertools.count(1)
        self._picture: int | None = None
        self._teacher: str | None = None
        self._news = anyio.Event()

    async def listen(self) -> None:
        """Receive state updates until the connection ends; run it as a task, for `take` and `press` need it."""
        async for text in self._page:
            told = json.loads(text)
            if told["kind"] == "state":
                self._picture, self._teacher = told["picture"], told["teacher"]
                self._news.set()
                self._news = anyio.Event()

    async def beat(self) -> None:
        """Report periodically that the page is open and visible, until cancelled."""
        while True:
            await self._say("beat", picture=self._picture, at_ms=time.monotonic() * 1000)
            await anyio.sleep(_BEAT_S)

    async def take(self) -> dict[str, Any]:
        """Take control of the robot and wait until a state says so; return {}."""
        await self._see(lambda: self._picture is not None)
        await self._say("order", number=next(self._numbers), name="take", arguments={}, picture=self._picture)
        await self._see(lambda: self._teacher is not None)
        return {}

    async def press(self, presses: int) -> dict[str, Any]:
        """Press alternately forward and backward; return {"presses": [(ns on the monotonic clock, forward)]}."""
        made = []
        for _ in range(presses):
            schedule = next(self._schedules)
            speed_m_s = SPEED_M_S if self._forward else -SPEED_M_S
            hold = next(self._numbers)
            begun_s = anyio.current_time()
            made.append((time.monotonic_ns(), self._forward))
            while (left_s := begun_s + schedule.held_s - anyio.current_time()) > 0:
                await self._say("press", hold=hold, left_m_s=speed_m_s, right_m_s=speed_m_s, picture=self._picture)
                await anyio.sleep(min(_PRESS_S, left_s))
            await self._say("release")
            self._forward = not self._forward
            await anyio.sleep_until(begun_s + schedule.next_s)
        return {"presses": made}

    async def _say(self, kind: str, **fields: Any) -> None:
        await self._page.send(json.dumps({"kind": kind, **fields}))

    async def _see(self, shown: Callable[[], bool]) -> None:
        while not shown():
            await self._news.wait()


async def main(port: int, cookie: str) -> None:
    """Connect to the page on the local TCP `port` with this cookie, and run jobs until standard input ends."""
    host = f"127.0.0.1:{port}"
    async with connect(
        f"ws://{host}/robot", origin=Origin(f"http://{host}"), additional_headers={"Cookie": cookie}, compression=None
    ) as page:
        browser = Browser(page)
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(browser.listen)
            tasks.start_soon(browser.beat)
            await run_jobs({"take": browser.take, "press": browser.press})
            tasks.cancel_scope.cancel()


if __name__ == "__main__":
    anyio.run(main, int(sys.argv[1]), sys.argv[2])
