"""Length of a question, as a plain function that runs in the tick and in compiled loops.

At the border of R the noise of the sensors ends a question for moments, and asks it again. That is one question.
"""

SURE_SHARE = 0.95
"""Fraction of R within which a situation is inside with a margin."""
OPEN_TICKS = 100
"""Ticks for which a question stays open after its robot asked, if the robot moves: 1 s."""
_SURE_STEP = 2
"""Ticks that one tick inside with a margin counts for: a question ends after 0.5 s of them."""


def question_ticks(left: int, asks: bool, sure: bool, moves: bool) -> int:
    """Return for how many ticks a question stays open after one more tick; 0: none is open.

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
