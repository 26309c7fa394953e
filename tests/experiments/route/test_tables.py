import re
from collections.abc import Sequence

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.route.route_monitor import Layer, RouteMistake
from kurt2rt.experiments.route.study import RouteOutcome, Routes
from kurt2rt.experiments.route.tables import all_tables, errors_of
from kurt2rt.experiments.study.table import Table
from tests.experiments.rows import FAILED, MADE_OF, PASSED, lesson, row, titled

SQUARE = ((2.2, 2.2), (2.2, 4.0), (4.0, 4.0), (4.0, 2.2))


def outcome(seed: int, *layers: Layer, mid_rlas: int = 12, collisions: int = 0, stuck: bool = False) -> RouteOutcome:
    """Return a robot that did 80 decisions, of which each of the layers failed at one."""
    mid = {"mid_rlas": mid_rlas, "mid_asks": 3, "mid_corrections": 8}
    return RouteOutcome(
        made_of=MADE_OF,
        seed=seed,
        lesson=lesson(seed, teaching_s=797.0, rlas=150, asks=1, corrections=40, rescues=0, **mid),
        route=SQUARE,
        drive=row(
            "manhattan",
            FAILED if layers or collisions or stuck else PASSED,
            duration_s=600.0,
            findings={"junctions": 80.0, "junctions right": 80.0 - len(layers)},
            collisions=collisions,
            stuck=stuck,
        ),
        wrong=tuple(
            RouteMistake(at_s=10.0 * number, leg=number, layer=layer, x_m=2.2, y_m=3.1)
            for number, layer in enumerate(layers, 1)
        ),
    )


def study(outcomes: Sequence[RouteOutcome]) -> list[Table]:
    seeds = [each.seed for each in outcomes]
    return list(all_tables([Routes(8, tuple(outcomes))], load_task("route"), seeds))


def column(table: Table, heading: str) -> list[str]:
    place = table.columns.index(heading)
    return [row[place] for row in table.rows]


def test_twenty_robots_are_judged_by_what_was_asked() -> None:
    good = [outcome(seed) for seed in range(100, 118)]
    asked = titled(study([*good, outcome(118, "mid"), outcome(119, stuck=True)]), "What was asked")
    assert column(asked, "came") == ["12", "797 s", "99.94% of 1600", "18 of 20"]
    assert set(column(asked, "verdict")) == {"met"}
    bad = [outcome(seed, "basic", mid_rlas=198) for seed in range(117, 120)]
    asked = titled(study([*good[:17], *bad]), "What was asked")
    assert column(asked, "verdict") == ["MISSED", "met", "met", "MISSED"]


def test_errors_are_told_with_their_layer_time_and_place() -> None:
    wrong = outcome(1, "mid", collisions=1, stuck=True)
    told = errors_of(wrong).split(", ")
    assert len(told) == 3
    assert told[0].startswith("mid ")
    assert re.findall(r"\d+", told[0] + told[1]) == ["10", "2", "1"]
