"""Progress of a job of several drives."""

from kurt2rt.experiments.study.pool import Progress


class ProgressSum:
    """Sum of the robot time of successive drives."""

    def __init__(self, tell: Progress) -> None:
        self._tell = tell
        self._before_s = 0.0
        self._now_s = 0.0

    def report(self, what: str, done_s: float, whole_s: float) -> None:  # noqa: ARG002 - as curriculum.Report
        """Report the sum after `done_s`, in s, of a drive; a smaller `done_s` than before begins the next drive.

        `what` and `whole_s` are not used.
        """
        if done_s < self._now_s:
            self._before_s += self._now_s
        self._now_s = done_s
        self._tell(self._before_s + done_s)
