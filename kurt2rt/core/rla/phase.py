"""Training phases of the paper."""

from enum import IntEnum


class Phase(IntEnum):
    """Training phase (paper, section IV)."""

    SUPERVISED = 1
    CORRECTIONS = 2
    REINFORCEMENT = 3
    CRITIC = 4
    AUTONOMOUS = 5
