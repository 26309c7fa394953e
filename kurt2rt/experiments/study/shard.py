"""Shard of a study: the robots that one of several machines does."""

import re
from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple, Self

from hal.errors import UserError
from kurt2rt.experiments.study.plan import StoredJob, StudyPlan


class ShardError(UserError):
    """A shard does not exist."""


class Shard(NamedTuple):
    """Place of a shard among all shards of a study."""

    number: int
    """Counts from 1."""
    shards: int

    @classmethod
    def parse(cls, text: str) -> Self:
        """Return the shard of a text such as `2/8`. Raises ShardError."""
        found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text, re.ASCII)
        if found is None or not 1 <= int(found[1]) <= int(found[2]):
            raise ShardError(f"no shard (got {text!r}, allowed K/N with K from 1 to N)", do="give e.g. 2/8")
        return cls(int(found[1]), int(found[2]))

    def __str__(self) -> str:
        return f"{self.number}/{self.shards}"


@dataclass(frozen=True, slots=True)
class ShardPlan:
    """Jobs of a shard, in the waves of the whole study."""

    waves: tuple[tuple[StoredJob, ...], ...]
    seeds: tuple[int, ...]
    """Robots of the shard."""


def shard_of(plan: StudyPlan, shard: Shard) -> ShardPlan:
    """Return the jobs of every n-th robot, because jobs of one robot may need each other's files.

    Robots with more to do are dealt out first, so that all shards take about equally long. Raises ShardError if there
    are fewer robots than shards.
    """
    time_s: dict[int, float] = defaultdict(float)
    for job in (job for wave in plan.waves for job in wave):
        time_s[job.seed] += job.robot_time_s
    robots = sorted(time_s, key=lambda seed: (-time_s[seed], seed))
    if shard.shards > len(robots):
        raise ShardError(
            f"too many shards (got {shard.shards}, allowed {len(robots)}, one for each robot or block of runs)",
            where=f"shard {shard}",
            do="give fewer shards, or more seeds or runs",
        )
    own = tuple(sorted(robots[shard.number - 1 :: shard.shards]))
    return ShardPlan(tuple(tuple(job for job in wave if job.seed in own) for wave in plan.waves), own)
