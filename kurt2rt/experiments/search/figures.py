"""Figure of the trials: the score of each, in its order and by each key."""

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from optuna.trial import FrozenTrial

from kurt2rt.experiments.search.journal import finished
from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.study.figure import SavedFigure
from kurt2rt.experiments.study.figure_style import save

_TRIAL, _SHIPPED, _BEST, _PRUNED = "#1f6fb2", "#d1495b", "#2e8540", "#9a9a9a"
_COLUMNS = 3


def draw_trials(plan: SearchPlan, trials: list[FrozenTrial], path: Path) -> SavedFigure:
    """Draw the scores by number and by each key as a PNG to `path`. Raises OSError."""
    panels = 1 + len(plan.search.space)
    rows = -(-panels // _COLUMNS)
    figure = Figure(figsize=(4.4 * _COLUMNS, 3.4 * rows), layout="constrained")
    axes: list[Axes] = figure.subplots(rows, _COLUMNS, squeeze=False, sharey=True).flatten().tolist()
    _draw_order(axes[0], trials)
    for each, dimension in zip(axes[1:], plan.search.space, strict=False):
        _draw_scores(each, [trial.params[dimension.key] for trial in trials], trials)
        each.set_xlabel(dimension.key)
        if dimension.log:
            each.set_xscale("log")
    for unused in axes[panels:]:
        unused.remove()
    for first in axes[:panels:_COLUMNS]:
        first.set_ylabel("score")
    save(figure, path)
    return SavedFigure(
        path,
        "Trials",
        "Each point is a trial, the first one the shipped settings. The score is the share of exams passed, and less "
        "than half an exam more for little effort. A cross was pruned: its score is that of its first robots.",
    )


def _draw_order(axes: Axes, trials: list[FrozenTrial]) -> None:
    _draw_scores(axes, [float(trial.number) for trial in trials], trials)
    done = finished(trials)
    best = [max(trial.value or 0.0 for trial in done[: place + 1]) for place in range(len(done))]
    axes.step([trial.number for trial in done], best, where="post", color=_BEST, label="best so far")
    axes.set_xlabel("trial")
    axes.legend(fontsize="small", frameon=False)


def _draw_scores(axes: Axes, places: list[float], trials: list[FrozenTrial]) -> None:
    done = {trial.number for trial in finished(trials)}
    for place, trial in zip(places, trials, strict=True):
        score = trial.intermediate_values[trial.last_step or 0]  # of all robots, or of those before it was pruned
        colour = _PRUNED if trial.number not in done else _TRIAL if trial.number else _SHIPPED
        axes.scatter(place, score, color=colour, marker="o" if trial.number in done else "x", s=22)
    axes.grid(alpha=0.3)
