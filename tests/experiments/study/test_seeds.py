from pathlib import Path

import pytest

from kurt2rt.experiments.study.jobs import Results
from kurt2rt.experiments.study.pool import open_processes, run_missing
from kurt2rt.experiments.study.seeds import forget_lost_robots, make_plan, read_results
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import short_task
from tests.experiments.study.here import parts_in

TASK = short_task(2.5, 1.0, 1.0)


def taught(folder: Path, *seeds: int, processes: int = 1) -> StudyPlan[None]:
    plan, results = make_plan(TASK, seeds, parts_in(folder)), Results(folder)
    with results.held(), open_processes(processes) as executor:
        run_missing(plan.waves, results, executor, lambda _: None)
    return plan


def test_robots_of_a_seed_study_are_taught_once(tmp_path: Path) -> None:
    plan, results = taught(tmp_path, 5), Results(tmp_path)
    (outcome,) = read_results(plan)
    assert results.missing(plan.waves[0]) == []
    with Journal.read_only(tmp_path / "wall_following-5.knowledge") as journal:
        assert journal.events()
    assert (outcome.lesson.seed, outcome.lesson.world, outcome.drives[0].trail) == (5, "a", ())
    assert outcome.lesson.rlas > 0

    other = make_plan(short_task(1.0, 0.5, 0.5), [5], parts_in(tmp_path))  # another task: taught again
    assert results.missing(other.waves[0]) == [0]
    other.waves[0][0].run(lambda _done_s: None)
    assert (tmp_path / "wall_following-5.knowledge.1").exists()

    forget_lost_robots(other)
    assert results.missing(other.waves[0]) == []
    (tmp_path / "wall_following-5.knowledge").unlink()
    forget_lost_robots(other)
    assert results.missing(other.waves[0]) == [0]


@pytest.mark.deep
def test_two_fresh_processes_come_to_the_same_as_this_one(tmp_path: Path) -> None:
    there = taught(tmp_path / "there", 5, 6, processes=2)
    here = taught(tmp_path / "here", 5, 6)
    results = [read_results(each) for each in (there, here)]
    assert results[0] == results[1]
    first, second = results[0]
    assert first.lesson.knowledge_hash != second.lesson.knowledge_hash
    for seed in (5, 6):
        file = f"wall_following-{seed}.knowledge"
        with Journal.read_only(tmp_path / "here" / file) as one, Journal.read_only(tmp_path / "there" / file) as other:
            assert one.events() == other.events()
