"""A robot program with its channel, a child of test_flood.py: serves until SIGTERM, tells its port, then each second.

Arguments: folder of its files, and how to collect what the network library leaves behind: "sweep" as the service does,
or "never".
"""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import anyio
import pytest

from hal.robot import Robot
from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.task_settings import load_task
from kurt2rt.platform.gc_control import collect_young
from kurt2rt.service.assembly import RunSettings
from kurt2rt.service.post_tick import ProgramConsole, ProgramStatus
from kurt2rt.service.serve import ChannelOptions, ServeOptions, serve
from tests.channel.robot_at_work import SETTINGS, CheapRobot, service_settings


def resident_kb(process: str = "self") -> int:
    """Memory of a process, by its id."""
    status = Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    return int(status.split("VmRSS:")[1].split()[0])


class _Sweeper:
    """Times the service's own sweeps, or leaves them out."""

    def __init__(self, collect: Callable[[], None]) -> None:
        self._collect = collect
        self.longest_ms = 0.0

    def __call__(self) -> None:
        began_s = time.perf_counter()
        self._collect()
        self.longest_ms = max(self.longest_ms, 1000 * (time.perf_counter() - began_s))


async def work(folder: Path, sweeper: _Sweeper) -> None:
    channels: list[Channel] = []

    def listening(channel: Channel) -> None:
        channels.append(channel)
        print(channel.endpoint.port, flush=True)

    def tell(status: ProgramStatus) -> None:
        (channel,) = channels
        counters, timer = channel.endpoint.counters, status.runtime.timer
        line = {
            "resident_kb": resident_kb(),
            "ticks": timer.ticks,
            "missed": timer.missed_ticks,
            "late_p99_us": timer.lateness().p99_us,
            "received": counters.received,
            "dropped": counters.dropped_by_bucket,
            "junk": counters.junk,
            "failed": counters.failed,
            "failures": channel.failures,
            "sweep_ms": sweeper.longest_ms,
        }
        print(json.dumps(line), flush=True)

    robot: Robot = CheapRobot()
    quiet = ProgramConsole(status=tell, question=lambda _: None, acknowledged=lambda _: None)
    settings = RunSettings(SETTINGS, load_task("wall_following"), service_settings(folder))
    await serve(robot, settings, quiet, ServeOptions(channel=ChannelOptions(on_open=listening)))


if __name__ == "__main__":
    with pytest.MonkeyPatch.context() as patch:
        sweeper = _Sweeper(collect_young if sys.argv[2] == "sweep" else lambda: None)
        patch.setattr("kurt2rt.service.post_tick.collect_young", sweeper)
        anyio.run(work, Path(sys.argv[1]), sweeper)
