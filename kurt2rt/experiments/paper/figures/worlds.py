"""Fig. 4 and 6: the worlds."""

import math
from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hal.simulation import SimulationFactory
from kurt2rt.experiments.lockstep.report import label_of
from kurt2rt.experiments.study.figure_style import save


def draw_testing_ground(stage: SimulationFactory, world: str, path: Path) -> None:
    """Fig. 4: the world that is taught in, with the robot in it."""
    figure = Figure(figsize=(5.6, 6.0), layout="constrained")
    axes = figure.subplots()
    stage.draw(axes, world)
    stage.draw_robot(axes, world)
    save(figure, path)


def draw_worlds(stage: SimulationFactory, worlds: Sequence[str], path: Path) -> None:
    """Fig. 6: all worlds, two beside each other."""
    rows = math.ceil(len(worlds) / 2)
    figure = Figure(figsize=(10.0, 5.0 * rows), layout="constrained")
    panels = figure.subplots(rows, 2, squeeze=False).flatten().tolist()
    for axes, world in zip(panels, worlds, strict=False):
        stage.draw(axes, world)
        axes.set_title(f"World {label_of(world)}" if len(world) == 1 else f"{world.capitalize()} world")
    for axes in panels[len(worlds) :]:
        axes.set_axis_off()
    save(figure, path)
