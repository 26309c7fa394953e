from dataclasses import replace
from pathlib import Path

import pytest

from hal.settings import SettingsError
from kurt2rt.core.rla.usage_counter import StatisticsCounter
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult
from kurt2rt.experiments.study.seeds import SeedJob, run_seeds
from kurt2rt.knowledge.journal.journal import Journal
from tests.experiments.helpers import ROBOT, STAGE, short_task

COUNTED_APART = StatisticsCounter()


def jobs(folder: Path) -> list[SeedJob]:
    task = short_task(2.5, 1.0, 1.0)
    return [SeedJob(STAGE, ROBOT, task, ("a",), seed, folder / f"{seed}.knowledge") for seed in (5, 6)]


def without_counts(result: CurriculumResult) -> CurriculumResult:
    return replace(result, lesson=replace(result.lesson, statistics=COUNTED_APART))


@pytest.mark.deep
def test_two_fresh_processes_come_to_the_same_as_this_one(tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    done: list[int] = []
    there = run_seeds(jobs(tmp_path / "there"), 2, done.append)
    here = [job.run(lambda _done_s: None) for job in jobs(tmp_path / "here")]

    assert sorted(done) == [5, 6]
    assert list(map(without_counts, there)) == list(map(without_counts, here))
    assert [each.lesson.statistics.uses for each in there] == [each.lesson.statistics.uses for each in here]
    assert [each.lesson.seed for each in there] == [5, 6]
    assert there[0].lesson.knowledge_hash != there[1].lesson.knowledge_hash
    for seed in (5, 6):
        file = f"{seed}.knowledge"
        with Journal.read_only(tmp_path / "here" / file) as one, Journal.read_only(tmp_path / "there" / file) as other:
            assert one.events() == other.events()


@pytest.mark.deep
def test_run_seeds_reports_an_error_at_once(tmp_path: Path) -> None:
    first, second = jobs(tmp_path)
    failing = replace(first, worlds=("nowhere",))
    others = [replace(second, seed=seed, knowledge=tmp_path / f"{seed}.knowledge") for seed in range(10, 30)]
    done: list[int] = []
    with pytest.raises(SettingsError, match=r"nowhere: .*worlds") as caught:
        run_seeds([failing, *others], 1, done.append)
    assert caught.value.__notes__ == ["wall_following, seed 5"]
    assert done == []
    assert len(list(tmp_path.glob("*.knowledge"))) < 10
