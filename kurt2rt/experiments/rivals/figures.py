"""Figure of a league: the share of robots that pass, by presses."""

from itertools import cycle
from pathlib import Path
from statistics import median

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.experiments.rivals.plan import League, Row
from kurt2rt.experiments.rivals.rival import SHIPPED
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.figure_style import save

_STYLES = ("-", "--", ":", "-.")


def draw_curves(league: League, path: Path) -> SavedFigure:
    """Draw a panel for each task and a line for each rival as a PNG to `path`. Raises OSError."""
    tasks = league.plan.tasks
    figure = Figure(figsize=(6.4 * len(tasks), 6.0), layout="constrained")
    panels = figure.subplots(1, len(tasks), squeeze=False, sharey=True).flatten().tolist()
    for axes, task in zip(panels, tasks, strict=True):
        styles = cycle(_STYLES)
        for row in league.rows:
            if row.entry.task == task.name and row.judged:
                _draw(axes, league.plan.after, row, next(styles))
        axes.set_title(task.name)
        axes.set_xlabel("presses; the last point is the end of the lesson")
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, frameon=False)
    panels[0].set_ylabel("share of robots that pass")
    save(figure, path)
    return SavedFigure(path, "Success by presses", "Each line is a learner, taught by the same teacher as all others.")


def _draw(axes: Axes, after: tuple[int, ...], row: Row, style: str) -> None:
    end = median(each.presses for each in row.outcomes)
    shares = [row.passed(place) / len(row.judged) for place in range(len(after) + 1)]
    # A median robot that never got so many presses has its point of the end there.
    reached = [presses for presses in after if presses < end]
    axes.plot(
        [*reached, end],
        [*shares[: len(reached)], shares[-1]],
        style,
        marker="o",
        markersize=4,
        linewidth=2.6 if row.entry.rival.name == SHIPPED else 1.3,
        label=row.entry.rival.title,
    )
