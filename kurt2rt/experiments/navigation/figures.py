"""Figures of navigation: tour, named places and drives to goals."""

from pathlib import Path

from matplotlib.figure import Figure

from hal.simulation import SimulationFactory
from kurt2rt.experiments.lockstep.trails import draw_trail
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome
from kurt2rt.experiments.navigation.tour_guide import HOME
from kurt2rt.experiments.study.figure_style import START, save

_LED = "#b0b0b0"
_BOX = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": _LED, "linewidth": 0.6}


def draw_errands(factory: SimulationFactory, world: str, outcome: ErrandsOutcome, path: Path) -> None:
    """Draw the tour and the drives of one robot in a world, and write the picture to `path`. Raises OSError."""
    figure = Figure(figsize=(7.2, 8.0), layout="constrained")
    axes = figure.subplots()
    factory.draw(axes, world)
    label = f"led about, {outcome.teaching_s:.0f} s"
    axes.plot([x for x, _ in outcome.led], [y for _, y in outcome.led], color=_LED, lw=0.8, zorder=2, label=label)
    run = outcome.run_of("planning")
    assert run is not None
    draw_trail(axes, run.trail, f"errands without a teacher, {len(run.errands)} goals", carried_m=0.8, width=0.9)
    meant = {each.goal: each.reached for each in run.errands}
    for name, (x_m, y_m) in outcome.named.items():
        if name == HOME:
            axes.plot([x_m], [y_m], "s", color=START, fillstyle="none", mew=2.0, ms=9, zorder=6, label=HOME)
        else:
            weight = "bold" if name in meant else "normal"
            number = name.rsplit(" ", 1)[-1]
            axes.annotate(
                number, (x_m, y_m), ha="center", va="center", fontsize="x-small", weight=weight, zorder=7, bbox=_BOX
            )
    reached = len(run.reached)
    axes.set_title(
        f"robot {outcome.seed}: {reached} of {len(run.errands)} goals reached\n"
        f"{outcome.ways} of {outcome.ways_in_all} ways taught in {outcome.teaching_s:.0f} s",
        fontsize="medium",
    )
    figure.legend(loc="outside lower center", ncols=3, fontsize="small", frameon=False)
    save(figure, path)
