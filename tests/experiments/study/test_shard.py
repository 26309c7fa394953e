"""Shards: each robot is in one of them, with all of its jobs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import pytest

from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.shard import Shard, ShardError, shard_of
from tests.experiments.study.test_results import JOBS
from tests.experiments.study.test_results import Job as Stored


@dataclass(frozen=True)
class Job(Stored):
    seed: int = 0
    name: str = "job"
    robot_time_s: float = 1.0
    knowledge_name: str | None = None

    def run(self, tell: Progress) -> None:
        tell(self.robot_time_s)


@dataclass(frozen=True)
class Plan:
    waves: Sequence[Sequence[Job]]


FIRST = tuple(replace(Job(JOBS[0].file), seed=seed) for seed in (7, 3, 5, 11, 9))
SECOND = tuple(replace(job, name="more") for job in FIRST[1:])
PLAN = Plan((FIRST, SECOND))


@pytest.mark.parametrize("shards", [1, 2, 3, 5])
def test_shards_hold_each_job_once_and_a_robot_whole(shards: int) -> None:
    parts = [shard_of(PLAN, Shard(number, shards)) for number in range(1, shards + 1)]
    for place, wave in enumerate(PLAN.waves):
        jobs = [job for part in parts for job in part.waves[place]]
        assert sorted(jobs, key=repr) == sorted(wave, key=repr)
    seeds = [seed for part in parts for seed in part.seeds]
    assert sorted(seeds) == [3, 5, 7, 9, 11]
    sizes = [len(part.seeds) for part in parts]
    assert max(sizes) - min(sizes) <= 1
    for part in parts:
        assert {job.seed for wave in part.waves for job in wave} == set(part.seeds)


def test_shards_share_robots_with_more_to_do() -> None:
    long = tuple(replace(job, seed=seed, robot_time_s=600.0) for seed, job in zip((2, 8, 10, 12), FIRST, strict=False))
    parts = [shard_of(Plan((FIRST, long)), Shard(number, 2)) for number in (1, 2)]
    times_s = [sum(job.robot_time_s for wave in part.waves for job in wave) for part in parts]
    assert times_s == [1203.0, 1202.0]


def test_shard_of_too_few_robots_is_refused() -> None:
    with pytest.raises(ShardError, match=r"^shard 2/6: .*got 6, allowed 5"):
        shard_of(PLAN, Shard(2, 6))


@pytest.mark.parametrize("text", ["", "2", "0/3", "4/3", "1/0", "-1/3", "1/3/5", "a/b", "1 / 3", "٢/٣"])
def test_shard_that_does_not_exist_is_refused(text: str) -> None:
    with pytest.raises(ShardError, match=r"allowed K/N"):
        Shard.parse(text)


def test_shard_is_read_as_it_is_written() -> None:
    assert str(Shard.parse("2/8")) == "2/8"
    assert Shard.parse("2/8") == (2, 8)
