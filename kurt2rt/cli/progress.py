"""Progress bars for jobs that are counted in seconds of robot time."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column

from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.study.pool import PoolProgress


def _progress(*, transient: bool) -> Progress:
    """Return bars of 80 columns, on standard error: standard output holds results alone."""
    columns = (
        TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis")),
        BarColumn(bar_width=15),
        # As wide as they become: else a long name cuts their digits off.
        TaskProgressColumn(table_column=Column(min_width=4, no_wrap=True)),
        TimeElapsedColumn(table_column=Column(min_width=7, no_wrap=True)),
        TimeRemainingColumn(table_column=Column(min_width=7, no_wrap=True)),
    )
    console = Console(stderr=True)
    return Progress(*columns, console=console, transient=transient, disable=transient and not console.is_terminal)


@contextmanager
def job_bars(*, transient: bool = False) -> Iterator[Report]:
    """Yield a callback that shows a bar for each job; `transient`: all go when they are done."""
    with _progress(transient=transient) as progress:
        bars: dict[str, TaskID] = {}

        def report(what: str, done_s: float, whole_s: float) -> None:
            if what not in bars:
                bars[what] = progress.add_task(what, total=whole_s)
            progress.update(bars[what], completed=done_s, total=whole_s)

        yield report


class OneBar:
    """One bar for all jobs."""

    def __init__(self, progress: Progress, whole_s: float) -> None:
        self._progress = progress
        self._id = progress.add_task("", total=whole_s)

    def update(self, progress: PoolProgress) -> None:
        """Show the progress of the jobs: their robot time, and the names of running jobs."""
        first, *others = progress.running or ("",)
        # One name and a number, so that the times next to it have room.
        doing = f"{first} and {len(others)} more" if others else first
        self._progress.update(self._id, completed=progress.done_s, description=doing)

    def after(self, before_s: float) -> Callable[[PoolProgress], None]:
        """Return `update` for jobs that follow others of `before_s` seconds of robot time."""
        return lambda progress: self.update(progress._replace(done_s=before_s + progress.done_s))

    def begin_next(self, whole_s: float) -> None:
        """Begin a further bar below, of `whole_s` seconds of robot time, for drives after the jobs."""
        self._id = self._progress.add_task("", total=whole_s)

    def say(self, what: str) -> None:
        """Replace the text of the bar, for work after the jobs."""
        self._progress.update(self._id, description=what)


@contextmanager
def one_bar(whole_s: float) -> Iterator[OneBar]:
    """Yield one bar for all jobs, of `whole_s` seconds of robot time; it goes when they are done."""
    with _progress(transient=True) as progress:
        yield OneBar(progress, whole_s)
