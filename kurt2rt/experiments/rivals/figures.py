"""Figure of a league: the share of robots that pass, by presses and by the time of the lesson."""

from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from statistics import median

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.rivals.plan import League, Row
from kurt2rt.experiments.rivals.rival import SHIPPED
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.figure_style import save

_STYLES = ("-", "--", ":", "-.")


def draw_curves(league: League, path: Path) -> SavedFigure:
    """Draw two panels for each task, with a line for each rival, as a PNG to `path`. Raises OSError."""
    tasks = league.plan.tasks
    figure = Figure(figsize=(12.8, 5.2 * len(tasks)), layout="constrained")
    panels = figure.subplots(len(tasks), 2, squeeze=False, sharey=True)
    for (by_presses, by_time), task in zip(panels.tolist(), tasks, strict=True):
        for axes in (by_presses, by_time):
            axes.set_ylim(-0.03, 1.03)
            axes.grid(alpha=0.3)
        styles = cycle(_STYLES)
        for row in league.rows:
            if row.entry.task == task.name and row.judged:
                style = next(styles)
                _draw(by_presses, *_points_by_presses(league.plan.after, row), row, style)
                _draw(by_time, *_points_by_time(row), row, style)
        by_presses.set_title(task.name, loc="left")
        by_presses.set_ylabel("share of robots that pass")
        by_presses.set_xlabel("presses; the last point is the end of the lesson")
        by_time.set_xlabel("time of the lesson, s")
        by_time.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save(figure, path)
    return SavedFigure(
        path,
        "Success by presses, and by time",
        "Each line is a learner, taught by the same teacher as all others. The band is the 95 % interval of the RLA "
        "system as shipped; the intervals of all are in the first table. Time: the median robot's.",
    )


def _points_by_presses(after: Sequence[int], row: Row) -> tuple[list[float], list[int]]:
    """Return numbers of presses, and the index of the checkpoint of each."""
    end = median(each.presses for each in row.outcomes)
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    return [*reached, end], [*range(len(reached)), len(after)]


def _points_by_time(row: Row) -> tuple[list[float], list[int]]:
    """Return the median times of the checkpoints in s, and their indexes."""
    places = range(len(row.outcomes[0].checkpoints))
    times = [median(each.checkpoints[place].teaching_s for each in row.outcomes) for place in places]
    # A press that the median robot never needed is of the end.
    kept = [place for place in places if place == places[-1] or times[place] < times[-1]]
    return [times[place] for place in kept], kept


def _draw(axes: Axes, at: Sequence[float], places: Sequence[int], row: Row, style: str) -> None:
    robots, shipped = len(row.judged), row.entry.rival.name == SHIPPED
    axes.plot(
        at,
        [row.passed(place) / robots for place in places],
        style,
        marker="o",
        markersize=4,
        linewidth=2.6 if shipped else 1.3,
        label=row.entry.rival.title,
    )
    if shipped:
        bounds = [wilson_interval(row.passed(place), robots) for place in places]
        axes.fill_between(at, [low for low, _ in bounds], [high for _, high in bounds], alpha=0.15)
