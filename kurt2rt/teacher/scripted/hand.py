"""Hand of a scripted person: it follows a changing right action with a delay."""


class Hand:
    """Hand that presses for an action, and moves to the right action with a delay."""

    def __init__(self, delay_ticks: int, press_id: int, action: str, *, begins: int, ends: int) -> None:
        """Begin a press.

        Args:
            delay_ticks: time from a change of the right action to that of the hand.
            press_id: of the press.
            action: first action.
            begins: tick from which the hand follows.
            ends: tick of the release.
        """
        self.press_id = press_id
        self.action = action
        self.ends = ends
        """Tick of the release."""
        self._delay_ticks = delay_ticks
        self._target = action
        self._moves_from = begins
        self._arrives: int | None = None

    def stay(self, until: int) -> None:
        """Keep the present action until a tick, right or wrong."""
        self._moves_from = until

    def follow(self, now: int, right: str) -> None:
        """Begin to move to the right action, if no move is under way."""
        if self._arrives is None and right != self.action and now >= self._moves_from:
            self._target, self._arrives = right, now + self._delay_ticks

    def move(self, now: int) -> None:
        """Change to the target action once the hand's delay has passed."""
        if self._arrives is not None and now >= self._arrives:
            self.action, self._arrives = self._target, None
