"""Figure of a comparison: the share of robots that pass, by presses."""

from itertools import cycle
from pathlib import Path
from statistics import median

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.experiments.compare.plan import Comparison, Row
from kurt2rt.experiments.compare.pupil import SHIPPED
from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.figure_style import save

_STYLES = ("-", "--", ":", "-.")


def draw_curves(comparison: Comparison, path: Path) -> None:
    """Draw a panel for each task, with a line for each pupil, as a PNG to `path`. Raises OSError.

    The last point of a line is the end of the lesson. The band is the 95 % interval of the RLA system.
    """
    tasks = comparison.plan.tasks
    figure = Figure(figsize=(9.6, 4.8 * len(tasks)), layout="constrained")
    panels = figure.subplots(len(tasks), 1, squeeze=False).flatten().tolist()
    for axes, task in zip(panels, tasks, strict=True):
        styles = cycle(_STYLES)
        for row in comparison.rows:
            if row.entry.task == task.name and row.judged:
                _draw(axes, comparison.plan.after, row, next(styles))
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
        axes.set_title(task.name, loc="left")
        axes.set_ylabel("share of robots that pass")
        axes.set_xlabel("presses; the last point is the end of the lesson")
        if axes.lines:
            axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    save(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], row: Row, style: str) -> None:
    robots, shipped = len(row.judged), row.entry.pupil.name == SHIPPED
    end = median(each.presses for each in row.outcomes)
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    counts = [row.passed(place) for place in (*range(len(reached)), len(after))]
    at = [*reached, end]
    title, width = row.entry.pupil.title, 2.6 if shipped else 1.3
    axes.plot(at, [each / robots for each in counts], style, marker="o", markersize=4, linewidth=width, label=title)
    if shipped:
        low, high = zip(*(wilson_interval(each, robots) for each in counts), strict=True)
        axes.fill_between(at, low, high, alpha=0.15)
