"""Figure of a drive from above."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from hal.simulation import Position, SimulationFactory
from kurt2rt.experiments.lockstep.trails import ASKED, columns, draw_trail
from kurt2rt.runs.explain.save_figure import ShownFigure

_CARRIED_M = 0.2
"""Greater distance of two points of a trail, 0.1 s apart: the robot was repositioned."""


def drive_figure(
    factory: SimulationFactory, world: str, trail: Sequence[Position], asked: Sequence[Position]
) -> Figure:
    """Return a figure of the world with a trail and the places of questions, in m.

    Raises hal.settings.SettingsError for an unknown world.
    """
    figure = ShownFigure(figsize=(5.2, 5.2), layout="constrained")
    axes = figure.subplots()
    factory.draw(axes, world)
    draw_trail(axes, trail, "the robot", carried_m=_CARRIED_M)
    if asked:
        axes.plot(*columns(asked), "o", color=ASKED, markersize=5, zorder=4, label=f"questions ({len(asked)})")
    if trail or asked:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=2, fontsize="small", frameon=False)
    return figure
