"""Which of the open pages has the pad."""


class ControlLease:
    """One page drives, the others watch. Times are seconds of any clock that only grows."""

    def __init__(self, silent_s: float = 1.0) -> None:
        """A page not heard of for `silent_s` keeps its place only until another one wants it."""
        self._silent_s = silent_s
        self._heard_s = 0.0
        self.holder: int | None = None

    def arrive(self, page: int, now_s: float) -> None:
        """A page was opened: the seat is its own where nobody sits."""
        if self._is_free(now_s):
            self._sit(page, now_s)

    def take(self, page: int, now_s: float) -> None:
        """The newest page that asks for the seat has it."""
        self._sit(page, now_s)

    def hear(self, page: int, now_s: float) -> None:
        """The page lives."""
        if page == self.holder:
            self._heard_s = now_s

    def hide(self, page: int) -> None:
        """Nobody sees the page: the next one that is opened has its seat."""
        if page == self.holder:
            self._heard_s = float("-inf")

    def leave(self, page: int) -> None:
        """The page was closed. Nobody moves up unasked: another page may lie in a pocket."""
        if page == self.holder:
            self.holder = None

    def _is_free(self, now_s: float) -> bool:
        return self.holder is None or now_s - self._heard_s > self._silent_s

    def _sit(self, page: int, now_s: float) -> None:
        self.holder = page
        self._heard_s = now_s
