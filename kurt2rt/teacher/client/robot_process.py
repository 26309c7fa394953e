"""A simulated robot in a process of its own, for scripts and notebooks that need one for a while."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Self

from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.protocol.udp_socket import open_udp_socket
from kurt2rt.teacher.client.teacher import LOCAL_DEVICE

PROGRAM = "kurt2rt.cli.with_parent"
"""Module that runs the command line and ends with this process."""
_START_S = 30.0
_END_S = 10.0
_LOOK_S = 0.02
_LOG = "robot.log"
_KNOWLEDGE = "robot.knowledge"


class RobotProcess:
    """Process of `kurt2rt run` in the background, on a free UDP port, with keys and knowledge of its own.

    with RobotProcess() as robot, Teacher(robot.device) as teacher:
        ...

    Use it as a context manager, or call `start` and `end`. The process also ends when the program that started it is
    gone, whatever ended that one.
    """

    def __init__(
        self, folder: Path | str | None = None, *, task: str = "wall_following", world: str | None = None, seed: int = 1
    ) -> None:
        """Choose the robot; nothing runs before `start`.

        Args:
            folder: Folder for keys, knowledge and log; created if absent. None: a temporary one that `end` deletes.
            task: Task by name (config/tasks) or a path to its YAML file.
            world: World by name or path. None: the one of the task.
            seed: Start pose and noise of the robot.
        """
        self._wanted = None if folder is None else Path(folder).resolve()
        self._task = str(Path(task).resolve()) if Path(task).is_file() else task
        self._world = world
        self._seed = seed
        self._folder: Path | None = None
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def device(self) -> Path:
        """Pairing for a `Teacher` or `TeacherClient`, which holds the port of the robot as well."""
        return self._open_folder / LOCAL_DEVICE

    @property
    def knowledge(self) -> Path:
        """Knowledge file of the robot."""
        return self._open_folder / _KNOWLEDGE

    @property
    def log(self) -> Path:
        """Text file of all that the robot's program printed."""
        return self._open_folder / _LOG

    def start(self) -> Self:
        """Start the process and wait until it can be connected to.

        Raises:
            ChannelError: The process ended or made no pairing within 30 s.
            RuntimeError: It was started already.
        """
        if self._process is not None:
            raise RuntimeError("this RobotProcess runs already; end it first")
        self._folder = self._wanted or Path(tempfile.mkdtemp(prefix="kurt2rt-"))
        self._folder.mkdir(parents=True, exist_ok=True)
        world = () if self._world is None else ("--world", self._world)
        self._process = _started(
            (
                *("run", "--task", self._task, *world, "--seed", str(self._seed), "--no-record"),
                *("--knowledge", str(self.knowledge), "--port", str(_free_udp_port())),
            ),
            self._folder,
            self.log,
            {**os.environ, "COLUMNS": "10000"},  # so that the last line is a whole message
        )
        try:
            self._wait_for_pairing(self._process)
        except BaseException:
            self.end()
            raise
        return self

    def end(self) -> None:
        """End the process, and delete its folder if it was a temporary one. Ending twice does nothing."""
        process, self._process = self._process, None
        if process is not None:
            assert process.stdin is not None
            process.stdin.close()
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(_END_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        folder, self._folder = self._folder, None
        if folder is not None and self._wanted is None:
            shutil.rmtree(folder)

    def __enter__(self) -> Self:
        """Start the process, as `start` does."""
        return self.start()

    def __exit__(self, *_: object) -> None:
        """End the process, as `end` does."""
        self.end()

    @property
    def _open_folder(self) -> Path:
        if self._folder is None:
            raise RuntimeError("this RobotProcess does not run; use it as: with RobotProcess() as robot: ...")
        return self._folder

    def _wait_for_pairing(self, process: "subprocess.Popen[bytes]") -> None:
        ends_s = time.monotonic() + _START_S
        # The robot's side is made last, so both are there.
        robots_side = self._open_folder / "var" / "teachers" / LOCAL_DEVICE.name
        while not robots_side.is_dir():
            if process.poll() is not None:
                raise ChannelError(f"the simulated robot ended with code {process.returncode}: {self._last_line()}")
            if time.monotonic() >= ends_s:
                raise ChannelError(f"the simulated robot is not ready after {_START_S:g} s: {self._last_line()}")
            time.sleep(_LOOK_S)

    def _last_line(self) -> str:
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        return next((line.strip() for line in reversed(lines) if line.strip()), "it printed nothing")


def _free_udp_port() -> int:
    with open_udp_socket() as probe:
        port: int = probe.getsockname()[1]
        return port


def _started(words: Sequence[str], folder: Path, log: Path, environment: dict[str, str]) -> "subprocess.Popen[bytes]":
    with log.open("wb") as output:
        # In a session of its own: Ctrl-C and Jupyter's Interrupt end a call in the notebook, and not the robot.
        return subprocess.Popen(
            [sys.executable, "-m", PROGRAM, *words],
            stdin=subprocess.PIPE,
            stdout=output,
            stderr=subprocess.STDOUT,
            cwd=folder,
            env=environment,
            start_new_session=True,
        )
