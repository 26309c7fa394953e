"""Lesson speed: the fraction of their speed at which actions drive while a teacher teaches them (slow lessons)."""

from hal.robot import WheelSpeeds
from simbridge.contracts.shared_rules import advance_way

SLOWEST = 0.2
"""Least lesson speed: at less, set points of whole cm/s would change the curves of the actions by a third."""


class LessonSpeed:
    """Fraction of their speed at which actions drive in a lesson, and the clock of their way.

    Both wheels are slowed by the same fraction, so that the robot drives the same way in more ticks. Times that stand
    for a way, such as those of the averages and of the least time of an action, count on the clock of the way, which
    is slower by the same fraction. So the same knowledge fits at full speed.
    """

    def __init__(self, share: float = 1.0) -> None:
        """`share`: fraction of the speed, SLOWEST to 1."""
        self.share = share
        """Fraction that was set; it can be set again."""
        self.slows = False
        """Whether the wheels were slowed in the newest tick."""
        self.counts = True
        """Whether the newest tick counts on the clock of the way."""
        self._way = 0.0

    def slow(self, wheel_speeds: WheelSpeeds) -> WheelSpeeds:
        """Return slowed wheel speeds, in m/s, and advance the clock of the way; call it once in each slow tick."""
        share = self.share
        self._way, self.counts = advance_way(self._way, share)
        self.slows = True
        return WheelSpeeds(share * wheel_speeds.left_m_s, share * wheel_speeds.right_m_s)

    def end(self) -> None:
        """Note a tick that is not slowed: the wheels are at full speed or stand, and the tick counts."""
        self.slows, self.counts = False, True
