"""Twists of a base with two wheels, in the steps to which it cuts them off."""

import math
from typing import NamedTuple

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings
from kurt2rt.ros.messages import Header, InvalidMessageError, Message, Twist, TwistStamped, Vector3, to_time
from kurt2rt.ros.twist_settings import TwistSettings

_FEWER_STEPS = 2
"""Steps by which the robot may drive slower or faster than the sides' mean, where only so both sides fit."""
_ROUNDING = 0.001
"""Share of a step by which a speed is short of it by rounding alone."""


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
        self._turn_step_m_s = settings.angular_step_rad_s * self._half_track_m
        self._most_turn = math.floor(settings.maximum_rad_s / settings.angular_step_rad_s + _ROUNDING)

    @property
    def message_class(self) -> type[Message]:
        """Class of the messages: TwistStamped or Twist, by the settings."""
        return TwistStamped if self._settings.stamped else Twist

    def of_wheels(self, speeds: WheelSpeeds) -> PlaneTwist:
        """Return the nearest twist to finite set points in m/s, in whole steps; no side is quicker than it was told.

        A side may turn round by less than one step of the turn, because few twists let it rest.
        """
        settings, turn_step_m_s = self._settings, self._turn_step_m_s
        (left_low, left_high), (right_low, right_high) = (_allowed_m_s(each, turn_step_m_s) for each in speeds)
        wanted_turn = round((speeds.right_m_s - speeds.left_m_s) / 2 / turn_step_m_s)
        wanted_forward = round((speeds.left_m_s + speeds.right_m_s) / 2 / settings.linear_step_m_s)
        nearest, least_m_s = PlaneTwist(0.0, 0.0), math.inf
        for forward in range(wanted_forward - _FEWER_STEPS, wanted_forward + _FEWER_STEPS + 1):
            forward_m_s = forward * settings.linear_step_m_s
            low_m_s = max(forward_m_s - left_high, right_low - forward_m_s)
            high_m_s = min(forward_m_s - left_low, right_high - forward_m_s)
            low = max(math.ceil(low_m_s / turn_step_m_s - _ROUNDING), -self._most_turn)
            high = min(math.floor(high_m_s / turn_step_m_s + _ROUNDING), self._most_turn)
            if low > high:
                continue
            turn = max(low, min(high, wanted_turn))
            twist = PlaneTwist(forward_m_s, turn * settings.angular_step_rad_s)
            got = self.to_wheels(twist)
            off_m_s = abs(got.left_m_s - speeds.left_m_s) + abs(got.right_m_s - speeds.right_m_s)
            if off_m_s < least_m_s:
                nearest, least_m_s = twist, off_m_s
        return nearest

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


def _allowed_m_s(told_m_s: float, step_m_s: float) -> tuple[float, float]:
    """Return the lowest and the highest speed of a side that was told to turn so fast, in m/s."""
    back_m_s = min(abs(told_m_s), step_m_s)
    return (-back_m_s, told_m_s) if told_m_s >= 0.0 else (told_m_s, back_m_s)
