"""Base of the observers of fault drill and soak: the tick's robot, and the envelope of all that its driver sends."""

from hal.robot import Robot, SensorReadings
from hal.robot_proxy import RobotProxy
from kurt2rt.checks.faults.envelope import Envelope
from kurt2rt.checks.faults.fault_rig import BusRig


class BusObserver(RobotProxy):
    """Robot of the tick (RobotProxy) whose sent frames are checked by an envelope."""

    def __init__(self, rig: BusRig, envelope: Envelope) -> None:
        """Observe on the rig's time; `attach` a robot before the first tick."""
        self.envelope = envelope
        self._rig = rig
        self._time = rig.time
        self._sensed_at_s = 0.0
        rig.on_sent = self._on_sent

    def attach(self, robot: Robot) -> None:
        """Observe `robot`, a new driver, in place of the one before."""
        self._robot = robot

    def sense(self, now_s: float) -> SensorReadings:
        """Return the driver's readings at `now_s`, in s; the age of the next decision counts from this call."""
        self._sensed_at_s = self._time.now_s()
        return super().sense(now_s)

    def close(self) -> None:
        """Do nothing: the rig closes the robot."""

    def _on_sent(self, number: int, payload: bytes) -> None:
        now_s, robot = self._time.now_s(), self._rig.robot
        latched = robot is not None and robot.health.latched is not None
        self.envelope.on_sent(number, now_s, payload, now_s - self._sensed_at_s, latched=latched)
