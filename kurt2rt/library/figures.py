"""Figure of a drive from above."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from kurt2rt.experiments.lockstep.drive_row import Place
from kurt2rt.experiments.lockstep.trails import draw_drive, legend_below
from kurt2rt.runs.explain.save_figure import ShownFigure
from simbridge.contracts.simulation import SimulationFactory


def drive_figure(factory: SimulationFactory, world: str, trail: Sequence[Place], asked: Sequence[Place]) -> Figure:
    """Return a figure of the world with a trail and the places of questions, in m.

    Raises config.settings.SettingsError for an unknown world.
    """
    figure = ShownFigure(figsize=(5.2, 5.2), layout="constrained")
    axes = figure.subplots()
    draw_drive(axes, factory, world, trail, asked)
    if trail or asked:
        legend_below(axes, columns=2)
    return figure
