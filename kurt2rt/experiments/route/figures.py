"""Pictures of routes, and of the drives along them."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from matplotlib.axes import Axes

from kurt2rt.experiments.lockstep.drive_row import Place
from kurt2rt.experiments.lockstep.trails import ASKED, columns, legend_below
from kurt2rt.experiments.route.route_monitor import LAYERS
from kurt2rt.experiments.route.study import RouteOutcome, Routes
from kurt2rt.experiments.study.figures import SavedFigure, draw_drive, panels_of, save
from kurt2rt.experiments.study.table import collisions_text
from simbridge.contracts.simulation import SimulationFactory

_ROUTE = "#e8a33d"
_MARKS = {"symbols": "v", "mid": "s", "basic": "o"}
_COLUMNS = 4
_BESIDE_M = 0.13
"""So far to the right of the middle of a street its way is drawn, so that both ways through it are seen."""


def draw_figures(routes: Sequence[Routes], factory: SimulationFactory, folder: Path) -> Iterator[SavedFigure]:
    """Draw each length into the folder and yield it: route-<decisions>.png. Raises OSError."""
    for decisions, outcomes in routes:
        path = folder / f"route-{decisions}.png"
        draw_routes(factory, outcomes, path)
        yield SavedFigure(
            path,
            f"Routes of {decisions} decisions",
            "Orange: the route of each robot with the number of each decision behind its junction; blue: its drive "
            "without a teacher; red: wrong decisions (triangle: symbols, square: mid level, circle: basic level); "
            "black: collisions.",
        )


def draw_route(factory: SimulationFactory, outcome: RouteOutcome, path: Path) -> None:
    """Draw the route of one robot with the numbers of its decisions, and the drive.

    Writes a PNG to `path`. Raises OSError.
    """
    figure, (axes,) = panels_of(1, 1, (7.2, 7.8))
    _draw(axes, factory, outcome)
    axes.set_title(_told(outcome), fontsize="medium")
    legend_below(axes, columns=3)
    save(figure, path)


def draw_routes(factory: SimulationFactory, outcomes: Sequence[RouteOutcome], path: Path) -> None:
    """Draw a panel for each robot: route, decisions and drive. Writes a PNG to `path`. Raises OSError."""
    figure, panels = panels_of(len(outcomes), _COLUMNS, (4.0, 4.4))
    for axes, outcome in zip(panels, outcomes, strict=True):
        _draw(axes, factory, outcome)
        axes.set_title(_told(outcome), fontsize="small")
    save(figure, path)


def _draw(axes: Axes, factory: SimulationFactory, outcome: RouteOutcome) -> None:
    # Questions are not drawn: wrong decisions have their colour.
    draw_drive(axes, factory, outcome.drive.model_copy(update={"asked_at": ()}), width=0.8)
    route = [*outcome.route, outcome.route[0]]
    label: str | None = f"the route, {len(outcome.route)} decisions"
    for number, (here, there) in enumerate(pairwise(route), start=1):
        (from_x, from_y), (to_x, to_y) = _beside(here, there)
        arrow = {"arrowstyle": "-|>", "color": _ROUTE, "linewidth": 2.4, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (to_x, to_y), (from_x, from_y), arrowprops=arrow, zorder=2)
        place = (from_x + 0.14 * (to_x - from_x), from_y + 0.14 * (to_y - from_y))
        axes.annotate(str(number), place, fontsize="x-small", ha="center", va="center", zorder=7, bbox=_BOX)
    axes.plot([], [], color=_ROUTE, linewidth=2.4, label=label)
    for layer in LAYERS:
        wrong = [(each.x_m, each.y_m) for each in outcome.wrong if each.layer == layer]
        if wrong:
            label = f"wrong: {layer} ({len(wrong)})"
            axes.plot(*columns(wrong), _MARKS[layer], color=ASKED, markersize=7, zorder=5, label=label)


_BOX = {"boxstyle": "circle,pad=0.12", "facecolor": "white", "edgecolor": _ROUTE, "linewidth": 0.8}


def _beside(here: Place, there: Place) -> tuple[Place, Place]:
    """Return start and end of the way between two junctions, right of the middle of the street."""
    (from_x, from_y), (to_x, to_y) = here, there
    length_m = math.dist(here, there)
    along_x, along_y = (to_x - from_x) / length_m, (to_y - from_y) / length_m
    right_x, right_y = along_y * _BESIDE_M, -along_x * _BESIDE_M
    cut_m = 2 * _BESIDE_M
    return (
        (from_x + right_x + cut_m * along_x, from_y + right_y + cut_m * along_y),
        (to_x + right_x - cut_m * along_x, to_y + right_y - cut_m * along_y),
    )


def _told(outcome: RouteOutcome) -> str:
    drive = outcome.drive
    collisions = f", {collisions_text(drive.collisions)}" if drive.collisions else ""
    return (
        f"robot {outcome.seed}: {drive.right} of {drive.junctions} decisions right{collisions}\n"
        f"{drive.duration_s:.0f} s {'without an error' if drive.passed else 'with errors'}, "
        f"{outcome.mid_rlas} mid-level RLAs"
    )
