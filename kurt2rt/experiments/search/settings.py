"""Schema of `config/searches/*.yaml`: settings to search, robots and worlds, and the objective."""

import re
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from config.settings import Settings, load_settings
from config.settings_files import find_config
from kurt2rt.core.task_settings import Name
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.study.jobs import SEED, world_of

Objective = Literal["passed_then_presses", "passed_then_presses_and_collisions", "passed_then_rlas"]
Count = Annotated[int, Field(ge=1, le=10_000)]


def may_be_searched(seed: int) -> bool:
    """Return whether settings may be chosen on a robot; results are reported on all others."""
    return seed < 1000 or 3000 <= seed < 4000


class SeedRange(Settings):
    """Seeds that follow each other."""

    first: Annotated[int, Field(ge=0, le=1_000_000)]
    count: Count

    @property
    def seeds(self) -> range:
        """Seeds of the range, ascending."""
        return range(self.first, self.first + self.count)


class Robots(Settings):
    """Robots, and the worlds of their exams."""

    seeds: SeedRange
    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """SEED in a name stands for the robot's seed."""

    def worlds_of(self, seed: int) -> tuple[str, ...]:
        """Return the worlds of one robot's exams."""
        return tuple(world_of(world, seed) for world in self.worlds)


class CheckSettings(Robots):
    """Robots of the check, and the settings that are checked."""

    best: Annotated[int, Field(ge=1, le=10)]
    """Number of trials, the best first, that are compared with the shipped settings."""


class Dimension(Settings):
    """Key of the task's file, and the values to try."""

    key: Annotated[str, Field(pattern=r"^[a-z_0-9]+(\.[a-z_0-9]+)+$")]
    """Levels with dots between them; a number is a place in a list, from 0."""
    low: float
    high: float
    """Range of the values to try, in the key's own unit."""
    log: bool = False
    """Equal ratios are equally far apart, and not equal differences."""

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low must be less than high (got {self.low:g} and {self.high:g})")
        if self.log and self.low <= 0:
            raise ValueError(f"low must be positive if log is true (got {self.low:g})")
        return self


class SearchSettings(Settings):
    """Schema of `config/searches/*.yaml`: keys and ranges, robots, worlds and teacher of a search."""

    name: Name
    task: str
    """Name of the task, or path of its YAML file."""
    teacher: str
    """Scripted teacher: a name in `config/teachers`, or a path."""
    engine: Engine = Engine.COMPILED
    """Drives lessons and exams."""
    objective: Objective = "passed_then_presses"
    """First the share of exams passed; among equal shares, less effort is better (`score.effort`)."""
    trials: Count
    at_once: Annotated[int, Field(ge=1, le=64)] = 4
    """Number of trials that are chosen together, on what the trials before them showed."""
    sampler_seed: Annotated[int, Field(ge=0, le=1_000_000)] = 0
    search: Robots
    check: CheckSettings
    space: Annotated[tuple[Dimension, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _keeps_seeds_apart(self) -> Self:
        for seed in self.search.seeds.seeds:
            if not may_be_searched(seed):
                raise ValueError(f"search.seeds: {seed} is for reports (got {seed}, allowed 0-999 and 3000-3999)")
        for seed in self.check.seeds.seeds:
            if may_be_searched(seed):
                raise ValueError(f"check.seeds: {seed} is for searches (got {seed}, allowed 1000-2999, 4000 and above)")
        generated = {world for world in self.search.worlds if re.search(r"-\d+$", world)}
        both = sorted(generated & set(self.check.worlds))
        if both:
            raise ValueError(f"check.worlds: {both[0]} is a world of the search; give another, or one with {SEED}")
        keys = [each.key for each in self.space]
        twice = next((key for key in keys if keys.count(key) > 1), None)
        if twice:
            raise ValueError(f"space: the key {twice} stands twice")
        return self


def load_search(name_or_path: str) -> SearchSettings:
    """Load a shipped search by name (`config/searches`), or a file by path. Raises config.settings.SettingsError."""
    return load_settings(find_config("searches", name_or_path), SearchSettings)
