"""Stored outcomes, written by hand."""

from kurt2rt.experiments.route.outcome import Layer, RouteDrive, RouteOutcome, Wrong
from kurt2rt.experiments.study.provenance import Provenance

MADE_OF = Provenance(task="t", robot="r", worlds="w", source="s", versions="v")
SQUARE = ((2.2, 2.2), (2.2, 4.0), (4.0, 4.0), (4.0, 2.2))


def drive(*layers: Layer, junctions: int = 80, collisions: int = 0, stuck: bool = False) -> RouteDrive:
    wrong = tuple(
        Wrong(at_s=10.0 * number, leg=number, layer=layer, x_m=2.2, y_m=3.1) for number, layer in enumerate(layers, 1)
    )
    return RouteDrive(
        duration_s=600.0,
        junctions=junctions,
        right=junctions - len(layers),
        wrong=wrong,
        collisions=collisions,
        stuck=stuck,
        alarm="",
        share_unknown=0.0,
        way_m=120.0,
        trail=((2.2, 3.1), (2.2, 3.9), (2.3, 4.0)),
        collided_at=((2.2, 3.1),) * collisions,
    )


def outcome(seed: int, driven: RouteDrive, mid_rlas: int = 12) -> RouteOutcome:
    return RouteOutcome(
        made_of=MADE_OF,
        seed=seed,
        route=SQUARE,
        start=(3.1, 2.2),
        teaching_s=797.0,
        mid_rlas=mid_rlas,
        basic_rlas=150,
        mid_asks=3,
        mid_corrections=8,
        missed_junctions=0,
        asks=1,
        corrections=40,
        rescues=0,
        knowledge_hash="0" * 64,
        drive=driven,
    )
