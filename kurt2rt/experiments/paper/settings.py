"""Schema of `config/paper/*.yaml`: the experiments, what is asked of them, and what the figures show."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hal.settings import Settings, SettingsError, load_settings
from hal.settings_files import find_config
from hal.simulation import SimulationFactory

Share = Annotated[float, Field(gt=0, le=1)]
Count = Annotated[int, Field(ge=1, le=10_000)]


class AskedSettings(Settings):
    """Numbers to reach; what is left out is not asked for."""

    rlas_at_most: Annotated[int, Field(ge=0, le=10_000)] = 0
    """The median of all robots; 0: not asked for."""
    success_at_least: dict[str, Share] = Field(default_factory=dict)
    """Share of the robots, by world."""
    right_at_least: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Share of all junctions that are left as asked; 0: not asked for."""
    collisions_below_per_10_min: Annotated[float, Field(ge=0)] = 0.0
    """0: not asked for."""


class UnseenSettings(Settings):
    """Generated worlds for exams, shared among the robots."""

    kind: Literal["rooms", "streets"]
    first: Annotated[int, Field(ge=0)]
    """Seed of the first one; the others follow."""
    count: Count
    success_at_least: Share

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the generated worlds."""
        return tuple(f"{self.kind}-{seed}" for seed in range(self.first, self.first + self.count))


class ExperimentSettings(Settings):
    """One task, taught and examined with many seeds."""

    task: str
    """Name of the task, or path of its YAML file."""
    title: str
    asked: AskedSettings = AskedSettings()
    unseen: UnseenSettings | None = None
    paper_rlas_of: dict[str, Count] = Field(default_factory=dict)
    """RLAs that the paper reports for each taught behaviour, where there are several."""


class GrowthSettings(Settings):
    """Settings of Fig. 2: growth of the number of RLAs in phase 1, for several R."""

    task: str
    radii: Annotated[tuple[Annotated[float, Field(gt=0, le=100_000)], ...], Field(min_length=1)]
    robots: Count
    """The first so many seeds."""
    duration_s: Annotated[float, Field(ge=1, le=100_000)]


class PaperSettings(Settings):
    """All of it."""

    experiments: Annotated[tuple[ExperimentSettings, ...], Field(min_length=1)]
    growth: GrowthSettings
    testing_ground: str
    """World of Fig. 4."""
    worlds: Annotated[tuple[str, ...], Field(min_length=1)]
    """Worlds of Fig. 6."""
    eight: str
    """Task of Fig. 7."""
    teacher: str | None = None
    """Scripted teacher of all experiments: a name in `config/teachers`, or the path of a YAML file; None: each task's
    `teaching.default_teacher`."""

    @model_validator(mode="after")
    def _each_task_once(self) -> Self:
        tasks = [each.task for each in self.experiments]
        twice = sorted({task for task in tasks if tasks.count(task) > 1})
        if twice:
            raise ValueError(f"{', '.join(twice)} stands twice; leave one out")
        return self


def load_paper(name_or_path: str = "basic_level", factory: SimulationFactory | None = None) -> PaperSettings:
    """Return the settings of a shipped study by name, or of a file by path.

    With a factory its worlds are checked, too. Raises hal.settings.SettingsError that names file and key.
    """
    path = find_config("paper", name_or_path)
    paper = load_settings(path, PaperSettings)
    tasks = [each.task for each in paper.experiments]
    for key, task in (("growth.task", paper.growth.task), ("eight", paper.eight)):
        if task not in tasks:
            raise SettingsError(
                f"{key}: there is no experiment with task {task!r}", where=path, do=f"give one of: {', '.join(tasks)}"
            )
    if factory is None:
        return paper
    worlds = {"testing_ground": paper.testing_ground} | {f"worlds.{k}": each for k, each in enumerate(paper.worlds)}
    for key, world in worlds.items():
        try:
            factory.require_worlds(world)
        except SettingsError as error:
            raise SettingsError(f"{key}: {error}", where=path) from error
    return paper
