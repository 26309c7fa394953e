"""Rules that the tick and the compiled loops of a batch share, as plain functions."""

SURE_SHARE = 0.95
"""Fraction of R within which a situation is inside with a margin."""
OPEN_TICKS = 100
"""Ticks for which a question stays open after its robot asked, if the robot moves: 1 s."""
_SURE_STEP = 2
"""Ticks that one tick inside with a margin counts for: a question ends after 0.5 s of them."""


def question_ticks(left: int, asks: bool, sure: bool, moves: bool) -> int:
    """Return for how many ticks a question stays open after one more tick; 0: none is open.

    At the border of R the noise of the sensors ends a question for moments, and asks it again. That is one question.

    A question begins in a tick that asks while `left` is 0.

    Args:
        left: result of the tick before.
        asks: whether the robot asks in this tick.
        sure: whether its situation is inside R with a margin.
        moves: whether a wheel turns.
    """
    if asks:
        return OPEN_TICKS
    if sure:
        return max(0, left - _SURE_STEP)
    if moves:
        return max(0, left - 1)
    return OPEN_TICKS if left > 0 else 0


def advance_way(way: float, share: float) -> tuple[float, bool]:
    """Return the way after one slow tick of a lesson, and whether the tick counts on the clock of the way.

    Args:
        way: fraction of a counted tick that was driven since the last one, 0 to 1.
        share: fraction of the speed at which the robot drives, 0 to 1.
    """
    way += share
    counts = way >= 1.0
    return way - 1.0 if counts else way, counts
