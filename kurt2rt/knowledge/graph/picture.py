"""File of the RLA network: GraphML, or a picture with nodes coloured by action and edges with percentages."""

import math
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import networkx as nx
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from kurt2rt.knowledge.graph.graph import GRAPHML, RlaNetwork
from kurt2rt.knowledge.graph.layout import Places, compute_layout, span

_INCHES_PER_UNIT = 0.62
_MARGIN = 0.9
_LEAST_INCHES = 3.0
_HEAD_INCHES, _LEGEND_INCHES = 0.5, 0.6
_STRAIGHT, _ARC = "arc3,rad=0.0", "arc3,rad=0.2"
_EDGE = "#404850"
_SMALLEST, _LARGEST = 130.0, 620.0
"""Areas of nodes, in square points."""
_LABELLED_PERCENT = 10.0
"""Rarer edges have no label: with 130 RLAs the labels would cover each other."""


def write_network(network: RlaNetwork, title: str, path: Path) -> None:
    """Write the network in the format of the file's ending, one of FORMATS; make the folder. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == GRAPHML:
        network.graph["title"] = title
        nx.write_graphml(network, path)
    else:
        _draw_network(network, title, path)


def _draw_network(network: RlaNetwork, title: str, path: Path) -> None:
    """Write a picture, SVG or PNG by the file's ending. Raises OSError.

    Each behaviour has a panel: commands lead from one to another, so there are no edges between panels.
    """
    parts = _parts(network)
    laid = [compute_layout(part) for part in parts.values()]
    columns = math.ceil(math.sqrt(len(parts)))
    rows = [laid[first : first + columns] for first in range(0, len(laid), columns)]
    wide = max((sum(_extent(places)[0] for places in row) for row in rows), default=_LEAST_INCHES)
    heights = [max(_extent(places)[1] for places in row) for row in rows]
    width, height = max(wide, 7.0), sum(heights) + _HEAD_INCHES + _LEGEND_INCHES
    figure = Figure(figsize=(width, height))
    colours = _colours(network)
    most = max((network.nodes[rla_id]["uses"] for rla_id in network), default=1)
    panels = iter(parts.items())
    low = height - _HEAD_INCHES
    for row, row_height in zip(rows, heights, strict=True):
        low -= row_height
        row_width = sum(_extent(places)[0] for places in row)
        left = (width - row_width) / 2
        for places, (name, part) in zip(row, panels, strict=False):
            panel_width = _extent(places)[0]
            axes = figure.add_axes((left / width, low / height, panel_width / width, row_height / height))
            left += panel_width
            _draw_part(axes, part, places, colours, most)
            if name:
                axes.set_title(f"{name}: {len(part)} RLAs", fontsize=12, y=1.0, pad=-10.0)
    figure.suptitle(title, y=1 - 0.15 / height, va="top", fontsize=13)
    _legend(figure, colours)
    # Text as text: it can be searched, and the file is a third as large.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "kurt2rt"}):
        figure.savefig(path, dpi=130, metadata={"Date": None} if path.suffix == ".svg" else None)


def _draw_part(axes: Axes, part: RlaNetwork, places: Places, colours: Mapping[str, str], most: int) -> None:
    axes.set_axis_off()
    ids = list(part)
    areas = [_area(part.nodes[rla_id]["uses"], most) for rla_id in ids]
    # Frequent edges last, on top of the others.
    percents = sorted((float(part.edges[edge]["percent"]), *edge) for edge in part.edges)
    for bend in (_STRAIGHT, _ARC):
        of_bend = [each for each in percents if _bend(part, *each[1:]) == bend]
        _draw_edges(axes, part, places, ids, areas, of_bend, bend)
    nx.draw_networkx_nodes(
        part,
        places,
        nodelist=ids,
        ax=axes,
        node_size=areas,
        node_color=[colours[part.nodes[rla_id]["action"]] for rla_id in ids],
        edgecolors="#202428",
        linewidths=0.7,
    )
    for rla_id in ids:
        red, green, blue = to_rgb(colours[part.nodes[rla_id]["action"]])
        ink = "white" if 0.30 * red + 0.59 * green + 0.11 * blue < 0.5 else "black"
        axes.annotate(str(rla_id), places[rla_id], ha="center", va="center", fontsize=7.5, color=ink)
    (low_x, high_x), (low_y, high_y) = span(places)
    axes.set_xlim(low_x - _MARGIN, high_x + _MARGIN)
    axes.set_ylim(low_y - _MARGIN, high_y + _MARGIN)
    axes.set_aspect("equal")


def _draw_edges(
    axes: Axes,
    part: RlaNetwork,
    places: Places,
    ids: list[int],
    areas: list[float],
    percents: list[tuple[float, int, int]],
    bend: str,
) -> None:
    if not percents:
        return
    arrows = nx.draw_networkx_edges(
        part,
        places,
        edgelist=[(before, after) for _, before, after in percents],
        ax=axes,
        node_size=areas,
        nodelist=ids,
        width=[0.5 + 2.2 * percent / 100 for percent, _, _ in percents],
        edge_color=_EDGE,
        arrowsize=[round(6 + 5 * percent / 100) for percent, _, _ in percents],
        connectionstyle=bend,
    )
    for arrow, (percent, _, _) in zip(arrows, percents, strict=True):
        arrow.set_alpha(0.25 + 0.6 * math.sqrt(percent / 100))
    nx.draw_networkx_edge_labels(
        part,
        places,
        edge_labels={
            (before, after): f"{percent:.0f}" for percent, before, after in percents if percent >= _LABELLED_PERCENT
        },
        ax=axes,
        font_size=6,
        font_color="#303840",
        rotate=False,
        connectionstyle=bend,
        bbox={"boxstyle": "round,pad=0.08", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
        node_size=areas,
        nodelist=ids,
    )


def _bend(part: RlaNetwork, before: int, after: int) -> str:
    """Return the style of an edge: an arc if there is one back, so that neither label hides the other."""
    return _ARC if part.has_edge(after, before) else _STRAIGHT


def _parts(network: RlaNetwork) -> dict[str, RlaNetwork]:
    members: dict[str, list[int]] = {}
    for rla_id in network:
        members.setdefault(network.nodes[rla_id]["behaviour"], []).append(rla_id)
    return {name: network.subgraph(members[name]) for name in sorted(members)}


def _area(uses: int, most: int) -> float:
    return _SMALLEST + (_LARGEST - _SMALLEST) * math.sqrt(uses / max(most, 1))


def _colours(network: RlaNetwork) -> dict[str, str]:
    actions = sorted({network.nodes[rla_id]["action"] for rla_id in network})
    palette = mpl.colormaps["tab20"]
    # Strong colours first, then their pale variants.
    order = [*range(0, 20, 2), *range(1, 20, 2)]
    return {action: to_hex(palette(order[place % 20])) for place, action in enumerate(actions)}


def _legend(figure: Figure, colours: Mapping[str, str]) -> None:
    handles = [
        Line2D(
            [], [], marker="o", linestyle="none", markersize=8, color=colour, markeredgecolor="#202428", label=action
        )
        for action, colour in colours.items()
    ]
    columns = max(1, min(len(handles), int(figure.get_figwidth() / 1.4)))
    figure.legend(handles=handles, loc="lower center", ncols=columns, frameon=False, fontsize=9)


def _extent(places: Places) -> tuple[float, float]:
    """Return width and height of a panel in inches."""
    (low_x, high_x), (low_y, high_y) = span(places)
    return (
        max(_LEAST_INCHES, _INCHES_PER_UNIT * (high_x - low_x + 2 * _MARGIN)),
        max(_LEAST_INCHES, _INCHES_PER_UNIT * (high_y - low_y + 2 * _MARGIN)),
    )
