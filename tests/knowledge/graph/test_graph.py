"""Which RLA followed which, as a graph."""

from pathlib import Path

import networkx as nx
import numpy as np

from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Expectation, Statistics, pack
from kurt2rt.knowledge.graph.graph import RlaNetwork, build_network, drop_rare_edges, read_network, write_graphml
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from tests.core.rla.helpers import created
from tests.knowledge.lessons import begun
from tests.knowledge.refusals import refused

ENDS = Expectation("lesson-1", 7, 25.0, pack(np.zeros(2)), pack(np.zeros(2)))
DROVE = Statistics(
    uses={1: 20, 2: 9, 3: 1},
    transitions={(1, 2): 9, (1, 3): 1, (2, 1): 8, (3, 3): 1, (2, 9): 2},
    expectations={1: ENDS, 2: ENDS},
)


def system() -> RlaSystem:
    taught = RlaSystem(2, 10.0, others={MID: Space(2, 1.0)})
    for rla_id, behaviour in ((1, "left"), (2, "left"), (3, "right"), (4, "right")):
        taught.apply(created(rla_id, (float(rla_id), 0.0), behaviour=behaviour))
    for rla_id, place in ((5, (3.0, 4.0)), (6, (5.0, 4.0))):
        taught.apply(created(rla_id, place, action="left", level=MID))
    return taught


def edges(network: RlaNetwork) -> dict[tuple[int, int], tuple[int, float]]:
    found = {edge: network.edges[edge] for edge in network.edges}
    return {edge: (each["times"], each["percent"]) for edge, each in found.items()}


def test_build_network_one_behaviour_has_shares_of_all() -> None:
    network = build_network(system(), DROVE, behaviour="left")
    assert edges(network) == {(1, 2): (9, 90.0), (2, 1): (8, 80.0)}


def test_build_network_mid_level_has_places() -> None:
    network = build_network(system(), Statistics(transitions={(5, 6): 2}), level=MID, features=("x_m", "y_m"))
    assert edges(network) == {(5, 6): (2, 100.0)}
    assert [(network.nodes[rla_id]["x_m"], network.nodes[rla_id]["y_m"]) for rla_id in network] == [(3, 4), (5, 4)]


def test_drop_rare_edges_drops_unused_rlas() -> None:
    network = drop_rare_edges(build_network(system(), DROVE), 20.0)
    assert edges(network) == {(1, 2): (9, 90.0), (2, 1): (8, 80.0), (3, 3): (1, 100.0)}
    assert sorted(network) == [1, 2, 3]


def test_read_network_without_rlas_is_refused(path: Path) -> None:
    with Journal.read_only(begun(path)) as journal:
        assert sorted(read_network(journal)) == [1, 2, 3]
        with refused(KnowledgeCode.NO_RLA_AT_LEVEL, level="mid", found="basic"):
            read_network(journal, level=MID)
        with refused(KnowledgeCode.NO_RLA_OF_BEHAVIOUR, behaviour="left"):
            read_network(journal, behaviour="left")


def test_graphml_is_read_back_with_the_conditions(tmp_path: Path) -> None:
    network = build_network(system(), DROVE, features=("s1", "s2"))
    write_graphml(network, "a title", tmp_path / "made" / "network.graphml")
    again = nx.read_graphml(tmp_path / "made" / "network.graphml", node_type=int)
    assert (dict(again.nodes), dict(again.edges), again.graph["title"]) == (
        dict(network.nodes),
        dict(network.edges),
        "a title",
    )
    assert again.nodes[3]["s1"] == 3.0
