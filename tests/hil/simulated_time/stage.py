"""Puts a story on inside the machine: `python -m tests.hil.simulated_time.stage FOLDER STORY`.

STORY is JSON: `seconds`, `phase_s`, and what happens, each at its second of the story; see Story. The folder gets
candump.log, what the programs told, and `moments.json`: when things were done, on the clock of candump's stamps.
"""

import json
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO

BUS = "vcan0"
_STARTING_S = 0.5
"""Starting a program takes no time here; this is for it to be seen in the log."""


@dataclass(frozen=True)
class Story:
    """Events of a story; seconds count from the start of the robot."""

    seconds: float
    by_command: bool = False
    """The robot is `kurt2rt sim`, as anybody would start it; it tells its state in words."""
    phase_s: float = 0.0
    """The runtime's ticks lie so much later in the robot's cycle."""
    infrared_silent_s: float | None = None
    tick_hangs: int | None = None
    """Number of the decision that hangs."""
    wall_clock_set_s: float | None = None
    wall_clock_by_s: float = 0.0
    """Forward, or back where negative."""
    runtime_killed_s: float | None = None
    runtime_stopped_s: float | None = None
    """Time of a SIGSTOP for one second."""
    robot_stopped_s: float | None = None
    """Time of a SIGSTOP without an end."""


class Stage:
    """The programs of a story, and what was done to them."""

    def __init__(self, folder: Path, files: ExitStack) -> None:
        self._folder = folder
        self._files = files
        self.moments_s: dict[str, float] = {}

    def start(self, *words: str, told: str) -> "subprocess.Popen[bytes]":
        out: IO[bytes] = self._files.enter_context((self._folder / told).open("wb"))
        return subprocess.Popen(words, stdout=out, stdin=subprocess.DEVNULL)

    def program(self, name: str, *arguments: object) -> "subprocess.Popen[bytes]":
        words = (sys.executable, "-m", f"tests.hil.simulated_time.{name}", BUS, *map(str, arguments))
        return self.start(*words, told=f"{name}.json")

    def signal_at(self, second_s: float, process: "subprocess.Popen[bytes]", number: signal.Signals, what: str) -> None:
        sleep_until(second_s)
        self.moments_s[what] = time.time()
        process.send_signal(number)


def sleep_until(at_s: float) -> None:
    """Sleep until a time of the monotonic clock."""
    time.sleep(max(0.0, at_s - time.monotonic()))


def _robot(stage: Stage, story: Story) -> "subprocess.Popen[bytes]":
    if story.by_command:
        kurt2rt = str(Path(sys.executable).with_name("kurt2rt"))
        return stage.start(kurt2rt, "sim", "--bus", BUS, "--seconds", str(story.seconds), told="robot.txt")
    silent = () if story.infrared_silent_s is None else (story.infrared_silent_s,)
    return stage.program("robot", story.seconds, *silent)


def put_on(stage: Stage, story: Story) -> None:
    """All of it, to its end."""
    log = stage.start("candump", "-L", "-r", "8000000", BUS, told="candump.log")
    time.sleep(_STARTING_S)
    began_s = time.monotonic()
    robot = _robot(stage, story)
    sleep_until(began_s + _STARTING_S + story.phase_s)
    hangs = () if story.tick_hangs is None else (story.tick_hangs,)
    runtime = stage.program("runtime", story.seconds - 2 * _STARTING_S, *hangs)
    if story.wall_clock_set_s is not None:
        sleep_until(began_s + story.wall_clock_set_s)
        time.clock_settime(time.CLOCK_REALTIME, time.time() + story.wall_clock_by_s)
    if story.runtime_stopped_s is not None:
        stage.signal_at(began_s + story.runtime_stopped_s, runtime, signal.SIGSTOP, "runtime stopped")
        if story.robot_stopped_s is not None:
            stage.signal_at(began_s + story.robot_stopped_s, robot, signal.SIGSTOP, "robot stopped")
        stage.signal_at(began_s + story.runtime_stopped_s + 1.0, runtime, signal.SIGCONT, "runtime goes on")
    if story.runtime_killed_s is not None:
        stage.signal_at(began_s + story.runtime_killed_s, runtime, signal.SIGKILL, "runtime killed")
    runtime.wait()
    if story.robot_stopped_s is not None:
        robot.kill()
    robot.wait()
    time.sleep(_STARTING_S)
    log.terminate()
    log.wait()


def main() -> None:
    folder, story = Path(sys.argv[1]), Story(**json.loads(sys.argv[2]))
    with ExitStack() as files:
        stage = Stage(folder, files)
        put_on(stage, story)
    (folder / "moments.json").write_text(json.dumps(stage.moments_s), encoding="utf-8")


def order(folder: Path, story: Story) -> list[str]:
    """Return the command that runs a story."""
    return [sys.executable, "-m", "tests.hil.simulated_time.stage", str(folder), json.dumps(asdict(story))]


if __name__ == "__main__":
    main()
