"""Training phases of the paper."""

from enum import IntEnum


class Phase(IntEnum):
    """Training phase (paper, section IV)."""

    SUPERVISED = 1
    CORRECTIONS = 2
    REINFORCEMENT = 3
    CRITIC = 4
    AUTONOMOUS = 5


AUTONOMOUS = Phase.AUTONOMOUS
"""A name for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""
