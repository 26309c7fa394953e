"""Junk by the thousand a second: the robot's memory does not grow, and its teacher keeps control."""

import json
import os
import re
import signal
import sys
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

from kurt2rt.channel.credentials import Pairing, local_pairing
from tests.channel.robot_at_work import service_settings
from tests.channel.robot_process import resident_kb

_PATIENCE_S = 30.0
_MOST_GROWTH_KB = 20 * 1024


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
        with anyio.fail_after(_PATIENCE_S):
            while True:
                for line in self.lines:
                    if holds(line):
                        return line
                await self._read()

    async def over(self) -> list[str]:
        """Send SIGTERM; all that it printed."""
        self._process.terminate()
        with anyio.fail_after(_PATIENCE_S):
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
    """A Python process; killed at the end where it still runs."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "COLUMNS": "300"}
    async with await anyio.open_process([sys.executable, *arguments], env=environment, stderr=None) as process:
        try:
            yield Child(process)
        finally:
            if process.returncode is None:
                process.send_signal(signal.SIGKILL)


@dataclass(frozen=True, slots=True)
class Seen:
    """How robot and teacher fared."""

    resident_kb: list[int]
    """Each second, from before the flood."""
    robot: list[dict[str, Any]]
    """What a robot process of ours told each second."""
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
        async with child("-m", "tests.channel.junk_process", str(port)) as junk:
            for _ in range(round(flood_s)):
                await anyio.sleep(1.0)
                resident.append(resident_kb(str(robot.pid)))
            await junk.over()
        told = json.loads((await teacher.over())[-1])
    lines = [json.loads(line) for line in await robot.over() if line.startswith("{")]
    return Seen(resident, lines, told)


async def _cheap_robot(folder: Path, calm_s: float, flood_s: float, *, collect: str = "sweep") -> Seen:
    pairing = _pairing(folder)
    async with child("-m", "tests.channel.robot_process", str(folder), collect) as robot:
        port = int(await robot.line(str.isdigit))
        return await _taught_under_flood(robot, port, pairing.device.folder, calm_s, flood_s)


async def _simulated_robot(folder: Path, calm_s: float, flood_s: float) -> tuple[Seen, str]:
    """The robot program that everybody runs; also its last status line."""
    pairing = _pairing(folder)
    settings = folder / "flood.yaml"
    settings.write_text(yaml.safe_dump(service_settings(folder).model_dump()), encoding="utf-8")
    async with child("-m", "kurt2rt.cli.main", "run", "--settings", str(settings)) as robot:
        found = re.search(r"UDP port (\d+)", await robot.line(lambda line: "UDP port" in line))
        assert found is not None
        seen = await _taught_under_flood(robot, int(found[1]), pairing.device.folder, calm_s, flood_s)
        return seen, next(line for line in reversed(robot.lines) if "p99" in line)


def _pairing(folder: Path) -> Pairing:
    return local_pairing(folder / "teachers", folder / "devices")


def _report(name: str, seen: Seen, more: str = "") -> None:
    """Appended to the file that KURT2RT_FLOOD_REPORT names, if any."""
    path = os.environ.get("KURT2RT_FLOOD_REPORT")
    if path:
        last = seen.robot[-1] if seen.robot else more
        lines = f"{name}: grew {seen.growth_kb} kB, each 10 s {seen.resident_kb[::10]}; {seen.teacher}; robot {last}\n"
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(lines)


def _must_have_kept_control(seen: Seen) -> None:
    assert seen.teacher["told"]["accepted"] > 0
    assert seen.teacher["pictures_per_s"] > 0
    for told in seen.robot[-1:]:
        assert told["dropped"] > 0
        assert told["junk"] > 0
        assert (told["failed"], told["failures"]) == (0, 0)


@pytest.mark.deep
async def test_a_teacher_is_answered_while_junk_pours_in(tmp_path: Path) -> None:
    seen = await _cheap_robot(tmp_path, 0.0, 3.0)
    _report("short", seen)
    _must_have_kept_control(seen)


@pytest.mark.deep
async def test_a_minute_of_junk_takes_neither_memory_nor_control(tmp_path: Path) -> None:
    seen = await _cheap_robot(tmp_path, 5.0, 60.0)
    _report("a minute", seen)
    _must_have_kept_control(seen)
    assert seen.growth_kb < _MOST_GROWTH_KB
    assert seen.answered >= 0.99


@pytest.mark.deep
async def test_a_minute_of_junk_at_the_simulated_robot(tmp_path: Path) -> None:
    seen, status = await _simulated_robot(tmp_path, 5.0, 60.0)
    _report("simulated", seen, status)
    _must_have_kept_control(seen)
    assert seen.growth_kb < _MOST_GROWTH_KB
    assert seen.answered >= 0.99
