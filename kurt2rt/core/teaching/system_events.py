"""What happens to a robot between two ticks that no teacher's command is: it goes through the inbox, too.

So a tick has all its inputs from one place, and a recorded run can be replayed.
"""

from dataclasses import dataclass

from kurt2rt.core.teaching.commands import Command


@dataclass(frozen=True, slots=True)
class PairingRenewed:
    """A teacher's device has new keys, or none any more: presses of it are counted anew."""

    teacher: str


@dataclass(frozen=True, slots=True)
class RobotRepositioned:
    """Somebody has set the robot down elsewhere: how it came there says nothing now."""


@dataclass(frozen=True, slots=True)
class SpeedChanged:
    """Robot time passes `times` as fast as real time from now on, in a simulation."""

    times: int


SystemEvent = PairingRenewed | RobotRepositioned | SpeedChanged

Input = Command | SystemEvent
"""What a tick takes from the inbox."""
