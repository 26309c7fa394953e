"""State of the critic in one tick."""

from enum import StrEnum


class CriticState(StrEnum):
    """Use of the critic's opinions."""

    LISTENS = "listens"
    """None: before phase 5, or while the critic is not trusted."""
    MEASURES = "measures"
    """They score the knowledge, which does not change meanwhile."""
    NOT_NEEDED = "not needed"
    """They are counted; too little of the driven time was bad."""
    ACTS = "acts"
    """They are signals, like a teacher's rewards."""
