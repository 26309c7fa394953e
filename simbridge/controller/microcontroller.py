"""Micro-controllers of the robot as a CAN node: CONTROL in, motor commands, telemetry out, every 10 ms."""

from collections.abc import Sequence

from hal.bus import CONTROL_ID
from hal.codec import InvalidFrameError, load_codec
from hal.control import Mode, RawControl, SystemControl, decode_control
from hal.kurt2_settings import Kurt2Settings
from simbridge.controller.controller import MOTORS_BRAKED, MOTORS_OFF, MotorCommands
from simbridge.controller.telemetry import ControllerBus, Telemetry
from simbridge.robot.instruments import Instruments

CRASH_STEP_M_S = 0.45
"""A set point that grows by more in one cycle crashes the controller. The real one crashed from zero to full speed
(docs/the-robot.md#yaw-and-keep); half of the full 0.9 m/s is our choice."""


class MicroController:
    """Both controllers of the robot; the newest CONTROL of a cycle wins, invalid ones are only counted.

    Without a valid CONTROL for the watchdog's time the motors are off and braked. A set point that jumps up crashes the
    controller: motors off and no telemetry until MC_RESET. A side is ramped down before it reverses.
    """

    def __init__(self, robot: Kurt2Settings, bus: ControllerBus, instruments: Instruments) -> None:
        self._bus = bus
        self._motors = robot.motors
        self._instruments = instruments
        self._telemetry = Telemetry(robot, load_codec(robot.can.database), bus.telemetry_port(), instruments)
        self._watchdog_cycles = round(robot.motors.controller_watchdog_s / robot.cycle_s)
        self._silent_cycles = self._watchdog_cycles
        self._actuators_on = True
        self._last_payload: bytes | bytearray | None = None
        self._last_system_command: SystemControl | None = None
        self._last_commands = MOTORS_BRAKED
        self.commands = MOTORS_BRAKED
        self.crashed = False
        """Whether the controller crashed and waits for MC_RESET."""
        self.control_frames = 0
        """Valid CONTROL frames since power-on."""
        self.junk_frames = 0
        """Invalid CONTROL frames since power-on."""

    def receive(self) -> None:
        """Run the first half of a cycle: read the bus, command the motors. Raises hal.bus.BusError."""
        self._silent_cycles += 1
        newest: MotorCommands | None = None
        for message in self._bus.drain():
            if message.arbitration_id != CONTROL_ID or message.is_extended_id:
                continue
            if message.is_remote_frame or message.is_error_frame:
                self.junk_frames += 1
                continue
            if message.data != self._last_payload:
                try:
                    self._decode(message.data)
                except InvalidFrameError:
                    self.junk_frames += 1
                    continue
            self.control_frames += 1
            self._silent_cycles = 0
            newest = (
                self._execute(self._last_system_command, newest) if self._last_system_command else self._last_commands
            )
        if self.crashed:
            return
        if newest is not None and self._actuators_on:
            if newest is not self.commands:
                self._apply(newest)
        elif self.watchdog_expired:
            self.commands = MOTORS_BRAKED

    def power_cycle(self) -> None:
        """Switch off and on: clears a crash, and brakes until the next CONTROL."""
        self.crashed = False
        self._actuators_on = True
        self.commands = MOTORS_BRAKED
        self._silent_cycles = self._watchdog_cycles

    @property
    def watchdog_expired(self) -> bool:
        """Return whether no valid CONTROL has arrived for the watchdog's time."""
        return self._silent_cycles >= self._watchdog_cycles

    @property
    def state(self) -> tuple[int, ...]:
        """Inputs of the next cycle besides the present commands, for the state hash."""
        return self._silent_cycles, self._actuators_on, self.crashed, self.junk_frames

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:
        """Apply new sensor readings.

        `fresh`: indexes of sensors with new readings. `counts`: readings of all sensors, in counts.
        """
        self._telemetry.update_readings(fresh, counts)

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:
        """Run the second half of a cycle: send telemetry.

        `left_ticks`, `right_ticks`: encoder ticks of this cycle, forward positive. `bumpers`: bit n is set if bumper n
        touches. Raises hal.bus.BusError.
        """
        self._instruments.count(left_ticks, right_ticks)
        if not self.crashed:
            self._telemetry.send(left_ticks, right_ticks, bumpers)

    def _decode(self, data: bytes | bytearray) -> None:
        """Decode a payload and cache the result, because most cycles repeat the last one."""
        control = decode_control(data)
        self._last_payload = bytes(data)
        self._last_system_command = control if isinstance(control, SystemControl) else None
        if not isinstance(control, SystemControl):
            left_m_s, right_m_s = control.wheel_speeds(self._motors)
            brakes = (control.left.brake, control.right.brake) if isinstance(control, RawControl) else (False, False)
            self._last_commands = MotorCommands(left_m_s, right_m_s, *brakes)

    def _apply(self, wanted: MotorCommands) -> None:
        old = self.commands
        if (
            _speed_up_m_s(old.left_m_s, wanted.left_m_s) > CRASH_STEP_M_S
            or _speed_up_m_s(old.right_m_s, wanted.right_m_s) > CRASH_STEP_M_S
        ):
            self.crashed = True
            self.commands = MOTORS_OFF
            return
        self.commands = wanted

    def _execute(self, command: SystemControl, newest: MotorCommands | None) -> MotorCommands | None:
        """Execute a system command and return the motor commands that remain valid after it."""
        if command.mode is Mode.MC_RESET:
            self.crashed = False
            self._actuators_on = True
            self.commands = MOTORS_OFF
            self._instruments.reset()
            return None
        if self.crashed:
            return newest
        if command.mode is Mode.ACTUATOR_ON:
            self._actuators_on = True
        elif command.mode is Mode.ACTUATOR_OFF:
            self._actuators_on = False
            self.commands = MOTORS_OFF
            return None
        elif command.mode is Mode.CALIBRATE_GYRO:
            self._instruments.calibrate_gyro()
        elif command.mode is Mode.RESET_GYRO:
            self._instruments.zero_gyro()
        elif command.mode is Mode.UPDATE_ANGLE:
            self._instruments.set_angle(command.angle_urad / 1e6)
        # RESET_SSC concerns a servo controller that this robot does not carry.
        return newest


def _speed_up_m_s(old_m_s: float, new_m_s: float) -> float:
    """Return the increase of speed; a reversal starts from 0."""
    return abs(new_m_s) - (abs(old_m_s) if old_m_s * new_m_s > 0 else 0.0)
