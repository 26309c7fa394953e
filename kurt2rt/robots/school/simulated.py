"""Simulated school robot: its electronics at the far end of the same lines."""

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager

from hal.byte_port import BytePort, MemoryPort
from hal.robot_link import RobotLink
from hal.robot_settings import RobotSettings
from kurt2rt.robots.school import lines
from kurt2rt.robots.school.lines import Lines, difference
from kurt2rt.robots.school.link import SchoolLink
from simbridge.controller.controller import MOTORS_BRAKED, MotorCommands
from simbridge.links import InstantLink
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels

LINE_PERIOD_S = 0.02


class SchoolElectronics:
    """Electronics (simbridge.controller.controller.Controller) that obey valid lines, and brake if there are none."""

    crashed = False

    def __init__(self, settings: RobotSettings, port: BytePort, clock: Callable[[], float] | None = None) -> None:
        """`clock`: of the robot, in s; None: simulated time, in which no cycle is missed."""
        self._port, self.clock = port, clock
        self._cycle_s = settings.cycle_s
        self._line_cycles = round(LINE_PERIOD_S / settings.cycle_s)
        self._watchdog_cycles = round(settings.motors.controller_watchdog_s / settings.cycle_s)
        self._fastest_mm_s = round(settings.motors.maximum_speed_m_s * 1000)
        self._counts: tuple[int, ...] = (0,) * len(settings.infrared.sensors)
        self.power_cycle()

    def power_cycle(self) -> None:
        """Switch off and on: counters and numbers of lines begin with 0."""
        self._lines = Lines(self._port)
        self.commands = MOTORS_BRAKED
        self._silent_cycles = self._watchdog_cycles
        self._cycles = self._left = self._right = self.control_frames = 0
        self._command = lines.NO_COMMAND

    @property
    def watchdog_expired(self) -> bool:
        """Return whether no valid command has arrived for the watchdog's time."""
        return self._silent_cycles >= self._watchdog_cycles

    @property
    def junk_frames(self) -> int:
        """Number of lines that could not be read."""
        return self._lines.junk

    @property
    def state(self) -> tuple[int, ...]:
        """Inputs of the next cycle besides the present commands, for the state hash."""
        return self._silent_cycles, self._cycles, self._left, self._right, self._command, self._lines.junk

    def receive(self) -> None:
        """Run the first half of a cycle: obey the lines that arrived. Raises hal.bus.BusError."""
        self._silent_cycles += 1
        for message in self._lines.read():
            match message:
                case lines.HELLO, (_, _):
                    self._command = lines.NO_COMMAND
                    self._lines.write(lines.HELLO, lines.VERSION, len(self._counts))
                case lines.DRIVE, (number, left, right) if max(abs(left), abs(right)) <= self._fastest_mm_s:
                    self._obey(number, MotorCommands(left / 1000, right / 1000))
                case lines.BRAKE, (number,):
                    self._obey(number, MOTORS_BRAKED)
        if self.watchdog_expired:
            self.commands = MOTORS_BRAKED

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:  # noqa: ARG002 - all are sent
        """Apply new sensor readings, in counts."""
        self._counts = tuple(counts)

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:  # noqa: ARG002 - it has no bumpers
        """Run the second half of a cycle: add up the ticks, and send a line every 20 ms. Raises hal.bus.BusError."""
        self._left, self._right = difference(self._left, -left_ticks), difference(self._right, -right_ticks)
        self._cycles += 1
        if self._cycles % self._line_cycles == 0:
            time_s = self._cycles * self._cycle_s if self.clock is None else self.clock()
            time_ms = round(time_s * 1000) % lines.COUNTERS
            self._lines.write(lines.SENSE, time_ms, self._left, self._right, self._command, *self._counts)

    def _obey(self, number: int, commands: MotorCommands) -> None:
        self.commands, self._command, self._silent_cycles = commands, number, 0
        self.control_frames += 1


class MemoryLine(InstantLink):
    """Serial line in memory between the runtime's driver and a simulated school robot.

    It is a simbridge.simulation.PairedLink.
    """

    def __init__(self, settings: RobotSettings) -> None:
        self.port, self._robot_port = MemoryPort.pair()
        self.runtime_end: RobotLink = SchoolLink(self.port, len(settings.infrared.sensors))
        self._electronics = SchoolElectronics(settings, self._robot_port)

    def make_controller(self, body: Body, wheels: Wheels) -> SchoolElectronics:  # noqa: ARG002 - they need neither
        """Return the electronics at the robot's end."""
        return self._electronics

    def live(self) -> AbstractContextManager[None]:
        """Let the robot's clock go on while cycles are missed."""
        self._electronics.clock = time.monotonic
        return super().live()
