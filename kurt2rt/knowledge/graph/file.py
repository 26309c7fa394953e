"""File of the RLA network: a picture, or GraphML, which networkx and other programs read."""

from pathlib import Path

import networkx as nx

from kurt2rt.knowledge.graph.graph import RlaNetwork

GRAPHML = ".graphml"
FORMATS = (".svg", ".png", GRAPHML)
"""Allowed endings of a file's name."""


def write_network(network: RlaNetwork, title: str, path: Path) -> None:
    """Write the network in the format of the file's ending, one of FORMATS; make the folder. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == GRAPHML:
        network.graph["title"] = title
        nx.write_graphml(network, path)
        return
    # Not at the top: matplotlib is an extra, and a robot does without it.
    from kurt2rt.knowledge.graph.picture import draw_network

    draw_network(network, title, path)
