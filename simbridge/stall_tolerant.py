"""Drivers that drive on by themselves after their computer stalled, for a simulator in the same program."""

from typing import Final

from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.kurt2 import Kurt2
from hal.linked_robot import LinkedRobot
from hal.robot import GuardResult, WheelSpeeds


class StallTolerant(GuardedRobot):
    """Brakes while ticks cease, as every driver does, and releases that latch with the next tick.

    Nothing can come to harm: wheels and walls are in the program that stalled. Never for a robot on a real bus, nor for
    a simulator in another program, which goes on while this one stalls.
    """

    _requested: GuardReason | None = None
    """Reason given to `emergency_stop` last; None since the last release."""

    def drive(self, wanted: WheelSpeeds, decided_at_s: float, now_s: float) -> GuardResult:
        """Ask for wheel speeds in m/s; the tick that ends a stall stands, and its latch is not kept. Times in s."""
        grant = super().drive(wanted, decided_at_s, now_s)
        if not grant.latched or grant.reasons != _STALLED or self._requested is not None:
            return grant
        super().release()
        if self._requested is not None:  # by a signal's thread, just before the release
            super().emergency_stop(self._requested)
        return grant._replace(latched=self.health.latched is not None)

    def emergency_stop(self, reason: GuardReason) -> None:
        """Brake now and stay stopped until `release`, also if a stall had latched the guard before."""
        self._requested = reason
        super().emergency_stop(reason)

    def release(self) -> None:
        """End a latched stop; the robot stands until it is driven."""
        self._requested = None
        super().release()


_STALLED: Final = (GuardReason.TICKS_CEASED,)


class StallTolerantKurt2(StallTolerant, Kurt2):
    """KURT2 whose simulation stalls with its driver."""


class StallTolerantLinkedRobot(StallTolerant, LinkedRobot):
    """Robot over a RobotLink whose simulation stalls with its driver."""
