"""Action of a plug-in, with its errors contained: the robot stands and asks."""

import math
from collections.abc import Callable, Iterable
from typing import TypeVar

from behaviors.behaviour import Behaviour
from behaviors.repertoire_settings import PluginAction
from config.plugins import PluginError
from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings

_LONGEST_ERROR = 200

ValueT = TypeVar("ValueT")


class ContainedBehaviour:
    """Action of a plug-in. After an error it is lost until the program starts again, because its state is unknown.

    Its speeds pass through the guard, as those of all actions do.
    """

    def __init__(self, action: PluginAction, robot: RobotSettings) -> None:
        """Build the action. Raises PluginError if that fails."""
        self._action = action
        self.failure = ""
        """Error of the action in one line; empty without one."""
        try:
            self._made: Behaviour = action.build(robot)
        except Exception as error:
            raise PluginError(
                f"{action.kind} cannot build it: {_described(error)}", do="mend the plug-in or its settings"
            ) from error

    @property
    def finished(self) -> bool:
        """Return whether the action is complete; False after an error."""
        return self._call(lambda: bool(self._made.finished), instead=False)

    @property
    def lost(self) -> bool:
        """Return whether the action cannot continue; True after an error."""
        return self._call(lambda: bool(self._made.lost), instead=True)

    def start(self) -> None:
        """Reset the state of the plug-in's action; an error makes it lost."""
        self._call(self._made.start, instead=None)

    def step(self, readings: SensorReadings) -> WheelSpeeds:
        """Return the wheel speeds in m/s of this tick; standstill after an error."""
        return self._call(lambda: _finite(self._made.step(readings)), instead=STANDSTILL)

    def _call(self, ask: Callable[[], ValueT], instead: ValueT) -> ValueT:
        if self.failure:
            return instead
        try:
            return ask()
        except Exception as error:  # noqa: BLE001 - a plug-in may raise anything; the robot stands and asks
            text = f"action {self._action.name} of the plug-in {self._action.kind}: {_described(error)}"
            self.failure = text[:_LONGEST_ERROR]
            return instead


def failures_of(repertoire: Iterable[Behaviour]) -> str:
    """Return the errors of a repertoire's plug-ins in a line, for the health report; empty without one."""
    return "; ".join(each.failure for each in repertoire if isinstance(each, ContainedBehaviour) and each.failure)


def _finite(speeds: Iterable[float]) -> WheelSpeeds:
    left_m_s, right_m_s = speeds
    if not (math.isfinite(left_m_s) and math.isfinite(right_m_s)):
        raise ValueError(f"its speeds are {left_m_s} and {right_m_s} m/s, allowed are finite ones")
    return WheelSpeeds(float(left_m_s), float(right_m_s))


def _described(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())
