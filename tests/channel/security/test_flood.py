"""Junk by the thousand a second: the robot's memory does not grow, its teacher keeps control, a stop gets through."""

import json
import os
import re
import signal
import sys
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import anyio
import pytest
import yaml
from anyio.abc import Process
from anyio.streams.text import TextReceiveStream

from kurt2rt.channel.security.pairing import Pairing, local_pairing
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import NoAnswerError
from tests.channel.robot_at_work import service_settings
from tests.channel.robot_process import resident_kb
from tests.patience import PATIENCE_S

_MOST_GROWTH_KB = 20 * 1024
_STOP_WITHIN_S = 1.0
"""Ten times what a stop took at most on a machine with two busy cores."""


class Child:
    """A process and the lines that it prints."""

    def __init__(self, process: Process) -> None:
        assert process.stdout is not None
        self._process = process
        self._text = TextReceiveStream(process.stdout, errors="replace")
        self._rest = ""
        self.lines: list[str] = []

    @property
    def pid(self) -> int:
        return self._process.pid

    async def line(self, holds: Callable[[str], Any]) -> str:
        """Wait for a line with which something holds."""
        with anyio.fail_after(PATIENCE_S):
            while True:
                for line in self.lines:
                    if holds(line):
                        return line
                await self._read()

    async def over(self) -> list[str]:
        """Send SIGTERM; all that it printed."""
        self._process.terminate()
        with anyio.fail_after(PATIENCE_S):
            while True:
                try:
                    await self._read()
                except anyio.EndOfStream:
                    break
            await self._process.wait()
        return self.lines

    async def _read(self) -> None:
        *lines, self._rest = (self._rest + await self._text.receive()).split("\n")
        self.lines += lines


@asynccontextmanager
async def child(*arguments: str) -> AsyncIterator[Child]:
    """Run a Python process; kill it at the end if it still runs."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3]), "COLUMNS": "300"}
    async with await anyio.open_process([sys.executable, *arguments], env=environment, stderr=None) as process:
        try:
            yield Child(process)
        finally:
            if process.returncode is None:
                process.send_signal(signal.SIGKILL)


@dataclass(frozen=True, slots=True)
class Seen:
    """Measurements of robot and teacher."""

    resident_kb: list[int]
    """Each second, from before the flood."""
    robot: list[dict[str, Any]]
    """Lines of the robot process, one each second."""
    teacher: dict[str, Any]

    @property
    def growth_kb(self) -> int:
        return max(self.resident_kb) - self.resident_kb[0]

    @property
    def answered(self) -> float:
        told = self.teacher["told"]
        return 1.0 - float(told.get("no answer", 0) / sum(told.values()))


async def _taught_under_flood(robot: Child, port: int, device: Path, calm_s: float, flood_s: float) -> Seen:
    async with child("-m", "tests.channel.teacher_process", str(device), str(port)) as teacher:
        await teacher.line(lambda line: line == "teaching")
        await anyio.sleep(calm_s)
        resident = [resident_kb(str(robot.pid))]
        async with child("-m", "tests.channel.junk_process", str(port), "2000", "") as junk:
            for _ in range(round(flood_s)):
                await anyio.sleep(1.0)
                resident.append(resident_kb(str(robot.pid)))
            await junk.over()
        told = json.loads((await teacher.over())[-1])
    lines = [json.loads(line) for line in await robot.over() if line.startswith("{")]
    return Seen(resident, lines, told)


async def _simulated_robot(folder: Path, calm_s: float, flood_s: float) -> Seen:
    """Run the robot program."""
    pairing = _pairing(folder)
    settings = folder / "flood.yaml"
    settings.write_text(yaml.safe_dump(service_settings(folder).model_dump()), encoding="utf-8")
    async with child("-m", "kurt2rt.cli.main", "run", "--settings", str(settings)) as robot:
        found = re.search(r"UDP port (\d+)", await robot.line(lambda line: "UDP port" in line))
        assert found is not None
        return await _taught_under_flood(robot, int(found[1]), pairing.device.folder, calm_s, flood_s)


def _pairing(folder: Path) -> Pairing:
    return local_pairing(folder / "teachers", folder / "devices")


def _must_have_kept_control(seen: Seen) -> None:
    assert seen.teacher["told"]["accepted"] > 0
    assert seen.teacher["pictures_per_s"] > 0
    for told in seen.robot[-1:]:
        assert told["dropped"] > 0
        assert told["junk"] > 0
        assert (told["failed"], told["failures"]) == (0, 0)


@pytest.mark.deep
async def test_a_minute_of_junk_at_the_simulated_robot(tmp_path: Path) -> None:
    seen = await _simulated_robot(tmp_path, 5.0, 60.0)
    _must_have_kept_control(seen)
    assert seen.growth_kb < _MOST_GROWTH_KB
    assert seen.answered >= 0.99


async def _stops_under_flood(folder: Path, per_s: int, kid_of: Callable[[Pairing], str], stops: int) -> list[float]:
    """Seconds that each stop from a fresh socket took, infinite for one that was not answered."""
    pairing = _pairing(folder)
    took_s = []
    async with child("-m", "tests.channel.robot_process", str(folder), "sweep") as robot:
        port = int(await robot.line(str.isdigit))
        async with child("-m", "tests.channel.junk_process", str(port), str(per_s), kid_of(pairing)) as junk:
            await junk.line(lambda line: line == "flooding")
            await anyio.sleep(0.5)
            for _ in range(stops):
                async with TeacherClient(pairing.device.folder, port=port, patience_s=_STOP_WITHIN_S) as device:
                    began_s = time.monotonic()
                    try:
                        await device.stop()
                    except NoAnswerError:
                        took_s.append(float("inf"))
                    else:
                        took_s.append(time.monotonic() - began_s)
        await robot.over()
    return took_s


def _no_kid(_: Pairing) -> str:
    return ""


def _copied_kid(pairing: Pairing) -> str:
    settings = json.loads((pairing.teacher / "settings.json").read_text(encoding="utf-8"))
    return str(settings["recipient-id_hex"])


@pytest.mark.deep
@pytest.mark.parametrize("kid_of", [_no_kid, _copied_kid])
@pytest.mark.parametrize("per_s", [4_000, 10_000])
async def test_every_stop_from_a_fresh_socket_gets_through(
    tmp_path: Path, per_s: int, kid_of: Callable[[Pairing], str]
) -> None:
    took_s = await _stops_under_flood(tmp_path, per_s, kid_of, stops=16)
    assert max(took_s) < float("inf")
