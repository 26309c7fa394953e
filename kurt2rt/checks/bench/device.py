"""A teacher's device in a process of its own: `python -m kurt2rt.checks.bench.device FOLDER PORT`."""

import itertools
import sys
import time
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import anyio

from kurt2rt.checks.bench.job_loop import run_jobs
from kurt2rt.checks.bench.press_schedule import SPEED_M_S, press_schedules
from kurt2rt.checks.bench.robot_under_test import SEED
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.client import TeacherClient


class BenchmarkRefusedError(RuntimeError):
    """The robot does not do what the benchmark needs."""


class BenchDevice:
    """Looks at the robot, watches over it, drives it and teaches it, as it is asked to."""

    def __init__(self, folder: Path, port: int) -> None:
        self._folder = folder
        self._port = port
        self._opened = AsyncExitStack()
        self._schedules = press_schedules(SEED)
        self._actions = itertools.cycle(("forward", "back"))
        self._forward = True
        self._client: TeacherClient | None = None

    async def look(self) -> dict[str, Any]:
        """Connect and receive the robot's states without being its teacher; return {}.

        Ends the connection before. Raises CredentialsError, ChannelError.
        """
        await self._join(watching=False)
        return {}

    async def watch(self) -> dict[str, Any]:
        """Connect, take the robot and renew the teacher's presence many times a second; return {}.

        Ends the connection before. Raises BenchmarkRefusedError if the robot refuses, CredentialsError, ChannelError,
        NoAnswerError.
        """
        await self._join(watching=True)
        return {}

    async def leave(self) -> dict[str, Any]:
        """Close the connection; return {}. `look` or `watch` opens another one."""
        await self._opened.aclose()
        return {}

    async def press(self, presses: int) -> dict[str, Any]:
        """Press so many times, alternately forward and backward; call it after `look` or `watch`.

        Returns {"presses": [(ns on the monotonic clock, forward)]}. Raises BenchmarkRefusedError without a connection,
        NoAnswerError.
        """
        robot, made = self._robot, []
        for _ in range(presses):
            schedule = next(self._schedules)
            speed_m_s = SPEED_M_S if self._forward else -SPEED_M_S
            begun_s = anyio.current_time()
            made.append((time.monotonic_ns(), self._forward))
            robot.press(speed_m_s, speed_m_s)
            await anyio.sleep(schedule.held_s)
            await robot.let_go()
            self._forward = not self._forward
            await anyio.sleep_until(begun_s + schedule.next_s)
        return {"presses": made}

    async def teach(self, lessons: int) -> dict[str, Any]:
        """Answer so many situations, each between two ticks; call it after `watch`.

        Returns {"took_ns": [ns until each lesson was known to be durable]}. Raises BenchmarkRefusedError if the robot
        refuses or there is no connection, NoAnswerError.
        """
        took_ns = []
        for _ in range(lessons):
            await anyio.sleep(next(self._schedules).held_s / 2)  # the teacher does not know when ticks begin
            action = next(self._actions)
            begun_ns = time.monotonic_ns()
            _require(await self._robot.answer(action))
            took_ns.append(time.monotonic_ns() - begun_ns)
        return {"took_ns": took_ns}

    async def close(self) -> None:
        """Close the connection at the end of the process."""
        await self._opened.aclose()

    @property
    def _robot(self) -> TeacherClient:
        if self._client is None:
            raise BenchmarkRefusedError("look or watch comes first")
        return self._client

    async def _join(self, *, watching: bool) -> None:
        await self._opened.aclose()
        robot = self._client = TeacherClient(self._folder, port=self._port)
        await self._opened.enter_async_context(robot)
        robot.watching = watching
        if watching:
            _require(await robot.take())
        async for _ in robot.states():
            return


def _require(answer: Answer) -> None:
    if not answer.accepted:
        raise BenchmarkRefusedError(f"{answer.why}: {answer.text}")


async def main(folder: Path, port: int) -> None:
    """Run the jobs of a `BenchDevice` until standard input ends.

    `folder`: of the pairing. `port`: UDP port of the robot on this machine.
    """
    device = BenchDevice(folder, port)
    try:
        await run_jobs(
            {
                "look": device.look,
                "watch": device.watch,
                "leave": device.leave,
                "press": device.press,
                "teach": device.teach,
            }
        )
    finally:
        await device.close()


if __name__ == "__main__":
    anyio.run(main, Path(sys.argv[1]), int(sys.argv[2]))
