"""Detection of a single infra-red sensor that is dead, stuck or unplugged, by its neighbours and its own noise.

A deterministic function of readings and driven ticks with a fixed amount of state. hal.infrared_watch finds a board
whose sensors all freeze.
"""

from typing import NamedTuple

from hal.odometry import WheelOdometry
from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from hal.sensor_ring import neighbours_of
from hal.sensor_signs import FLICKERS_TICKS, LOOK_TICKS, SensorFault, SensorSigns, beam_of, sensor_limits


class BrokenSensor(NamedTuple):
    """Finding of `SensorWatch`: a sensor and the sign that it is broken."""

    place: int
    """Place in the sensor table."""
    name: str
    label: str
    """Position on the robot, such as front left edge."""
    fault: SensorFault
    counts: int
    """Reading when it was noticed."""

    @property
    def title(self) -> str:
        """Position and name, such as `front left edge (s15)`."""
        return f"{self.label} ({self.name})"


class SensorWatch:
    """Detector of one dead, stuck, unplugged or dark sensor among its neighbours (fault detection).

    The tick calls `update` with fresh readings and stops the robot at a finding. It finds nothing unless more than
    half of all sensors show no sign, because a frozen board is not the fault of one sensor.
    """

    def __init__(self, robot: RobotSettings) -> None:
        infrared = robot.infrared
        self._odometry = WheelOdometry(robot.geometry)
        self._left_ticks = self._right_ticks = 0
        # No wheel turns farther between two looks: another node forged such encoder frames.
        self._farthest_m = 2 * robot.motors.maximum_speed_m_s * LOOK_TICKS * robot.cycle_s
        self._sensors = infrared.sensors
        limits = sensor_limits(robot)
        self._states = [
            SensorSigns(place, near, beam_of(infrared, place), limits)
            for place, near in enumerate(neighbours_of(infrared.sensors))
        ]
        self._ticks = self._driven = 0
        self._broken: dict[int, BrokenSensor] = {}
        self.broken: tuple[BrokenSensor, ...] = ()
        """Sensors that were noticed, in that order."""
        self.places: tuple[int, ...] = ()
        """Their places in the sensor table."""

    def update(self, readings: SensorReadings, *, driving: bool) -> tuple[BrokenSensor, ...]:
        """Process the readings of one tick and return the sensors that are newly noticed as broken.

        Call it in each tick with fresh readings. `driving`: whether the wheels were told to turn in the tick before.
        """
        self._ticks += 1
        # Wheels that turn while a bumper is pressed may not move the robot.
        if not readings.bumpers:
            self._driven += driving
            self._left_ticks += readings.encoder_left_ticks
            self._right_ticks += readings.encoder_right_ticks
        if self._ticks % LOOK_TICKS:
            return ()
        counts, driven, broken, signs = readings.infrared_counts, self._driven, self._broken, None
        motion = self._odometry.motion(self._left_ticks, self._right_ticks)
        if max(abs(motion.left_m), abs(motion.right_m)) > self._farthest_m:
            motion = self._odometry.motion(0, 0)
        self._left_ticks = self._right_ticks = 0
        for state in self._states:
            state.update(counts, driven, motion)
            if state.suspect and state.place not in broken and (fault := state.fault(driven)) is not None:
                signs = (*(signs or ()), (state.place, fault))
        return () if signs is None else self._judge(signs, counts)

    def readmit(self) -> None:
        """Trust each broken sensor again whose reading has changed since it was noticed; a teacher looked at it.

        A sensor that is still broken is noticed again.
        """
        for place in [place for place in self._broken if self._states[place].changed]:
            del self._broken[place]
            self._states[place].restart(self._driven)
        self._publish()

    def _judge(self, signs: tuple[tuple[int, SensorFault], ...], counts: tuple[int, ...]) -> tuple[BrokenSensor, ...]:
        """Return the suspects as broken, unless the whole board or a robot without noise explains their signs."""
        others = len(self._states) // 2
        flickering = sum(self._driven - state.still_from < FLICKERS_TICKS for state in self._states)
        in_range = sum(not state.out_of_range for state in self._states)
        if min(flickering, in_range) <= others or len(self._broken) + len(signs) >= others:
            return ()
        for place, fault in signs:
            sensor = self._sensors[place]
            self._broken[place] = BrokenSensor(place, sensor.name, sensor.label, fault, counts[place])
            self._states[place].note_broken()
        self._publish()
        return tuple(self._broken[place] for place, _ in signs)

    def _publish(self) -> None:
        self.broken = tuple(self._broken.values())
        self.places = tuple(self._broken)
        for state in self._states:
            state.set_witnesses(self._broken)
