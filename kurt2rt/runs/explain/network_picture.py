"""File of the RLA network: GraphML, or a picture with a tile for each RLA: what it senses, and what it does."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from hal.robot import WheelSpeeds
from hal.robot_settings import RobotSettings
from kurt2rt.knowledge.graph.graph import RlaNetwork
from kurt2rt.knowledge.graph.layout import Place, place_groups, place_known, span
from kurt2rt.platform.save_figure import save_figure
from kurt2rt.runs.explain.colours import INK, PALE_INK, colours_of
from kurt2rt.runs.explain.sensor_view import SensorView, draw_motion, draw_sensor_view

Node = Mapping[str, Any]
_TILE_INCHES = 0.95
_HALF = 0.44
"""Half of the side of a tile, in tiles."""
_PLATE = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
_LABELLED_PERCENT = 50.0
"""Rarer edges have no label: with 130 RLAs the labels would cover each other."""


def draw_network(
    network: RlaNetwork, title: str, path: Path, robot: RobotSettings, motions: Mapping[str, WheelSpeeds]
) -> None:
    """Write the picture of a network in the format of the file's ending, .svg or .png; make the folder.

    `motions`: of the robot's wheels by action, where they are known. Raises OSError.
    """
    save_figure(_network_figure(network, title, robot, motions), path)


def _network_figure(
    network: RlaNetwork, title: str, robot: RobotSettings, motions: Mapping[str, WheelSpeeds]
) -> Figure:
    """Return a picture with a tile for each RLA, next to those of its action unless all have known places."""
    nodes = network.nodes
    colours = colours_of(nodes[rla_id]["action"] for rla_id in network)
    groups = _groups(network)
    known = place_known(network)
    places = known or place_groups(list(groups.values()))
    (low_x, high_x), (low_y, high_y) = span(places)
    width, height = high_x - low_x + 1.4, high_y - low_y + 2.2
    figure = Figure(figsize=(max(_TILE_INCHES * width, 6.0), _TILE_INCHES * height), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(low_x - 0.7, high_x + 0.7), ylim=(low_y - 0.7, high_y + 1.5))
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.text(0.5, 1.0 - 0.1 / height, title, fontsize=11, color=INK, ha="center", va="top", wrap=True)
    for (behaviour, action), ids in {} if known else groups.items():
        x, y = places[ids[0]]
        name = f"{behaviour}: {action}" if behaviour else action
        axes.text(x - _HALF, y + 0.54, f"{name} ({len(ids)})", fontsize=10, fontweight="bold", zorder=9, bbox=_PLATE)
    for before, after in network.edges:
        if before != after:
            percent = network.edges[before, after]["percent"]
            _draw_edge(axes, places[before], places[after], percent, colours[nodes[before]["action"]])
    for rla_id, place in places.items():
        node = nodes[rla_id]
        _draw_tile(axes, f"{rla_id}", node, place, colours[node["action"]])
        _fill(axes, node, place, robot, motions.get(node["action"]), colours[node["action"]])
    return figure


def _groups(network: RlaNetwork) -> dict[tuple[str, str], list[int]]:
    """Return the ids by behaviour and action, in the order of behaviours, large groups first, much used RLAs first."""
    found: dict[tuple[str, str], list[int]] = {}
    for rla_id, node in sorted(network.nodes.items(), key=lambda each: -each[1]["uses"]):
        found.setdefault((node["behaviour"], node["action"]), []).append(rla_id)
    return dict(sorted(found.items(), key=lambda each: (each[0][0], -len(each[1]), each[0][1])))


def _draw_edge(axes: Axes, tail: Place, head: Place, percent: float, colour: str) -> None:
    arrow = {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=0.15", "shrinkA": 0.0, "shrinkB": 24.0}
    look = {"color": colour, "linewidth": 0.4 + 2.2 * percent / 100, "alpha": 0.25 + 0.6 * percent / 100}
    axes.annotate("", head, tail, arrowprops=arrow | look, zorder=1)
    if percent >= _LABELLED_PERCENT:
        (x, y), (to_x, to_y) = tail, head
        # The middle of the arc, which arc3 bends by half of `rad` to the right of the chord.
        place = (x + to_x) / 2 + 0.075 * (to_y - y), (y + to_y) / 2 - 0.075 * (to_x - x)
        axes.text(*place, f"{percent:.0f}", fontsize=7, color=INK, ha="center", va="center", zorder=2, bbox=_PLATE)


def _draw_tile(axes: Axes, name: str, node: Node, place: Place, colour: str) -> None:
    """Draw the frame of an RLA, thicker the more often it drove, with its id and the number of its uses."""
    x, y = place
    corner, side, width = (x - _HALF, y - _HALF), 2 * _HALF, 1.0 + min(node["uses"], 50) / 20
    axes.add_patch(
        FancyBboxPatch(corner, side, side, "round,pad=0,rounding_size=0.08", fc="white", ec=colour, lw=width, zorder=3)
    )
    axes.text(x - 0.4, y + 0.28, name, fontsize=8, fontweight="bold", color=INK, zorder=9)
    axes.text(x + 0.4, y - 0.4, f"{node['uses']}x", fontsize=6.5, color=PALE_INK, ha="right", zorder=9)


def _fill(axes: Axes, node: Node, place: Place, robot: RobotSettings, motion: WheelSpeeds | None, colour: str) -> None:
    """Draw the readings of a condition round the robot and the way that its action takes; otherwise its name."""
    x, y = place
    counts = {name: node[name] for name in robot.infrared.names if name in node}
    if not counts:
        axes.text(x, y, node["action"].replace("_", "\n"), fontsize=7, ha="center", va="center", zorder=4)
        return
    fan = axes.inset_axes((x - 0.44, y - 0.44, 0.88, 0.88), transform=axes.transData, zorder=5)
    draw_sensor_view(fan, robot, SensorView(counts, {}), wall_width=1.3)
    if motion is not None:
        draw_motion(fan, robot, motion, colour)
