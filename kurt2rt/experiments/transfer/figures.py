"""Figure of the transfer study: the share of robots that are right, by presses."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.report import wilson_interval
from kurt2rt.experiments.study.figure_style import save
from kurt2rt.experiments.transfer.plan import TransferStudy, TransferSummary

_COLOURS = ("#1f6fb2", "#d1495b", "#7a7a7a")
"""Colours of the variants, in the order of the study."""
_APART = 0.15
"""Distance in presses between the intervals of two variants, so that they do not hide each other."""


def draw_curves(study: TransferStudy, path: Path) -> None:
    """Draw the curves, a panel for each new world and a line for each variant, as a PNG to `path`. Raises OSError."""
    places = list(dict.fromkeys(each.experiment.place for each in study.summaries))
    figure = Figure(figsize=(5.4 * len(places), 5.0), layout="constrained")
    panels = figure.subplots(1, len(places), squeeze=False, sharey=True).flatten().tolist()
    for axes, place in zip(panels, places, strict=True):
        here = [each for each in study.summaries if each.experiment.place == place]
        for number, summary in enumerate(here):
            _draw(axes, study.plan.after, summary, number)
        axes.set_title(f"new world: {Path(place).stem}", fontsize="medium")
        axes.set_xlabel("presses in the new world (dotted: taught until right)")
        axes.set_ylim(-0.03, 1.03)
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.14), frameon=False)
    panels[0].set_ylabel("share of robots that are right there")
    save(figure, path)


def _draw(axes: Axes, after: tuple[int, ...], summary: TransferSummary, number: int) -> None:
    judged = len(summary.judged)
    if not judged:
        return
    colour = _COLOURS[number % len(_COLOURS)]
    by = [summary.right_by(presses) / judged for presses in after]
    axes.plot(after, by, color=colour, linestyle=":", linewidth=1.2)
    counts = [summary.right_after(presses) for presses in after]
    shares = [count / judged for count in counts]
    intervals = [wilson_interval(count, judged) for count in counts]
    below = [share - low for share, (low, _) in zip(shares, intervals, strict=True)]
    above = [high - share for share, (_, high) in zip(shares, intervals, strict=True)]
    axes.errorbar(
        [presses + _APART * number for presses in after],
        shares,
        yerr=(below, above),
        color=colour,
        marker="o",
        markersize=4,
        capsize=2,
        linewidth=1.4,
        elinewidth=0.8,
        label=f"{summary.experiment.variant.title} (n = {judged})",
    )
