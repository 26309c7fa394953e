"""Schema of `config/searches/*.yaml`, and the task of a search with the values of a trial in place of its own."""

import copy
import json
import re
from collections.abc import Iterator, Mapping
from itertools import combinations, product
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from config.settings import Settings, SettingsError, load_settings
from config.settings_files import find_config
from kurt2rt.core.settings_fields import Name
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.core.teacher_settings import TeacherProfile
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.study.jobs import SEED, world_of

Objective = Literal["passed_then_presses", "passed_then_presses_and_collisions", "passed_then_rlas"]
Count = Annotated[int, Field(ge=1, le=10_000)]


def may_be_searched(seed: int) -> bool:
    """Return whether settings may be chosen on a robot; results are reported on all others."""
    return seed < 1000 or 3000 <= seed < 4000


class SeedRange(Settings):
    """Range of consecutive seeds, a robot each."""

    first: Annotated[int, Field(ge=0, le=1_000_000)]
    count: Count

    @property
    def seeds(self) -> range:
        """Seeds of the range, ascending."""
        return range(self.first, self.first + self.count)


class Robots(Settings):
    """Robots of a search or its check, a seed each, and the worlds of their exams."""

    seeds: SeedRange
    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """SEED in a name stands for the robot's seed."""

    def worlds_of(self, seed: int) -> tuple[str, ...]:
        """Return the worlds of one robot's exams."""
        return tuple(world_of(world, seed) for world in self.worlds)


class CheckSettings(Robots):
    """Robots on which the best trials are compared with the shipped settings; number of these trials."""

    best: Annotated[int, Field(ge=1, le=10)]
    """Number of trials, the best first, that are compared with the shipped settings."""


class Dimension(Settings):
    """Key of the task's file that a search changes, and the range of its values."""

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
    """First the share of exams passed; among equal shares, less effort is better (`plan.effort`)."""
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


Values = Mapping[str, float]
"""Value of each key of the space; whole numbers for a dimension of kind int."""
_DIGITS = 3
"""Significant digits of a value of a trial, so that a found setting is legible."""


def content_of_task(task: TaskSettings) -> dict[str, Any]:
    """Return a task as mappings, lists and values, with all defaults."""
    content: dict[str, Any] = json.loads(task.model_dump_json(serialize_as_any=True))
    return content


def value_at(content: Mapping[str, Any], key: str) -> float:
    """Return the number at a dotted key, in the unit of its name (m, s or counts). Raises SettingsError without one."""
    *_, place = _places(content, key)
    if isinstance(place, bool) or not isinstance(place, int | float):
        raise SettingsError(f"{key}: no number (got {place!r})", where="space", do="give a key that holds a number")
    return place


def _places(content: Any, key: str) -> Iterator[Any]:
    """Yield what each level of a dotted key leads to. Raises SettingsError if a level leads nowhere."""
    place = content
    for level in key.split("."):
        names = range(len(place)) if isinstance(place, list) else place if isinstance(place, Mapping) else ()
        if level not in map(str, names):
            allowed = ", ".join(map(str, names)) or "nothing"
            raise SettingsError(f"{key}: no such key (got {level}, allowed {allowed})", where="space")
        place = place[int(level) if isinstance(place, list) else level]
        yield place


def _changes_of_values(content: Mapping[str, Any], values: Values) -> dict[str, Any]:
    """Return what to change in the task's file, by dotted key; a list that a key leads through is whole."""
    changed = copy.deepcopy(dict(content))
    tops = {}
    for key, value in values.items():
        levels, places = key.split("."), [changed, *_places(changed, key)]
        holder = places[-2]
        holder[int(levels[-1]) if isinstance(holder, list) else levels[-1]] = value
        depth = next((depth for depth, place in enumerate(places) if isinstance(place, list)), len(levels))
        tops[".".join(levels[:depth])] = places[depth] if depth < len(levels) else value
    return tops


class TaskSpace:
    """Maker of the task of each trial: the searched task with the trial's values."""

    def __init__(self, search: SearchSettings, changes: Mapping[str, str], profile: TeacherProfile) -> None:
        """Load the task and check each key of the space.

        `changes`: values by dotted key that all trials and the shipped settings share. `profile`: the teacher. Raises
        SettingsError for a key that leads nowhere, or that the teacher or a change decides.
        """
        self._search, self._changes, self._profile = search, changes, profile
        task = load_task(search.task, changes=changes)
        self._content = content_of_task(task)
        self.shipped: Values = {each.key: value_at(self._content, each.key) for each in search.space}
        for each in search.space:
            self._require_free(each)
        self._require_fit()

    def changes(self, values: Values) -> dict[str, Any]:
        """Return what a trial changes in the task's file, by dotted key."""
        return _changes_of_values(self._content, values)

    def task(self, values: Values) -> TaskSettings:
        """Return the task of a trial, with its teacher. Raises SettingsError if the values do not fit together."""
        own = {key: json.dumps(value) for key, value in self.changes(values).items()}
        return taught_by(load_task(self._search.task, changes={**self._changes, **own}), self._profile)

    def _require_free(self, dimension: Dimension) -> None:
        key, shipped = dimension.key, self.shipped[dimension.key]
        for each in self._changes:
            if f"{key}.".startswith(f"{each}."):
                raise SettingsError(f"{key}: --set {each} decides it", where="space", do="leave --set out")
        if not dimension.low <= shipped <= dimension.high:
            raise SettingsError(
                f"{key}: the range leaves the shipped value out (got {shipped:g}, "
                f"allowed {dimension.low:g} to {dimension.high:g})",
                where="space",
                do="widen the range",
            )
        other = dimension.low if shipped != dimension.low else dimension.high
        tried = rounded(dimension, other)
        if value_at(content_of_task(self.task({key: tried})), key) != tried:
            raise SettingsError(
                f"{key}: the teacher {self._profile.name} decides it", where="space", do="name another teacher or key"
            )

    def _require_fit(self) -> None:
        """Check the ends of each two ranges, so that no trial fails on values that do not fit each other."""
        for first, second in combinations(self._search.space, 2):
            for one, other in product((first.low, first.high), (second.low, second.high)):
                self.task({first.key: rounded(first, one), second.key: rounded(second, other)})


def rounded(dimension: Dimension, value: float) -> float:
    """Return a value in the key's unit (m, s or counts) with 3 significant digits."""
    return min(max(float(f"{value:.{_DIGITS}g}"), dimension.low), dimension.high)
