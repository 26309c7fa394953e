import re
from collections.abc import Sequence

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.route.route_monitor import Layer, RouteMistake
from kurt2rt.experiments.route.study import RouteJob, RouteOutcome, make_plan
from kurt2rt.experiments.route.tables import Routes, RouteStudy, all_tables, errors_of
from kurt2rt.experiments.study.table import Table
from tests.experiments.rows import FAILED, MADE_OF, PASSED, lesson, row
from tests.experiments.study.here import parts_in

SQUARE = ((2.2, 2.2), (2.2, 4.0), (4.0, 4.0), (4.0, 2.2))


def outcome(seed: int, *layers: Layer, mid_rlas: int = 12, collisions: int = 0, stuck: bool = False) -> RouteOutcome:
    """Return a robot that did 80 decisions, of which each of the layers failed at one."""
    return RouteOutcome(
        made_of=MADE_OF,
        seed=seed,
        lesson=lesson(seed, teaching_s=797.0, rlas=150, asks=1, corrections=40, rescues=0),
        route=SQUARE,
        mid_rlas=mid_rlas,
        mid_asks=3,
        mid_corrections=8,
        missed_junctions=0,
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


def study(outcomes: Sequence[RouteOutcome]) -> RouteStudy:
    plan = make_plan(load_task("route"), [each.seed for each in outcomes], (8,), parts_in())
    return RouteStudy(plan, (Routes(8, tuple(outcomes)),))


def table_titled(of: RouteStudy, title: str) -> Table:
    return next(each for each in all_tables(of) if each.title.startswith(title))


def column(table: Table, heading: str) -> list[str]:
    place = table.columns.index(heading)
    return [row[place] for row in table.rows]


def test_twenty_robots_are_judged_by_what_was_asked() -> None:
    good = [outcome(seed) for seed in range(100, 118)]
    asked = table_titled(study([*good, outcome(118, "mid"), outcome(119, stuck=True)]), "What was asked")
    assert column(asked, "came") == ["12", "797 s", "99.94% of 1600", "18 of 20"]
    assert set(column(asked, "verdict")) == {"met"}
    bad = [outcome(seed, "basic", mid_rlas=198) for seed in range(117, 120)]
    asked = table_titled(study([*good[:17], *bad]), "What was asked")
    assert column(asked, "verdict") == ["MISSED", "met", "met", "MISSED"]


def test_few_robots_or_known_ones_are_not_judged() -> None:
    asked = table_titled(study([outcome(1)]), "What was asked")
    assert set(column(asked, "verdict")) == {"not judged"}
    assert "1 robot only" in asked.note


def test_each_layers_errors_are_counted_apart() -> None:
    robots = [outcome(100, "basic", "basic", "mid"), outcome(101, "symbols", collisions=2), outcome(102, stuck=True)]
    exams = table_titled(study([*robots, outcome(103)]), "Drives without")
    assert [column(exams, layer) for layer in ("symbols", "mid", "basic")] == [["1"], ["1"], ["2"]]
    assert column(exams, "without an error") == ["1 of 4"]
    assert (column(exams, "collisions"), column(exams, "stuck")) == (["2"], ["1"])


def test_errors_are_told_with_their_layer_time_and_place() -> None:
    wrong = outcome(1, "mid", collisions=1, stuck=True)
    told = errors_of(wrong).split(", ")
    assert len(told) == 3
    assert told[0].startswith("mid ")
    assert re.findall(r"\d+", told[0] + told[1]) == ["10", "2", "1"]


def test_every_robot_is_known_by_its_own_route_and_streets() -> None:
    jobs = study([outcome(1), outcome(2)]).plan.of(RouteJob)
    assert len({job.made_of.task for job in jobs}) == 2
    assert [job.basic.name for job in jobs] == ["streets-1.knowledge", "streets-2.knowledge"]
