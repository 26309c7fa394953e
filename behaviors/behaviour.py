"""Contract of the actions that an RLA can name."""

from typing import Protocol, runtime_checkable

from hal.robot import SensorReadings, WheelSpeeds


class Behaviour(Protocol):
    """Action that an RLA can name, such as curve_left: wheel speeds from readings (paper, section III.A.2).

    The level that chose it calls `start` in the first tick, then `step` once in each tick while it is active. It may
    have a state, but no clock and no chance: the same readings after `start` give the same speeds. If it is
    `finished` or `lost`, it stands.
    """

    @property
    def finished(self) -> bool:
        """Return whether the action is complete; it then stands, and another one takes over at once."""
        ...

    @property
    def lost(self) -> bool:
        """Return whether the action cannot continue; it then stands, and the level that chose it asks the teacher."""
        ...

    def start(self) -> None:
        """Reset the state, in the tick in which this action takes over the wheels."""
        ...

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return the wheel speeds in m/s for this tick; called once per tick while active."""
        ...


@runtime_checkable
class DrivesOn(Protocol):
    """Action with a fixed speed ahead, from its settings; doubt asks for it before the action drives."""

    @property
    def forward_m_s(self) -> float:
        """Return the set speed of the robot's centre in m/s; negative when it backs."""
        ...


@runtime_checkable
class HasSetPoints(Protocol):
    """Action that drives at the same set points in each tick, so that its way is known in advance."""

    @property
    def wheel_speeds(self) -> WheelSpeeds:
        """Return the set points in m/s."""
        ...
