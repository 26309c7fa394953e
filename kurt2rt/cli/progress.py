"""Progress bars for jobs that are counted in seconds of robot time."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from kurt2rt.experiments.curriculum import Report


@contextmanager
def job_bars() -> Iterator[Report]:
    """A bar for each job that reports, on standard error, so that standard output holds results alone."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:4.0f} of {task.total:.0f} s robot time"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bars: dict[str, TaskID] = {}

        def report(what: str, done_s: float, whole_s: float) -> None:
            if what not in bars:
                bars[what] = progress.add_task(what, total=whole_s)
            progress.update(bars[what], completed=done_s)

        yield report
