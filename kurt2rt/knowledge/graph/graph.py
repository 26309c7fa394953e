"""RLA network as a directed graph of networkx, and its file.

Nodes are RLAs, edges their successors, with percentages.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NoReturn, TypeAlias

import networkx as nx

from kurt2rt.core.expectations.expectations import is_valid_for
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics, follow_ups
from kurt2rt.knowledge.journal.fold import read_content
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError

GRAPHML = ".graphml"
FORMATS = (".svg", ".png", GRAPHML)
"""Allowed suffixes of a network's file."""

RlaNetwork: TypeAlias = "nx.DiGraph[int]"
"""Nodes are ids of RLAs, with the attributes of `build_network`; edges have `times` and `percent`."""


def read_network(journal: Journal, *, level: str = BASIC, behaviour: str | None = None) -> RlaNetwork:
    """Return the network of one level in a knowledge file, or of one behaviour of the level.

    Raises KnowledgeError for a damaged file, and if it has no such RLA.
    """
    _, system, statistics = read_content(journal)
    levels = journal.binding.levels
    features = levels[level].feature_names if level in levels else journal.binding.feature_names
    network = build_network(system, statistics, level=level, behaviour=behaviour, features=features)
    if not network:
        _refuse(journal, system, level, behaviour)
    return network


def build_network(
    system: RlaSystem,
    statistics: Statistics,
    *,
    level: str = BASIC,
    behaviour: str | None = None,
    features: Iterable[str] = (),
) -> RlaNetwork:
    """Return the living RLAs of a level, or of one behaviour of it, and how often they followed each other.

    A node has the attributes `level`, `behaviour`, `action` and `uses`; if an end of it was observed, also `ends`
    (their number) and `ticks` (mean duration), and its condition by the names of `features`. An edge has `times` and
    `percent`, its share of all successors, those that are not in the network included.
    """
    network: RlaNetwork = nx.DiGraph()
    for rla in system.rlas_at(level):
        if behaviour is not None and rla.behaviour != behaviour:
            continue
        network.add_node(
            rla.rla_id,
            level=rla.level,
            behaviour=rla.behaviour,
            action=rla.action,
            uses=statistics.uses.get(rla.rla_id, 0),
            **dict(zip(features, map(float, rla.condition), strict=False)),
        )
        expectation = statistics.expectations.get(rla.rla_id)
        if expectation is not None and is_valid_for(system, rla.rla_id, expectation, level):
            network.add_node(rla.rla_id, ends=expectation.count, ticks=expectation.ticks)
    for before, shares in follow_ups(statistics).items():
        _add_edges(network, before, shares, statistics.transitions)
    return network


def drop_rare_edges(network: RlaNetwork, at_least_percent: float) -> RlaNetwork:
    """Return a copy without edges below a share in percent, and without unused RLAs that have no edge then."""
    kept: RlaNetwork = nx.DiGraph()
    edges = [edge for edge in network.edges(data=True) if edge[2]["percent"] >= at_least_percent]
    linked = {end for edge in edges for end in edge[:2]}
    kept.add_nodes_from(
        (rla_id, attributes)
        for rla_id, attributes in network.nodes(data=True)
        if rla_id in linked or attributes["uses"]
    )
    kept.add_edges_from(edges)
    return kept


def write_graphml(network: RlaNetwork, title: str, path: Path) -> None:
    """Write the network for other programs; make the folder. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    network.graph["title"] = title
    nx.write_graphml(network, path)


def _add_edges(
    network: RlaNetwork, before: int, shares: Mapping[int, float], times: Mapping[tuple[int, int], int]
) -> None:
    if before not in network:
        return
    for after, percent in shares.items():
        if after in network:
            network.add_edge(before, after, times=times[before, after], percent=percent)


def _refuse(journal: Journal, system: RlaSystem, level: str, behaviour: str | None) -> NoReturn:
    levels = [each for each in (BASIC, *journal.binding.levels) if system.rlas_at(each)]
    if level not in levels:
        found = ", ".join(levels) or "none"
        raise KnowledgeError(KnowledgeCode.NO_RLA_AT_LEVEL, where=journal.path, level=level, found=found)
    found = ", ".join(sorted({rla.behaviour or "one without a name" for rla in system.rlas_at(level)}))
    raise KnowledgeError(KnowledgeCode.NO_RLA_OF_BEHAVIOUR, where=journal.path, behaviour=behaviour, found=found)
