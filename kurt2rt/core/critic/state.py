"""What the critic does just now."""

from enum import StrEnum


class CriticState(StrEnum):
    """What becomes of the critic's opinions."""

    LISTENS = "listens"
    """Nothing: before phase 5, and in it while the critic is not trusted."""
    MEASURES = "measures"
    """They score how well the robot does; nothing is changed meanwhile."""
    NOT_NEEDED = "not needed"
    """They are counted; too little of the driven time was bad so far."""
    ACTS = "acts"
    """They are signals, as a teacher's are."""
