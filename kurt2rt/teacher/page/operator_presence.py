"""Whether the one at the page looks at the robot."""


class OperatorPresence:
    """Lasts from heartbeat to heartbeat of a visible page with a fresh picture. Times are seconds, and only grow."""

    def __init__(self, lease_s: float = 0.3, oldest_picture_s: float = 0.5) -> None:
        """A heartbeat is good for `lease_s`, and never longer than `oldest_picture_s` after its picture was sent."""
        self._lease_s = lease_s
        self._oldest_picture_s = oldest_picture_s
        self._until_s = float("-inf")

    def beat(self, picture_age_s: float, now_s: float) -> None:
        """A heartbeat came."""
        self._until_s = max(self._until_s, now_s + min(self._lease_s, self._oldest_picture_s - picture_age_s))

    def lose(self) -> None:
        """The page is hidden, closed, or not the one that drives any more."""
        self._until_s = float("-inf")

    def there(self, now_s: float) -> bool:
        """Whether somebody looks."""
        return now_s < self._until_s
