"""Simulated school robots: on a line in memory in simulated time, and on a pseudo-terminal in real time."""

import time
from pathlib import Path
from typing import Self

from hal.linked_robot import LinkedRobot
from hal.robot import GuardResult, WheelSpeeds
from hal.robot_settings import RobotSettings, load_robot
from kurt2rt.robots.school.simulated import MemoryLine, SchoolElectronics
from simbridge.links import PtyPort
from simbridge.realtime import RealtimeSimulation
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_loading import load_world

SETTINGS: RobotSettings = load_robot("school")
FORWARD = WheelSpeeds(0.08, 0.08)


class MemoryRig:
    """Robot and driver, one tick of the runtime after each cycle of the robot."""

    def __init__(self) -> None:
        self.line = MemoryLine(SETTINGS)
        self.simulated = SimulatedRobot(SETTINGS, load_world("school/a", SETTINGS), self.line.make_controller, 1)
        self.now_s = 100.0
        self.robot = LinkedRobot(SETTINGS, self.line.runtime_end, lambda: self.now_s)

    def tick(self, wanted: WheelSpeeds = FORWARD) -> GuardResult:
        self.now_s += SETTINGS.cycle_s
        self.simulated.step()
        self.robot.sense(self.now_s)
        return self.robot.drive(wanted, self.now_s, self.now_s)

    def run(self, seconds: float, wanted: WheelSpeeds = FORWARD) -> GuardResult:
        for _ in range(round(seconds / SETTINGS.cycle_s)):
            result = self.tick(wanted)
        return result


class PtyRobot:
    """Robot that lives in real time behind a pseudo-terminal, as a real one behind its serial port."""

    def __init__(self, device: Path | str = "") -> None:
        self.port = PtyPort(str(device))
        self.simulated = SimulatedRobot(
            SETTINGS,
            load_world("school/a", SETTINGS),
            lambda *_: SchoolElectronics(SETTINGS, self.port, time.monotonic),
            1,
        )
        self.thread = RealtimeSimulation(self.simulated, SETTINGS.cycle_s)

    def __enter__(self) -> Self:
        self.thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def unplug(self) -> None:
        """Switch the robot off, and close its end."""
        self.thread.stop()
        self.port.close()
