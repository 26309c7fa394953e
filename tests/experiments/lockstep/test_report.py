import re
import statistics
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console, RenderableType

from kurt2rt.experiments.lockstep.exam_verdict import NOT_JUDGED_BECAUSE
from kurt2rt.experiments.lockstep.report import (
    exams_as_data,
    quartiles,
    render_curriculum,
    render_exams,
    render_seeds,
    verdict_of,
    wilson_interval,
)
from kurt2rt.experiments.lockstep.seed_result import seed_result
from tests.experiments.helpers import short_task
from tests.experiments.results import curriculum_result, exam_result, robot_of_seed, world_result


def printed(what: RenderableType) -> list[list[str]]:
    """Rows as they are read: the cells of each line."""
    console = Console(width=200, no_color=True)
    with console.capture() as capture:
        console.print(what)
    return [re.split(r"\s{2,}", line.strip()) for line in capture.get().split("\n")]


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [  # as published: Newcombe 1998, table I, method 3, and R's prop.test(correct = FALSE)
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 1, 0.2065, 1.0),
    ],
)
def test_the_interval_of_a_share_is_wilsons(successes: int, trials: int, low: float, high: float) -> None:
    assert wilson_interval(successes, trials) == pytest.approx((low, high), abs=6e-5)


@given(st.integers(1, 500).flatmap(lambda trials: st.tuples(st.integers(0, trials), st.just(trials))))
def test_the_interval_holds_the_share_and_mirrors(counted: tuple[int, int]) -> None:
    successes, trials = counted
    low, high = wilson_interval(successes, trials)
    share, rounding = successes / trials, 1e-12
    assert 0.0 <= low <= share + rounding
    assert share - rounding <= high <= 1.0
    failures_low, failures_high = wilson_interval(trials - successes, trials)
    assert (1 - high, 1 - low) == pytest.approx((failures_low, failures_high))


@given(st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=50))
def test_quartiles_are_those_of_the_standard_library(values: list[float]) -> None:
    assert quartiles(values) == pytest.approx(statistics.quantiles(values, n=4, method="inclusive"), abs=1e-6)


def test_a_lesson_stands_beside_the_paper() -> None:
    rows = printed(render_curriculum(curriculum_result(7, 88, exam_result()), short_task()))
    assert {"wall_following", "a,", "7"} <= set(rows[0][0].split())
    assert ["RLAs", "88", "91"] in rows
    assert ["345", "345"] in [row[1:] for row in rows]
    assert ["asks", "41"] in rows
    assert ["corrections", "52"] in rows
    assert ["teacher", "superhuman", "a person"] in rows
    assert ["3"] in [row[1:] for row in rows]
    assert ["A", "8.00", "9.00", "0", "no", "3.4%", "yes"] in rows
    assert ["distance error, m", "0.0321"] in rows


def test_deletions_and_repositions_are_told_where_there_were_any() -> None:
    result = curriculum_result(7, 88)
    rows = printed(render_curriculum(result, short_task()))
    without = len(rows)
    lesson = replace(result.lesson, deletions=4, repositions=11)
    rows = printed(render_curriculum(replace(result, lesson=lesson), short_task()))
    assert len(rows) == without + 2
    assert ["4"] in [row[1:] for row in rows]
    assert ["11"] in [row[1:] for row in rows]


def test_render_exams_marks_a_failed_teacher() -> None:
    def told(**teacher: Any) -> str:
        compared = world_result(exam_result())
        rows = printed(render_exams([replace(compared, teacher=replace(compared.teacher, **teacher))], short_task()))
        return next(row[2] for row in rows if row[0] == "A")

    assert told() == "9.00"
    assert told(progress=-0.5) == "-0.50 (got nowhere)"
    assert told(least_progress=9.0) == "9.00 (got nowhere)"
    assert told(collisions=1) == told(alarm="bus lost") == told(stuck=True) == "9.00 (failed)"


def test_render_exams_without_a_measure_is_not_judged() -> None:
    exams = [world_result(exam_result("b")), world_result(exam_result("cave", collisions=2), teachers_laps=0.0)]
    rows = printed(render_exams(exams, short_task()))
    assert ["B", "8.00", "9.00", "0", "no", "3.4%", "yes"] in rows
    assert ["cave", "8.00", "0.00 (got nowhere)", "2", "no", "3.4%", "not judged"] in rows
    assert any(NOT_JUDGED_BECAUSE in row[0].lower() for row in rows)
    judged = printed(render_exams(exams[:1], short_task()))
    assert not any(NOT_JUDGED_BECAUSE in row[0].lower() for row in judged)
    assert verdict_of(exams[1]).startswith(NOT_JUDGED_BECAUSE)
    told = [(each["succeeded"], each["verdict"]) for each in exams_as_data(exams, short_task())["exams"]]
    assert told == [(True, "passed"), (False, "not_judged")]


def test_render_seeds_leaves_out_exams_not_judged() -> None:
    results = [
        seed_result(
            replace(
                curriculum_result(seed, 80),
                exams=(world_result(exam_result("a", seed), laps), world_result(exam_result("b", seed), 0.0)),
            )
        )
        for seed, laps in ((100, 9.0), (101, 0.0), (102, 20.0))
    ]
    rows = printed(render_seeds(results, short_task()))
    of_101 = next(row for row in rows if row[0] == "101")
    assert [re.findall(r"[\d.]+", cell) for cell in of_101[5:]] == [["8.0", "0.0", "0"]] * 2
    success = {row[0]: row[1:] for row in rows if len(row) == 7 and row[0] in ("A", "B")}
    assert re.findall(r"\d+", success["A"][0]) == ["1", "2", "1"]
    assert success["A"][1:] == ["9% to 91%", "0", "0", "8.00", "3.4%"]
    assert re.findall(r"\d+", success["B"][0]) == ["0", "0", "3"]
    assert success["B"][1:] == ["none", "0", "0", "8.00", "3.4%"]


def test_many_seeds_come_to_medians_quartiles_and_intervals() -> None:
    results = [
        robot_of_seed(100, 80, exam_result("a", 100), exam_result("b", 100, laps=8.5)),
        robot_of_seed(101, 90, exam_result("a", 101), exam_result("b", 101, laps=1.0, stuck=True)),
        robot_of_seed(102, 100, exam_result("a", 102), exam_result("b", 102, laps=7.5, collisions=1)),
    ]
    rows = printed(render_seeds(results, short_task()))
    of_101 = next(row for row in rows if row[0] == "101")
    assert of_101[1:6] == ["90", "41", "52", "3", "8.0 of 9.0, 0"]
    assert re.findall(r"[\d.]+", of_101[6]) == ["1.0", "9.0", "0", "123"]
    assert ["102", "100", "41", "52", "3", "8.0 of 9.0, 0", "7.5 of 9.0, 1"] in rows
    assert ["RLAs", "90", "85 to 95", "91"] in rows
    assert ["345", "345 to 345", "345"] in [row[1:] for row in rows]
    assert ["A", "3 of 3", "44% to 100%", "0", "0", "8.00", "3.4%"] in rows
    assert ["B", "1 of 3", "6% to 79%", "1", "1", "7.50", "3.4%"] in rows
