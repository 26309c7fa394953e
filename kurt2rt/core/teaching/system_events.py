"""Inbox messages that are not teacher commands: pairing renewed, robot repositioned, speed changed.

So a tick has all its inputs from one place, and a recorded run can be replayed.
"""

from dataclasses import dataclass

from kurt2rt.core.teaching.commands import Command


@dataclass(frozen=True, slots=True)
class PairingRenewed:
    """New or removed keys of a teacher's device: its press ids start again."""

    teacher: str


@dataclass(frozen=True, slots=True)
class RobotRepositioned:
    """New place of the robot, which a hand set down elsewhere; its history there is empty."""


@dataclass(frozen=True, slots=True)
class SpeedChanged:
    """New speed of a simulation: robot time passes `times` as fast as real time."""

    times: int
    falls_behind: bool = False
    """True if the computer was too slow for the speed before, so that its teacher's messages came too late."""


SystemEvent = PairingRenewed | RobotRepositioned | SpeedChanged

Input = Command | SystemEvent
"""Message that a tick takes from the inbox."""
