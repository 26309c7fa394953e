"""Twists of a base with two wheels, in the steps to which it cuts them off."""

import math
from typing import NamedTuple

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings
from kurt2rt.ros.messages import Header, InvalidMessageError, Message, Twist, TwistStamped, Vector3, to_time
from kurt2rt.ros.twist_settings import TwistSettings

_ROUNDING_M_S = 1e-4


class PlaneTwist(NamedTuple):
    """Speed forward and turn to the left of a base on the floor."""

    forward_m_s: float
    turn_rad_s: float


class Twists:
    """Converter between wheel speeds and twists of one base, in the steps to which the base cuts them off."""

    def __init__(self, settings: TwistSettings, robot: RobotSettings) -> None:
        """Take the distance of the wheels and the highest speed from `robot`."""
        self._settings, self._half_track_m = settings, robot.geometry.effective_track_m / 2
        self._fastest_m_s = robot.motors.maximum_speed_m_s

    @property
    def message_class(self) -> type[Message]:
        """Class of the messages: TwistStamped or Twist, by the settings."""
        return TwistStamped if self._settings.stamped else Twist

    def of_wheels(self, speeds: WheelSpeeds) -> PlaneTwist:
        """Return the twist of finite set points in m/s, in whole steps; no side is quicker than it was told to be."""
        settings, (left_m_s, right_m_s) = self._settings, speeds
        most_rad_s, step_m_s = settings.maximum_rad_s, settings.angular_step_rad_s * self._half_track_m
        turn_rad_s = max(-most_rad_s, min(most_rad_s, (right_m_s - left_m_s) / 2 / self._half_track_m))
        forward = _whole_steps((left_m_s + right_m_s) / 2, settings.linear_step_m_s)
        turn = _whole_steps(turn_rad_s, settings.angular_step_rad_s)
        # A turn that is cut off makes the inner side quicker, so the robot may have to drive a step slower.
        tries = [(_reduced(forward, less), _reduced(turn, fewer)) for less, fewer in ((0, 0), (1, 0), (0, 1), (1, 1))]
        # Of sides that turn against each other, a speed that is cut off makes one quicker, by many steps of the turn.
        ahead_m_s, behind_m_s = map(abs, speeds if turn_rad_s < 0 else speeds[::-1])
        for steps in (forward, forward - 1, forward + 1):
            forward_m_s = steps * settings.linear_step_m_s
            most = _whole_steps(min(ahead_m_s - forward_m_s, behind_m_s + forward_m_s), step_m_s)
            most = min(most, abs(turn) + 1)
            tries.append((steps, -most if turn_rad_s < 0 else most))
        for steps, turn in tries:
            twist = PlaneTwist(steps * settings.linear_step_m_s, turn * settings.angular_step_rad_s)
            sides = zip(self.to_wheels(twist), speeds, strict=True)
            if all(abs(slowed) <= abs(told) + _ROUNDING_M_S for slowed, told in sides):
                return twist
        return PlaneTwist(0.0, 0.0)

    def to_wheels(self, twist: PlaneTwist) -> WheelSpeeds:
        """Return the wheel speeds of a twist in m/s."""
        half_m_s = twist.turn_rad_s * self._half_track_m
        return WheelSpeeds(twist.forward_m_s - half_m_s, twist.forward_m_s + half_m_s)

    def message(self, twist: PlaneTwist, stamp_s: float) -> Message:
        """Return the message of a twist; a stamped one is of `stamp_s`, in s."""
        message = Twist(Vector3(twist.forward_m_s, 0.0, 0.0), Vector3(0.0, 0.0, twist.turn_rad_s))
        return TwistStamped(Header(to_time(stamp_s), "base_link"), message) if self._settings.stamped else message

    def obeyed(self, message: Message) -> PlaneTwist:
        """Return the twist that a base executes for a message: within its limits.

        Raises kurt2rt.ros.messages.InvalidMessageError if it is not a number.
        """
        twist = message.twist if isinstance(message, TwistStamped) else message
        assert isinstance(twist, Twist)
        forward_m_s, turn_rad_s = twist.linear.x, twist.angular.z
        if not (math.isfinite(forward_m_s) and math.isfinite(turn_rad_s)):
            raise InvalidMessageError("Twist: not a number")
        most_m_s, most_rad_s = self._fastest_m_s, self._settings.maximum_rad_s
        return PlaneTwist(
            max(-most_m_s, min(most_m_s, forward_m_s)),
            max(-most_rad_s, min(most_rad_s, turn_rad_s)),
        )


def _whole_steps(value: float, step: float) -> int:
    """Return a value towards 0 in whole steps; one that is short of a step by rounding alone counts as a step."""
    return math.trunc(value / step + math.copysign(0.001, value))


def _reduced(steps: int, by: int) -> int:
    return steps - by if steps > 0 else min(0, steps + by)
