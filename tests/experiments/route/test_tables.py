import re
from collections.abc import Sequence
from pathlib import Path

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.route.outcome import RouteOutcome
from kurt2rt.experiments.route.plan import RouteExperiment, RoutePlan, make_plan
from kurt2rt.experiments.route.summary import RouteStudy, RouteSummary
from kurt2rt.experiments.route.tables import all_tables, errors_of
from kurt2rt.experiments.route.variants import CONTROLS, TAUGHT, Variant
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.table import Table
from tests.experiments.helpers import ROBOT, STAGE
from tests.experiments.route.outcomes import drive, outcome


def plan(seeds: Sequence[int], variants: Sequence[Variant] = (TAUGHT,)) -> RoutePlan:
    route, streets = load_task("route"), load_task("streets")
    results = Results(Path("unused"))
    return make_plan(
        route,
        streets,
        seeds,
        (8,),
        variants,
        JobParts(factory=STAGE, robot=ROBOT, results=results),
    )


def study(outcomes: Sequence[RouteOutcome], variants: Sequence[Variant] = (TAUGHT,)) -> RouteStudy:
    planned = plan([each.seed for each in outcomes], variants)
    return RouteStudy(planned, tuple(RouteSummary(each, tuple(outcomes)) for each in planned.experiments))


def table_titled(of: RouteStudy, title: str) -> Table:
    return next(each for each in all_tables(of) if each.title.startswith(title))


def column(table: Table, heading: str) -> list[str]:
    place = table.columns.index(heading)
    return [row[place] for row in table.rows]


def test_twenty_robots_are_judged_by_what_was_asked() -> None:
    good = [outcome(seed, drive()) for seed in range(100, 118)]
    asked = table_titled(study([*good, outcome(118, drive("mid")), outcome(119, drive(stuck=True))]), "What was asked")
    assert column(asked, "came") == ["12", "797 s", "99.94% of 1600", "18 of 20"]
    assert set(column(asked, "verdict")) == {"met"}
    bad = [outcome(seed, drive("basic"), mid_rlas=198) for seed in range(117, 120)]
    asked = table_titled(study([*good[:17], *bad]), "What was asked")
    assert column(asked, "verdict") == ["MISSED", "met", "met", "MISSED"]


def test_few_robots_or_known_ones_are_not_judged() -> None:
    asked = table_titled(study([outcome(1, drive())]), "What was asked")
    assert set(column(asked, "verdict")) == {"not judged"}
    assert "1 robot only" in asked.note


def test_each_layers_errors_are_counted_apart() -> None:
    drives = [drive("basic", "basic", "mid"), drive("symbols", collisions=2), drive(stuck=True), drive()]
    exams = table_titled(study([outcome(seed, each) for seed, each in enumerate(drives, 100)]), "Drives without")
    assert [column(exams, layer) for layer in ("symbols", "mid", "basic")] == [["1"], ["1"], ["2"]]
    assert column(exams, "without an error") == ["1 of 4"]
    assert (column(exams, "collisions"), column(exams, "stuck")) == (["2"], ["1"])


def test_of_controls_nothing_is_asked_and_each_has_its_row() -> None:
    compared = study([outcome(100, drive())], (TAUGHT, *CONTROLS))
    assert len(table_titled(compared, "What was asked").rows) == 4
    assert len(table_titled(compared, "What was taught").rows) == 1 + len(CONTROLS)


def test_errors_are_told_with_their_layer_time_and_place() -> None:
    wrong = outcome(1, drive("mid", collisions=1, stuck=True))
    told = errors_of(wrong).split(", ")
    assert len(told) == 3
    assert told[0].startswith("mid ")
    assert re.findall(r"\d+", told[0] + told[1]) == ["10", "2", "1"]


def test_every_robot_is_known_by_its_own_route_and_streets() -> None:
    jobs = [job for each in plan((1, 2)).experiments for job in each.jobs]
    assert len({job.made_of.task for job in jobs}) == 2
    assert [job.basic.name for job in jobs] == ["streets-1.knowledge", "streets-2.knowledge"]
    assert isinstance(plan((1,)).experiments[0], RouteExperiment)
